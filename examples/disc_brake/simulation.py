"""Drives the FMU with fmpy and records its outputs."""

import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.simulation import instantiate_fmu

INPUTS = ("sliding_velocity", "normal_load")
OUTPUTS = (
    "wear_depth_punch",
    "wear_depth_strip",
    "wear_volume_punch",
    "wear_volume_strip",
    "wear_mass_punch",
    "wear_mass_strip",
    "wear_mass_airborne",
    "contact_temperature",
    "contact_temperature_max",
    "punch.mean_temperature",
    "strip.mean_temperature",
    "friction_force",
    "friction_torque",
    "friction_power",
    "friction_coefficient",
    "pressure_mean",
    "heat_flow_punch",
    "heat_flow_strip",
    "heat_flow_ambient",
    "heat_flow_punch_top",
    "heat_flow_strip_base",
    "heat_lost_ambient",
    "heat_lost_punch_top",
    "heat_lost_strip_base",
    "dissipated_energy",
    "stored_heat",
    "sliding_distance",
    "estimated_error",
)


@dataclass(frozen=True)
class Recording:
    """Results of a run."""

    table: np.ndarray  # structured: time, inputs, outputs
    units: dict  # name to unit
    steps: int
    seconds: float  # wall time of the stepping, fmpy included

    def __getitem__(self, name):
        return self.table[name]


class Progress:
    """A bar on the error stream, redrawn ten times a second; silent where that is no terminal."""

    def __init__(self, stop, is_shown=True):
        self.stop = stop
        self.shown = 0.0
        self.is_active = is_shown and sys.stderr.isatty()

    def __call__(self, now):
        if not self.is_active:
            return
        clock = time.monotonic()
        if clock - self.shown > 0.1 or now >= self.stop:
            self.shown = clock
            done = min(1.0, now / self.stop)
            print(f"\r  Driving [{'#' * int(30 * done):30}] {now:5.0f} / {self.stop:.0f} s", end="", file=sys.stderr)

    def close(self):
        if self.is_active:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def describe(fmu):
    """Model description of the FMU and its start values by name."""
    description = read_model_description(str(fmu), validate=True)
    return description, {variable.name: variable.start for variable in description.modelVariables}


def with_optional_inputs(signals, description):
    """The signals with a column of its start value for every missing input: fmpy warns of each."""
    inputs = {variable.name: float(variable.start) for variable in description.modelVariables if variable.causality == "input"}
    complete = np.zeros(len(signals), dtype=[("time", np.float64), *((name, np.float64) for name in inputs)])
    for name, start in inputs.items():
        complete[name] = start
    for name in signals.dtype.names:
        complete[name] = signals[name]
    return complete


# The contact line is run beside the level of the scene, and on half the cells, which says whether it is converged.
LINE_CELLS = (17, 9)


def line(cells):
    """Start values of the contact line on so many cells."""
    return {"solver.fidelity": 3, "solver.cells": cells, "solver.tolerance": 1e-3}


def level(description):
    """Level of the scene: auto, lumped or line."""
    variable = next(variable for variable in description.modelVariables if variable.name == "solver.fidelity")
    items = {item.value: item.name for item in variable.declaredType.items}
    return items[str(variable.start)]


def drive_lines(fmu, signals, step):
    """The contact line on `LINE_CELLS`, at the same time: the FMU computes without the interpreter's lock."""
    with ThreadPoolExecutor() as pool:
        runs = [pool.submit(drive, fmu, signals, step, line(cells), cells == LINE_CELLS[0]) for cells in LINE_CELLS]
        return [run.result() for run in runs]


def drive(fmu, signals, step, start_values=None, shown=True):
    """Runs the FMU over `signals` (see `Drive.signals`) with the communication step `step` [s]; `start_values` [name to
    value] replace those of the scene; `shown`: with a bar of progress."""
    description, _ = describe(fmu)
    units = {variable.name: variable.unit or "1" for variable in description.modelVariables}
    stop = float(signals["time"][-1])
    progress = Progress(stop, shown)

    def step_finished(now, _recorder):
        progress(now)
        return True

    folder = extract(str(fmu))
    # Unpacking and loading are not part of the pace.
    instance = instantiate_fmu(folder, description, "CoSimulation")
    try:
        begin = time.perf_counter()
        table = simulate_fmu(
            folder,
            model_description=description,
            fmu_instance=instance,
            stop_time=stop,
            step_size=step,
            start_values=start_values or {},
            output_interval=step,
            input=with_optional_inputs(signals, description),
            output=[*INPUTS, *OUTPUTS],
            step_finished=step_finished,
        )
        seconds = time.perf_counter() - begin
    finally:
        progress.close()
        instance.freeInstance()
    if abs(table["time"][-1] - stop) > 1e-6 * stop:
        raise RuntimeError(f"the FMU stopped at {table['time'][-1]:.6g} s of {stop:.6g} s")
    return Recording(table, units, len(table) - 1, seconds)
