"""Blocks of scenes: one task runs one block and leaves one Parquet file, whole or not at all."""

import hashlib
import json
import os
import platform
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from sliding_contact import host

FINGERPRINT = b"fingerprint"
OK = "ok"
_open = {}  # of this process: its one instance, by FMU


@dataclass(frozen=True)
class Job:
    """Everything that the blocks of one batch share. The paths must mean the same files on every machine."""

    fmu: str
    folder: str  # of the parts
    schedule: host.Schedule
    variables: tuple  # names of the design's columns
    outputs: tuple  # values at the end
    peaks: tuple  # largest values at the recorded points
    step: float  # communication step, s
    every: float  # time between the recorded points, s
    tolerance: float = 0.0
    # Values of the scene that differ from the FMU's own: pairs of name and number.
    base: tuple = ()

    def identity(self, design):
        """Tells batches apart whose rows must not be mixed, by name: the FMU, the `identity` of the design, the inputs, what is kept."""
        schedule = self.schedule
        rows = digest(schedule.times.tobytes() + schedule.values.tobytes())
        return {
            "FMU": f"sha256 {digest(Path(self.fmu).read_bytes())}",
            **design,
            "schedule": f"{schedule.times.size} rows to {schedule.times[-1]:g} s, sha256 {rows}",
            "inputs": ", ".join(schedule.inputs),
            "interpolation": schedule.interpolation,
            "step": self.step,
            "every": self.every,
            "tolerance": self.tolerance,
            "outputs": ", ".join(self.outputs),
            "peaks": ", ".join(self.peaks),
            **dict(self.base),
            # Their order decides which column of the sequence each takes.
            "variables": ", ".join(self.variables),
        }

    def columns(self):
        return [*self.variables, *self.outputs, *(f"{name}.peak" for name in self.peaks)]


def digest(content):
    return hashlib.sha256(content).hexdigest()[:16]


def fingerprint_of(identity):
    return hashlib.sha256(json.dumps(identity).encode()).hexdigest()


def path_of(job, first):
    """File of the block that begins with the scene `first`."""
    return Path(job.folder) / f"part-{first:06d}.parquet"


def _rows_in(path, fingerprint):
    """Rows of a part; 0 where it is not there or not readable. One of another batch is refused."""
    try:
        metadata = pq.read_metadata(path)
    except (OSError, pa.ArrowInvalid):
        return 0
    if (metadata.metadata or {}).get(FINGERPRINT) != fingerprint.encode():
        raise ValueError(f"{path} belongs to another batch; name another output folder")
    return metadata.num_rows


def missing(job, scenes, fingerprint):
    """Ranges of scenes that no part holds: first scene and the one after the last. Parts may be of any size, from shorter batches too."""
    there = np.zeros(scenes, dtype=bool)
    for path in Path(job.folder).glob("part-*.parquet"):
        first = int(path.stem.removeprefix("part-"))
        there[first : first + _rows_in(path, fingerprint)] = True
    edges = np.flatnonzero(np.diff(np.concatenate([[True], there, [True]])))
    return edges.reshape(-1, 2).tolist()


def _instance(job, scratch):
    """This process's instance of the job's FMU, opened with the first block."""
    if job.fmu not in _open:
        folder = host.unpack(job.fmu, Path(scratch) / f"fmu-{digest(Path(job.fmu).read_bytes())}")
        _open[job.fmu] = host.Fmu(folder)
    return _open[job.fmu]


def _points(job):
    start, stop = 0.0, float(job.schedule.times[-1])
    points = start + job.every * np.arange(int(np.floor((stop - start) / job.every + 1e-9)) + 1)
    return points if points[-1] >= stop - 1e-9 * job.every else np.append(points, stop)


def run_block(job, first, rows):
    """Runs the scenes `first`, `first + 1`, ... of these rows; returns columns for a table.

    A scene that fails is a row with its stage, its reason and no results. A library that is lost (a fatal error) ends
    the block with an exception: the process has to be replaced.
    """
    fmu = _instance(job, _scratch())
    names = list(dict.fromkeys([*job.outputs, *job.peaks]))
    last = [names.index(name) for name in job.outputs]
    peak = [names.index(name) for name in job.peaks]
    points = _points(job) if job.peaks else job.schedule.times[-1:]
    results = np.full((len(rows), len(last) + len(peak)), np.nan)
    status, reasons, seconds = [], [], np.empty(len(rows))
    is_factor = [name.endswith(".factor") for name in job.variables]
    for at, row in enumerate(rows):
        pairs = list(zip(job.variables, row, is_factor))
        parameters = dict(job.base) | {name: value for name, value, factor in pairs if not factor}
        factors = {name.removesuffix(".factor"): value for name, value, factor in pairs if factor}
        begin = time.thread_time()
        try:
            recorded = host.run_schedule(
                fmu,
                parameters,
                job.schedule,
                factors=factors,
                outputs=names,
                step=job.step,
                points=points,
                tolerance=job.tolerance,
            )
        except host.Failure as failure:
            if failure.stage == "library":
                _open.pop(job.fmu).close()
                raise
            status.append(failure.stage)
            reasons.append(failure.reason)
        else:
            results[at] = np.concatenate([recorded[-1, last], recorded[:, peak].max(axis=0)])
            status.append(OK)
            reasons.append("")
        seconds[at] = time.thread_time() - begin
    columns = {"scene": np.arange(first, first + len(rows), dtype=np.int64)}
    columns.update(zip(job.columns(), np.column_stack([rows, results]).T))
    columns.update(status=status, reason=reasons, cpu_seconds=seconds)
    return columns


def units(job, fmu):
    """Unit of every column of numbers."""
    names = {name: name for name in (*job.variables, *job.outputs)}
    names.update({f"{name}.peak": name for name in job.peaks})
    return {column: "1" if column.endswith(".factor") else fmu.unit(name) for column, name in names.items()}


def write_part(job, first, columns, fingerprint):
    """Writes a block's file under another name and renames it: the file is complete or absent."""
    unit = {**units(job, _open[job.fmu]), "scene": "1", "cpu_seconds": "s"}
    fields, arrays = [], []
    for name, values in columns.items():
        # A scene that failed has no results: null, not a number.
        array = pa.array(values, from_pandas=True)
        metadata = {"unit": unit[name]} if name in unit else None
        fields.append(pa.field(name, array.type, metadata=metadata))
        arrays.append(array)
    schema = pa.schema(fields, metadata={FINGERPRINT: fingerprint.encode()})
    path = path_of(job, first)
    partial = path.with_name(f".{path.name}.{platform.node()}.{os.getpid()}")
    try:
        pq.write_table(pa.Table.from_arrays(arrays, schema=schema), partial)
        with open(partial, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def run_part(job, first, rows, fingerprint):
    """One task: runs a block and writes its file unless it is there; returns scenes run, failed, and CPU seconds."""
    _refuse_threads()
    if _rows_in(path_of(job, first), fingerprint) == len(rows):
        # Written by a worker that was lost before it could say so.
        return 0, 0, 0.0
    columns = run_block(job, first, rows)
    write_part(job, first, columns, fingerprint)
    failed = sum(status != OK for status in columns["status"])
    return len(rows), failed, float(np.sum(columns["cpu_seconds"]))


def read_all(folder):
    """All rows of a finished batch in the order of the scenes, and the unit of every column."""
    paths = sorted(Path(folder).glob("part-*.parquet"))
    tables = [pq.read_table(path) for path in paths]
    table = pa.concat_tables(tables, promote_options="permissive")
    schema = tables[0].schema
    found = {name: (schema.field(name).metadata or {}).get(b"unit", b"").decode() for name in schema.names}
    return table.to_pandas().sort_values("scene", ignore_index=True), found


def write_json(path, value):
    """Writes a file that is whole or not there."""
    partial = Path(path).with_name(f".{Path(path).name}.{os.getpid()}")
    partial.write_text(json.dumps(value, indent=2) + "\n", encoding="utf-8")
    os.replace(partial, path)


def _worker():
    try:
        from distributed import get_worker

        return get_worker()
    except (ImportError, ValueError):
        return None  # not in a task of Dask


def _scratch():
    """A folder of this process's own, on this machine."""
    worker = _worker()
    if worker is not None:
        return worker.local_directory
    import atexit
    import shutil
    import tempfile

    folder = tempfile.mkdtemp(prefix="sliding-contact-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _refuse_threads():
    worker = _worker()
    if worker is not None and worker.state.nthreads != 1:
        raise RuntimeError(
            f"the worker {worker.address} has {worker.state.nthreads} threads; an instance takes a process of its own: "
            "start workers with `dask worker --nworkers N --nthreads 1`"
        )
