"""Slides the reciprocating punch's FMU to and fro until its wear is steady: pressure of successive half-strokes, edge
pressures, worn shape, for a punch that can only translate and for one that can also rotate, beside the direct steady state.

Run by `cargo fmu run reciprocating_punch`, which builds the FMU and the Python environment and computes the direct
steady states; by hand:

    python strokes.py --fmu SlidingContact.fmu --output results [--steady translate.json rotate.json]
"""

import argparse
import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

LINE = 3
TRANSLATE, ROTATE = 1, 2
AMPLITUDE = 1.5e-3  # of the punch's displacement [m]
FREQUENCY = 10.0  # angular [rad/s]
LOAD = 1e4  # [N]
STEPS = 30  # in a half-stroke
STATIONS = 33
HOLDERS = {
    "translate": {"holder.constraint": TRANSLATE},
    # A quarter of the half-width: mu H = 7.5 mm of 30 mm; half of what a steady cycle can bear.
    "rotate": {"holder.constraint": ROTATE, "holder.pivot_height": 30e-3},
}


@dataclass(frozen=True)
class History:
    """What one holder gave."""

    x: np.ndarray  # stations [m]
    half_strokes: np.ndarray  # number of every recorded half-stroke, from 1
    pressure: np.ndarray  # at its middle, by half-stroke and station [Pa]
    worn: np.ndarray  # worn depth of the punch there [m]
    tilt: np.ndarray  # [rad]
    approach: np.ndarray  # [m]
    mean: float  # mean pressure [Pa]
    half_stroke_mean: tuple  # means over the last forward and backward half-stroke [Pa]
    seconds: float  # wall time
    steps: int


def names(profile):
    return [f"profile.{profile}[{station + 1}]" for station in range(STATIONS)]


def recorded(cycles):
    """Half-strokes to record: every one of the first cycles, then ever fewer, always both directions."""
    firsts = np.unique(np.concatenate([np.arange(1, 6), np.geomspace(6, cycles, 60).astype(int)]))
    return np.unique(np.concatenate([2 * firsts - 1, 2 * firsts]))


def slide(fmu, folder, description, parameters, cycles):
    """Slides to and fro for `cycles` cycles; velocity held over every step at the value that makes the exact distance."""
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    kinds = {variable.name: variable.type for variable in description.modelVariables}
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="punch",
    )
    slave.instantiate()
    try:
        for name, value in {"solver.fidelity": LINE, **parameters}.items():
            if kinds[name] == "Real":
                slave.setReal([reference[name]], [value])
            else:
                slave.setInteger([reference[name]], [value])
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.setReal([reference["normal_load"]], [LOAD])
        slave.exitInitializationMode()
        x = np.array(slave.getReal([reference[name] for name in names("x")]))
        watched = [reference[name] for name in names("pressure") + names("wear_punch") + ["tilt", "approach"]]
        pressures = [reference[name] for name in names("pressure")]
        velocity, load = [reference["sliding_velocity"]], LOAD
        step = np.pi / FREQUENCY / STEPS
        # Displacement -A cos(10 t): a half-stroke from one end to the other; mean velocity of every step.
        corners = -AMPLITUDE * np.cos(np.pi * np.arange(STEPS + 1) / STEPS)
        speeds = np.diff(corners) / step
        chosen, rows, now = set(recorded(cycles).tolist()), [], 0.0
        sums = {1: np.zeros(STATIONS), -1: np.zeros(STATIONS)}
        begin = time.perf_counter()
        for half in range(1, 2 * cycles + 1):
            direction = 1 if half % 2 else -1
            for part, speed in enumerate(speeds):
                slave.setReal(velocity, [direction * speed])
                slave.doStep(now, step)
                now += step
                if part + 1 == STEPS // 2 and half in chosen:
                    rows.append((half, slave.getReal(watched)))
                if half > 2 * cycles - 2:
                    sums[direction] += np.array(slave.getReal(pressures)) * speed * step / (2 * AMPLITUDE)
        seconds = time.perf_counter() - begin
    finally:
        slave.terminate()
        slave.freeInstance()
    values = np.array([row[1] for row in rows])
    width = x[-1] - x[0]
    depth = float({v.name: v.start for v in description.modelVariables}["depth"])
    return History(
        x=x,
        half_strokes=np.array([row[0] for row in rows]),
        pressure=values[:, :STATIONS],
        worn=values[:, STATIONS : 2 * STATIONS],
        tilt=values[:, -2],
        approach=values[:, -1],
        mean=load / (width * depth),
        half_stroke_mean=(sums[1], sums[-1]),
        seconds=seconds,
        steps=2 * cycles * STEPS,
    )


def table(histories, steadies):
    """A few numbers of every holder."""
    lines = ["holder      edges forward p/pm    edges backward p/pm   sum of half-stroke means   from steady   steps/s"]
    for name, history in histories.items():
        forward, backward = history.pressure[-2] / history.mean, history.pressure[-1] / history.mean
        total = sum(history.half_stroke_mean) / history.mean
        steady = steadies.get(name)
        distance = "-"
        if steady is not None:
            exact = np.interp(history.x[2:-2], *steady["forward"]) / history.mean
            distance = f"{np.max(np.abs(forward[2:-2] - exact)):.2e}"
        lines.append(
            f"{name:11} {forward[0]:8.4f} {forward[-1]:9.4f}  {backward[0]:11.4f} {backward[-1]:9.4f}"
            f"     2 {np.max(np.abs(total[1:-1] - 2)):+12.1e}{'':8}{distance:>13} {history.steps / history.seconds:9.0f}"
        )
    return "\n".join(lines)


def write_csv(path, history):
    header = ",".join(["half_stroke", "tilt_rad", "approach_m"] + [f"pressure_Pa_at_{x:.6f}_m" for x in history.x])
    columns = [history.half_strokes, history.tilt, history.approach, *history.pressure.T]
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.9g")


def read_steady(path):
    """Cell centres and pressures of a direct steady state as `cargo fmu steady --json` prints it."""
    state = json.loads(Path(path).read_text(encoding="utf-8"))
    x = np.array(state["x"])
    return {"forward": (x, np.array(state["forward"])), "backward": (x, np.array(state["backward"])), "state": state}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of the reciprocating punch")
    parser.add_argument("--output", type=Path, required=True, help="folder for CSV and plots")
    parser.add_argument("--cycles", type=int, default=1200, help="cycles to slide (default 1200)")
    parser.add_argument("--cells", type=int, default=33, help="cells of the contact line (default 33)")
    parser.add_argument("--steady", nargs=2, metavar=("TRANSLATE", "ROTATE"), help="direct steady states as JSON")
    options = parser.parse_args()
    description = read_model_description(str(options.fmu), validate=True)
    folder = extract(str(options.fmu))
    steadies = {}
    if options.steady:
        steadies = {name: read_steady(path) for name, path in zip(HOLDERS, options.steady, strict=True)}
    histories = {
        name: slide(options.fmu, folder, description, {**parameters, "solver.cells": options.cells}, options.cycles)
        for name, parameters in HOLDERS.items()
    }
    options.output.mkdir(parents=True, exist_ok=True)
    import stroke_plots

    files = []
    for name, history in histories.items():
        files.append(options.output / f"half_strokes_{name}.csv")
        write_csv(files[-1], history)
    files += stroke_plots.save(options.output, histories, steadies)
    print(f"{description.modelName}: {options.cycles} cycles of {2e3 * AMPLITUDE:g} mm strokes at {LOAD / 1e3:g} kN")
    print(table(histories, steadies))
    print(f"  Written to {options.output}: {', '.join(path.name for path in files)}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
