"""The native host of FMUs: one FMU, one instance, run after run, for batches.

    fmu = Fmu(unpack("disc_brake.fmu", "unpacked"))
    outputs = run_schedule(fmu, {"punch.width": 0.09}, schedule, outputs=["wear_depth"], step=0.1)

All stepping happens inside the library, so a call costs what the FMU costs and nothing per step. The interpreter's lock
is released during a call, but an `Fmu` is one instance: one thread at a time, and one process for each where FMUs of others are run.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import _native
from ._errors import Error, writing
from ._numbers import numbers, plain

INTERFACE_VERSION = 2
INTERPOLATIONS = ("hold", "sample", "linear")
STAGES = {1: "request", 2: "initialisation", 3: "stepping", 4: "library"}
_LONGEST_MESSAGE = 8192
_MOST_BYTES = 2**30  # of the files of an FMU, as `cargo fmu batch`


class Failure(RuntimeError):
    """A scene or a library that failed; `stage` says where: one of `STAGES`."""

    def __init__(self, stage: str, reason: str) -> None:
        super().__init__(reason)
        self.stage = stage
        self.reason = reason

    def __reduce__(self) -> Any:
        return Failure, (self.stage, self.reason)


class _Request(ctypes.Structure):
    """`Request` of the library's C interface, field by field."""

    _fields_ = [
        ("parameter_count", ctypes.c_size_t),
        ("parameter_names", ctypes.POINTER(ctypes.c_char_p)),
        ("parameter_values", ctypes.POINTER(ctypes.c_double)),
        ("input_count", ctypes.c_size_t),
        ("input_names", ctypes.POINTER(ctypes.c_char_p)),
        ("input_factors", ctypes.POINTER(ctypes.c_double)),
        ("row_count", ctypes.c_size_t),
        ("times", ctypes.POINTER(ctypes.c_double)),
        ("values", ctypes.POINTER(ctypes.c_double)),
        ("interpolation", ctypes.c_uint32),
        ("start", ctypes.c_double),
        ("stop", ctypes.c_double),
        ("step", ctypes.c_double),
        ("tolerance", ctypes.c_double),
        ("output_count", ctypes.c_size_t),
        ("output_names", ctypes.POINTER(ctypes.c_char_p)),
        ("point_count", ctypes.c_size_t),
        ("points", ctypes.POINTER(ctypes.c_double)),
    ]


@dataclass(frozen=True)
class Schedule:
    """Inputs over time: values hold before the first row and after the last.

    `interpolation`: "hold" keeps a row's values until the next row; "sample" is linear between the rows, taken at the
    beginning of each step; "linear" is linear over each step too, through the inputs' derivatives.
    """

    inputs: tuple[str, ...]  # names, one for each column of values
    times: np.ndarray  # s, increasing
    values: np.ndarray  # one row for each time
    interpolation: str = "hold"

    def __post_init__(self) -> None:
        values, times = numbers("schedule: values", self.values), numbers("schedule: times", self.times)
        if times.ndim != 1 or values.shape != (times.size, len(self.inputs)):
            raise ValueError(
                f"schedule: {times.shape} times and {len(self.inputs)} inputs do not fit values of shape {values.shape}"
            )
        if self.interpolation not in INTERPOLATIONS:
            raise ValueError(f"interpolation {self.interpolation!r} is none of {', '.join(INTERPOLATIONS)}")
        object.__setattr__(self, "inputs", tuple(self.inputs))
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)


def unpack(fmu: Union[str, "os.PathLike[str]"], folder: Union[str, "os.PathLike[str]"]) -> Path:
    """Unpacks an .fmu into `folder` unless that has been done, also by a process that does it at the same time.

    Raises `Error` where its files are larger than 1 GB.
    """
    folder = Path(folder)
    if folder.is_dir():
        return folder
    with zipfile.ZipFile(fmu) as archive, writing(folder):
        size = sum(file.file_size for file in archive.infolist())
        if size > _MOST_BYTES:
            raise Error(f"{os.fspath(fmu)}: its files are {size / 2**20:.0f} MB, and at most {_MOST_BYTES / 2**20:.0f} MB are unpacked")
        partial = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
        try:
            archive.extractall(partial)
            os.rename(partial, folder)
        except OSError:
            if not folder.is_dir():
                raise
        finally:
            shutil.rmtree(partial, ignore_errors=True)
    return folder


def _load(path: Optional[Union[str, "os.PathLike[str]"]]) -> ctypes.CDLL:
    library = _native.library() if path is None else ctypes.CDLL(str(path))
    library.host_interface_version.restype = ctypes.c_uint32
    library.host_interface_version.argtypes = []
    version = library.host_interface_version()
    if version != INTERFACE_VERSION:
        raise RuntimeError(f"{path} has the interface version {version}, this package needs {INTERFACE_VERSION}")
    library.host_open.restype = ctypes.c_void_p
    library.host_open.argtypes = [ctypes.c_char_p, ctypes.c_char_p, ctypes.c_size_t]
    library.host_close.restype = None
    library.host_close.argtypes = [ctypes.c_void_p]
    library.host_unit.restype = ctypes.c_int32
    library.host_unit.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_size_t]
    library.run_schedule.restype = ctypes.c_int32
    library.run_schedule.argtypes = [
        ctypes.c_void_p,
        ctypes.POINTER(_Request),
        ctypes.POINTER(ctypes.c_double),
        ctypes.POINTER(_native.Control),
        ctypes.c_char_p,
        ctypes.c_size_t,
    ]
    return library


class Fmu:
    """An unpacked FMU loaded by the package's own library or another one, with one instance. Closed by `close` or as a context manager."""

    def __init__(
        self, folder: Union[str, "os.PathLike[str]"], library: Optional[Union[str, "os.PathLike[str]"]] = None
    ) -> None:
        self._handle: Optional[int] = None
        self._library = _load(library)
        self._process = os.getpid()
        message = ctypes.create_string_buffer(_LONGEST_MESSAGE)
        self._handle = self._library.host_open(os.fsencode(folder), message, _LONGEST_MESSAGE)
        if not self._handle:
            raise Failure("library", message.value.decode(errors="replace"))

    def close(self) -> None:
        if self._handle:
            self._library.host_close(self._handle)
            self._handle = None

    def __enter__(self) -> "Fmu":
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self.close()

    @property
    def handle(self) -> int:
        if not self._handle:
            raise RuntimeError("the FMU is closed")
        if os.getpid() != self._process:
            raise RuntimeError("an instance belongs to the process that opened it; open one in every process")
        return self._handle

    def unit(self, name: str) -> str:
        """Unit of a variable; "1" where it has none."""
        message = ctypes.create_string_buffer(_LONGEST_MESSAGE)
        status = self._library.host_unit(self.handle, name.encode(), message, _LONGEST_MESSAGE)
        text = message.value.decode(errors="replace")
        if status:
            raise Failure(STAGES.get(status, "library"), text)
        return text


def _names(names: Any) -> Any:
    return (ctypes.c_char_p * len(names))(*(name.encode() for name in names))


def _doubles(values: np.ndarray) -> Any:
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def run_schedule(
    fmu: Fmu,
    parameters: Mapping[str, float],
    inputs: Schedule,
    *,
    outputs: Sequence[str],
    step: float,
    stop: Optional[float] = None,
    start: float = 0.0,
    points: Union[Sequence[float], np.ndarray, None] = None,
    factors: Optional[Mapping[str, float]] = None,
    tolerance: float = 0.0,
) -> np.ndarray:
    """Runs one scene and returns what was recorded: one row for each of `points`, one column for each of `outputs`.

    `parameters`: values by name, the rest keeps the FMU's own; `inputs`: a `Schedule`, by default up to its last row;
    `step`: communication step [s]; `points`: communication points to record at [s], increasing, by default the last;
    `factors`: what an input's column is multiplied by, by name; `tolerance`: for the FMU, 0 leaves it to itself.

    Raises `Failure` with the FMU's own words. The next scene finds the instance as good as new.
    """
    stop = float(inputs.times[-1]) if stop is None else float(plain("stop", stop))
    recorded_at = np.atleast_1d(numbers("points", [stop] if points is None else points))
    values = np.array([float(plain(name, value)) for name, value in parameters.items()])
    unknown = set(factors or {}) - set(inputs.inputs)
    if unknown:
        raise ValueError(f"factors for inputs that the schedule does not have: {', '.join(sorted(unknown))}")
    scales = np.array([float(plain(f"factor of {name}", (factors or {}).get(name, 1.0))) for name in inputs.inputs])
    recorded = np.empty((recorded_at.size, len(outputs)))
    message = ctypes.create_string_buffer(_LONGEST_MESSAGE)
    request = _Request(
        len(parameters),
        _names(parameters),
        _doubles(values),
        len(inputs.inputs),
        _names(inputs.inputs),
        _doubles(scales),
        inputs.times.size,
        _doubles(inputs.times),
        _doubles(inputs.values),
        INTERPOLATIONS.index(inputs.interpolation),
        start,
        stop,
        step,
        tolerance,
        len(outputs),
        _names(outputs),
        recorded_at.size,
        _doubles(recorded_at),
    )
    handle = fmu.handle
    # The first field of `Control` is `stop`.
    status = _native.attended(
        lambda control: fmu._library.run_schedule(
            handle, ctypes.byref(request), _doubles(recorded), ctypes.byref(control), message, _LONGEST_MESSAGE
        )
    )
    if status:
        raise Failure(STAGES.get(status, "library"), message.value.decode(errors="replace"))
    return recorded
