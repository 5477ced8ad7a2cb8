"""A design of experiments around a scene: thousands of variants on Dask, one row each.

    python sweep.py --output results

Run it again after whatever stopped it: finished parts stay, the rest is run. README.md says how to use a cluster.
"""

import argparse
import difflib
import json
import os
import re
import sys
import tempfile
import time
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

import parts
import schedules
from design import Design, TotalOrderDesign
from sliding_contact import Scene, fmu, host

HERE = Path(__file__).resolve().parent
BRAKE_DESIGN = HERE / "brake_design.csv"
OUTPUTS = (
    "wear_depth_punch",
    "wear_depth_strip",
    "dissipated_energy",
    "sliding_distance",
    "limit_reached",
    "punch.wear_limit",
    "strip.wear_limit",
)
PEAKS = ("contact_temperature_max",)
# A batch of 200 scenes per second and core, and at most 15 % of it lost to Dask.
WANTED_PACE = 200.0
WANTED_LOSS = 0.15
# Every worker has work to the end, and progress shows, where a scene takes seconds; a task takes a second where it takes milliseconds.
BLOCKS = 32
MOST_IN_A_BLOCK = 200
# Differences from another batch that a message names.
MOST_TOLD = 4
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", re.IGNORECASE)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--scene", help="a shipped scene or a scene file; default: that of --fmu, else disc_brake")
    parser.add_argument("--fmu", type=Path, help="an FMU of this version to run it; default: the one in the Python package")
    parser.add_argument("--output", type=Path, required=True, help="folder of the batch; an unfinished one is continued")
    parser.add_argument("--design", type=Path, help=f"CSV: name, distribution, parameters; default of disc_brake: {BRAKE_DESIGN.name}")
    parser.add_argument(
        "--schedule", help="nominal, udds, hwfet, stops, or a CSV file of inputs over time; default: udds for disc_brake, else nominal"
    )
    parser.add_argument(
        "--interpolation", choices=host.INTERPOLATIONS, help="between the schedule's rows; default: linear as in simulate, of udds, hwfet and stops hold"
    )
    parser.add_argument("--scenes", type=int, default=None, help="default 10,000; with --benchmark 2,000")
    parser.add_argument("--total-order", action="store_true", help="Saltelli's design and total-order indices, by SALib")
    parser.add_argument("--seed", type=int, default=1, help="of the design")
    parser.add_argument("--block", type=int, help=f"scenes per task; default: 1 to {MOST_IN_A_BLOCK}, {BLOCKS} tasks for every worker")
    parser.add_argument("--step", type=float, help="communication step in seconds; default: 0.1 for udds, hwfet and stops, the scene's for nominal, else as short as the changes between the rows of the file need, at most a thousandth of its time")
    parser.add_argument("--every", type=float, help="seconds between the points that peaks are taken from; default: a thousandth, 1 s for udds, hwfet and stops")
    parser.add_argument("--scheduler", help="address of a Dask scheduler; default: a local cluster")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="processes of the local cluster")
    parser.add_argument("--no-plots", action="store_true", help="only the parts and the summary")
    parser.add_argument("--benchmark", action="store_true", help="only measure: a scene's cost, and what Dask costs")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    options = parser.parse_args()
    if options.scene is None and options.fmu is None:
        options.scene = "disc_brake"
    if options.scene == "disc_brake":
        options.design, options.schedule = options.design or BRAKE_DESIGN, options.schedule or "udds"
    if options.design is None:
        parser.error(f"{options.scene or options.fmu} needs a --design: {BRAKE_DESIGN.name} is that of the scene disc_brake")
    options.schedule = options.schedule or "nominal"
    if options.scenes is None:
        options.scenes = 2_000 if options.benchmark else 10_000
    for name in ("scenes", "block", "workers"):
        value = getattr(options, name)
        if value is not None and value < 1:
            parser.error(f"--{name} {value} must be at least 1")
    options.block = options.block or min(MOST_IN_A_BLOCK, max(1, options.scenes // (BLOCKS * options.workers)))
    for name in ("step", "every"):
        value = getattr(options, name)
        if value is not None and not 0.0 < value < float("inf"):
            parser.error(f"--{name} {value:g} must be above 0 s")
    return options


def model_description(path):
    try:
        with zipfile.ZipFile(path) as archive:
            return ElementTree.fromstring(archive.read("modelDescription.xml"))
    except (KeyError, zipfile.BadZipFile, ElementTree.ParseError) as error:
        raise ValueError(f"{path} is no FMU: {error}") from None


def level_of(job):
    """Level and tolerance of a batch, in words."""
    root, values = model_description(job.fmu), {**start_values(job.fmu), **dict(job.base)}
    if "solver.fidelity" in job.variables or "solver.tolerance" in job.variables:
        return "level and tolerance by the design"
    items = root.find("TypeDefinitions/SimpleType/Enumeration/Item[@name='lumped']/..")
    name = next(item.get("name") for item in items if float(item.get("value")) == values["solver.fidelity"])
    default = root.find("DefaultExperiment")
    tolerance = values["solver.tolerance"] or job.tolerance or float(default.get("tolerance"))
    return f"level {name}, tolerance {tolerance:g}"


def start_values(path):
    """Start values of the parameters as numbers by name, from the model description."""
    root = model_description(path)
    parameters = [variable for variable in root.iter("ScalarVariable") if variable.get("causality") == "parameter"]
    texts = {variable.get("name"): variable[0].get("start") for variable in parameters}
    return {name: float({"true": 1, "false": 0}.get(text, text)) for name, text in texts.items()}


class Progress:
    """A bar on the error stream: redrawn where that is a terminal, else a line now and then."""

    def __init__(self, total, done):
        self.total, self.done, self.failed, self.before = total, done, 0, done
        self.begin = self.shown = time.monotonic()
        self.is_terminal = sys.stderr.isatty()

    def __call__(self, scenes, failed, _seconds):
        self.done += scenes
        self.failed += failed
        now = time.monotonic()
        if now - self.shown < (0.1 if self.is_terminal else 10.0) and self.done < self.total:
            return
        self.shown = now
        part = self.done / self.total
        pace = (self.done - self.before) / max(1e-9, now - self.begin)
        left = (self.total - self.done) / pace if pace else 0.0
        line = f"  Scenes [{'#' * int(30 * part):30}] {self.done}/{self.total}, {self.failed} failed, {pace:.3g}/s, {left:.0f} s left"
        print(f"\r\033[K{line}" if self.is_terminal else line, end="" if self.is_terminal else "\n", file=sys.stderr, flush=True)

    def close(self):
        if self.is_terminal:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def prepare(options):
    """Job, design, and the distance that one run of the schedule stands for [m] (`None`: unknown)."""
    path = options.fmu or fmu("disc_brake")
    starts = start_values(path)
    scene = Scene.load(options.scene) if options.scene else scene_of(path, starts)
    kind = TotalOrderDesign if options.total_order else Design
    design = kind.read(options.design, options.scenes, options.seed)
    schedule, step, distance = schedules.of_name(options.schedule, scene, options.interpolation)
    check(options, design, scene, schedule)
    for body in ("punch", "strip"):
        table, constants = f"{body}.property_table.points", {f"{body}.conductivity", f"{body}.specific_heat"} & set(design.names)
        if constants and scene[table] and table not in design.names:
            print(f"note: {' and '.join(sorted(constants))} vary: {table} = 0, constant properties", file=sys.stderr)
            scene.set(table, 0)
    if told := left_out(options.scenes, design):
        print(f"note: {told}", file=sys.stderr)
    step = options.step or step
    every = options.every or (1.0 if options.schedule in schedules.CYCLES else step * max(1, int(schedule.times[-1] / step) // 1000))
    base = tuple((name, value) for name, value in scene.start_values().items() if starts[name] != value)
    job = parts.Job(
        fmu=str(path.resolve()),
        folder=str(options.output.resolve() / "parts"),
        schedule=schedule,
        variables=tuple(design.names),
        outputs=OUTPUTS,
        peaks=PEAKS,
        step=step,
        every=every,
        tolerance=scene.tolerance if options.scene else 0.0,
        base=base,
    )
    return job, design, distance


def left_out(asked, design):
    """What to tell where the design has fewer scenes than were asked for; empty otherwise."""
    scenes = design.groups * (len(design.variables) + 2) if isinstance(design, TotalOrderDesign) else asked
    if scenes == asked:
        return ""
    return f"--scenes {asked}: total-order indices take a power of two of groups of {len(design.variables) + 2}: {scenes} scenes now, {2 * scenes} next"


def check(options, design, scene, schedule):
    """Refuses a variable that the scene or its schedule does not have."""
    parameters = scene.start_values()
    for variable in design.variables:
        name = variable.name
        if variable.is_factor:
            if name.removesuffix(".factor") not in schedule.inputs:
                accepted = ", ".join(f"{own}.factor" for own in schedule.inputs)
                raise ValueError(f"{options.design}: {name} is no factor of the schedule {options.schedule}; accepted are {accepted}")
        elif name not in parameters:
            near = difflib.get_close_matches(name, parameters, 3)
            hint = f"did you mean {' or '.join(near)}?" if near else "its parameters and INPUT.factor are accepted"
            raise ValueError(f"{options.design}: {name} is no parameter of the scene {scene.name}; {hint}")


def scene_of(path, starts):
    """The scene that is packaged in an FMU, from its start values."""
    stock = Scene.load()
    changed = {name: starts[name] for name, own in stock.start_values().items() if starts.get(name) != own}
    missing = [name for name, value in changed.items() if value is None]
    if missing:
        raise ValueError(f"{path} is of another version than the Python package: it has no parameter {missing[0]}")
    return stock.set_numbers(changed)


def cut(rows, size, ranges=None):
    """Blocks of these ranges of scenes, by default of all: first scene, rows."""
    ranges = [(0, len(rows))] if ranges is None else ranges
    return [(first, rows[first : min(first + size, end)]) for begin, end in ranges for first in range(begin, end, size)]


def difference(found, given):
    """What tells the batch that is found in a folder from the given one, by their identities."""
    if found is None:
        return "it was made by another version of this script"
    names = [name for name in {**found, **given} if found.get(name) != given.get(name)]
    # All names in order: long, and of use where nothing else differs.
    names.sort(key=lambda name: name == "variables")
    told = [f"{name} = {found.get(name, 'none')} instead of {given.get(name, 'none')}" for name in names[:MOST_TOLD]]
    return "; ".join(told) + (f"; and {len(names) - MOST_TOLD} more" if len(names) > MOST_TOLD else "")


def counted(scenes):
    return f"{scenes} scene" if scenes == 1 else f"{scenes} scenes"


def run(options):
    import pool

    job, design, distance = prepare(options)
    rows = design.rows()
    identity = job.identity(design.identity())
    fingerprint = parts.fingerprint_of(identity)
    manifest = options.output / "batch.json"
    if manifest.is_file():
        found = json.loads(manifest.read_text(encoding="utf-8"))
        if found["fingerprint"] != fingerprint:
            raise ValueError(f"{options.output} holds another batch: {difference(found.get('identity'), identity)}; name another --output")
    Path(job.folder).mkdir(parents=True, exist_ok=True)
    settings = {name: str(value) for name, value in sorted(vars(options).items()) if name not in ("json", "benchmark")}
    parts.write_json(manifest, {"fingerprint": fingerprint, "identity": identity, "settings": settings})
    blocks = cut(rows, options.block, parts.missing(job, len(rows), fingerprint))
    there = len(rows) - sum(len(block[1]) for block in blocks)
    if there:
        print(f"{there} of {counted(len(rows))} {'is' if there == 1 else 'are'} there already.", file=sys.stderr)
    given_up = {}
    if blocks:
        progress = Progress(len(rows), there)
        with tempfile.TemporaryDirectory(prefix="sliding-contact-") as scratch:
            with pool.client(options.scheduler, min(options.workers, len(blocks)), scratch) as client:
                given_up = pool.on_dask(client, job, blocks, fingerprint, progress)
        progress.close()
    if given_up:
        first = next(iter(given_up.items()))
        raise RuntimeError(f"{len(given_up)} blocks were given up, that of scene {first[0]} for one: {first[1]}")
    summarise(options, job, design, distance, len(rows), len(rows) - there)


def life_of(table, distance):
    """Wear life of every scene: number of passes of the schedule until a body's wear limit, in km where the distance is known."""
    lives = []
    for body in ("punch", "strip"):
        limit, wear = table[f"{body}.wear_limit"].to_numpy(), table[f"wear_depth_{body}"].to_numpy()
        with np.errstate(divide="ignore", invalid="ignore"):
            lives.append(np.where((limit > 0.0) & (wear > 0.0), limit / wear, np.inf))
    life = np.minimum(*lives)
    return (life, "runs of the schedule") if distance is None else (life * distance / 1e3, "km")


def kinds_of(reasons):
    """Numbers of the scenes by their reasons, the most frequent first. Reasons that differ in numbers alone are one, by the text of the
    first: every scene of a design has values of its own."""
    kinds = {}
    for reason in reasons:
        kinds.setdefault(NUMBER.sub("0", reason), []).append(reason)
    return {same[0]: len(same) for same in sorted(kinds.values(), key=len, reverse=True)}


def summarise(options, job, design, distance, scenes, ran):
    """Table, pictures and summary of a finished batch. Scenes of a larger one before are left out."""
    import charts
    import sensitivity

    table, unit = parts.read_all(job.folder)
    table = table[table["scene"] < scenes].reset_index(drop=True)
    good = table[table["status"] == parts.OK]
    reasons = kinds_of(table.loc[table["status"] != parts.OK, "reason"].str.slice(0, 300))
    summary = {
        "scenes": len(table),
        "ran_now": ran,
        "failed": len(table) - len(good),
        "reasons": dict(list(reasons.items())[:10]),
        "cpu_seconds_per_scene": float(table["cpu_seconds"].median()),
        "results": {},
        "files": [],
    }
    life, life_unit = life_of(good, distance)
    results = {
        "wear of the punch": (good["wear_depth_punch"].to_numpy(), unit["wear_depth_punch"]),
        "peak temperature": (good["contact_temperature_max.peak"].to_numpy(), unit["contact_temperature_max.peak"]),
        "friction energy": (good["dissipated_energy"].to_numpy(), unit["dissipated_energy"]),
    }
    lasting = life[np.isfinite(life)]
    for label, (values, own_unit) in {**results, "wear life": (lasting, life_unit)}.items():
        if values.size:
            low, median, high = np.percentile(values, [10, 50, 90])
            summary["results"][label] = {"unit": own_unit, "p10": low, "median": median, "p90": high}
    # Below, the classes of the sensitivities hold a handful of scenes each.
    if options.total_order and len(good):
        x = table[list(job.variables)].to_numpy()
        columns = {"wear of the punch": "wear_depth_punch", "peak temperature": "contact_temperature_max.peak", "friction energy": "dissipated_energy"}
        found = {label: sensitivity.analyse_total_order(design, x, table[name]) for label, name in columns.items()}
        summary["total_order"] = {
            label: dict(zip(job.variables, result.total_order.tolist())) for label, result in found.items()
        }
    elif not options.no_plots and len(good) >= 50:
        x = good[list(job.variables)].to_numpy()
        found = {label: sensitivity.analyse(x, values) for label, (values, _) in results.items()}
    else:
        found = {}
    summary["sensitivities"] = {
        label: dict(zip(job.variables, result.first_order.tolist())) for label, result in found.items()
    }
    if found and not options.no_plots:
        title = f"{options.scene or options.fmu.stem}, {Path(options.schedule).stem}: {level_of(job)}; {len(good):,} scenes, {summary['failed']} failed"
        charts.sensitivities(options.output / "sensitivities.svg", job.variables, found, title)
        summary["files"].append(str(options.output / "sensitivities.svg"))
        if lasting.size:
            charts.wear_life(options.output / "wear_life.svg", lasting, life_unit, title)
            summary["files"].append(str(options.output / "wear_life.svg"))
    parts.write_json(options.output / "summary.json", summary)
    report(options, summary)
    if not len(good):
        reason = f", the first for: {table['reason'][0]}" if options.json else "; their reasons are above"
        what = "the one scene" if len(table) == 1 else f"every one of the {len(table)} scenes"
        raise RuntimeError(f"{what} failed{reason}")


def report(options, summary):
    if options.json:
        print(json.dumps(summary, indent=2))
        return
    print(f"{counted(summary['scenes'])}, {summary['failed']} failed, {summary['ran_now']} run now")
    for reason, count in summary["reasons"].items():
        print(f"  {count} x {reason}")
    print(f"  {'':18} {'10 %':>12} {'median':>12} {'90 %':>12}")
    for label, row in summary["results"].items():
        print(f"  {label:18} {row['p10']:12.5g} {row['median']:12.5g} {row['p90']:12.5g} {row['unit']}")
    for label, indices in summary.get("sensitivities", {}).items():
        strongest = sorted(indices.items(), key=lambda pair: -pair[1])[:3]
        print(f"  {label}: " + ", ".join(f"{name} {100 * index:.0f} %" for name, index in strongest))
    for label, indices in summary.get("total_order", {}).items():
        strongest = sorted(indices.items(), key=lambda pair: -pair[1])[:3]
        print(f"  {label}, with interactions: " + ", ".join(f"{name} {100 * index:.0f} %" for name, index in strongest))
    if summary.get("sensitivities"):
        print("  An index near or below 0 % is zero within its interval: noise of the estimator.")
    print("; ".join([f"  One row per scene in {options.output / 'parts'}", *(Path(name).name for name in summary["files"])]))


def benchmark(options):
    """Cost of a scene in one process, and the same work on plain processes and on Dask, in turns."""
    import pool

    job, design, _ = prepare(options)
    blocks = cut(design.rows(), options.block)
    steps = round(float(job.schedule.times[-1]) / job.step)
    with tempfile.TemporaryDirectory(prefix="sliding-contact-") as scratch:
        folder = Path(scratch)
        with host.Fmu(host.unpack(job.fmu, folder / "fmu")) as loaded:
            cpu, wall = fastest_scene(loaded, job)
        walls = {"processes": [], "dask": []}
        cpus = {"processes": [], "dask": []}
        with pool.client(options.scheduler, options.workers, folder) as client:
            pool.warm_up(client, job)
            for turn in range(3):
                for way in walls:
                    own = parts.Job(**{**vars(job), "folder": str(folder / f"{way}-{turn}")})
                    Path(own.folder).mkdir()
                    fingerprint = parts.fingerprint_of(own.identity(design.identity()))
                    if way == "processes":
                        seconds, busy = pool.on_processes(own, blocks, fingerprint, options.workers)
                    else:
                        begin, before = time.perf_counter(), pool.cpu_of_all()
                        given_up = pool.on_dask(client, own, blocks, fingerprint, lambda *_: None)
                        seconds, busy = time.perf_counter() - begin, pool.cpu_of_all() - before
                        if given_up:
                            raise RuntimeError(f"blocks were given up: {given_up}")
                    walls[way].append(seconds)
                    cpus[way].append(busy)
    processes, dask = min(walls["processes"]), min(walls["dask"])
    result = {
        "schedule": options.schedule,
        "steps_per_scene": steps,
        "scenes_per_second_and_core": 1.0 / cpu,
        "wanted_scenes_per_second_and_core": WANTED_PACE,
        "nanoseconds_per_step": 1e9 * cpu / steps,
        "wall_over_cpu_of_a_scene": wall / cpu,
        "workers": options.workers,
        "scenes": len(design.rows()),
        "processes_seconds": walls["processes"],
        "dask_seconds": walls["dask"],
        "lost_to_dask": 1.0 - processes / dask,
        "processes_cpu_seconds": cpus["processes"],
        "dask_cpu_seconds": cpus["dask"],
        # On a busy machine the clock measures the others; what Dask itself takes shows in CPU time. Its scheduler's
        # share is only seen with a local cluster.
        "lost_to_dask_of_cpu": 1.0 - min(cpus["processes"]) / min(cpus["dask"]) if options.scheduler is None else None,
        "wanted_lost_to_dask": WANTED_LOSS,
        "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }
    if options.json:
        print(json.dumps(result, indent=2))
        return
    print(f"One scene ({options.schedule}, {steps} steps, instance reused): {1e3 * cpu:.2f} ms of CPU, {1e9 * cpu / steps:.0f} ns a step")
    print(f"  {1.0 / cpu:.0f} scenes per second and core, target {WANTED_PACE:.0f}")
    print(f"{counted(len(design.rows()))} of the design, {options.workers} workers, best of 3 turns:")
    print(f"  plain processes {processes:7.2f} s   ({', '.join(f'{s:.2f}' for s in walls['processes'])})")
    print(f"  Dask            {dask:7.2f} s   ({', '.join(f'{s:.2f}' for s in walls['dask'])})")
    print(f"  lost to Dask {100 * result['lost_to_dask']:.1f} %, target at most {100 * WANTED_LOSS:.0f} %")
    if options.scheduler is None:
        print(
            f"  of CPU time: {min(cpus['processes']):.2f} s and {min(cpus['dask']):.2f} s, all of Dask included: "
            f"lost {100 * result['lost_to_dask_of_cpu']:.1f} %"
        )
    if wall > 1.2 * cpu:
        print(f"  The machine is busy: even the fastest scene took {wall / cpu:.1f} times its CPU time.")


def fastest_scene(loaded, job):
    """CPU and wall seconds of the scene as packaged; the best of many, since other work only ever adds."""
    cpu = wall = float("inf")
    for _ in range(40):
        begin, clock = time.perf_counter(), time.thread_time()
        host.run_schedule(loaded, dict(job.base), job.schedule, outputs=OUTPUTS, step=job.step)
        cpu, wall = min(cpu, time.thread_time() - clock), min(wall, time.perf_counter() - begin)
    return cpu, wall


def main():
    options = arguments()
    benchmark(options) if options.benchmark else run(options)


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        print("stopped; the same command continues where it was", file=sys.stderr, flush=True)
        # Dask would wait for a cluster whose start was cut short.
        os._exit(130)
