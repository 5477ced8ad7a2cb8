"""How often the intervals of a fit hold the truth: synthetic data sets with known parameters, in six cases.

    python tests/python/intervals.py [--sets 100] [--case NAME ...]

Of 100 intervals of 95 %, 90 to 99 hold it with a probability of 0.98 each, where they are right. The critical speeds are 0.38 m/s of the pin
and 3.0 m/s of the
brake.
"""

import argparse
import os
import sys
import time
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from sliding_contact import Scene, fit

SCATTER = 0.1  # relative, of a worn volume
LINE = {"solver.fidelity": "line", "solver.cells": 9, "solver.tolerance": 1e-2}
LUMPED = {"solver.fidelity": "lumped"}
WEAR = {fit.COEFFICIENT: 1.2e-14, fit.PRESSURE_EXPONENT: 1.3}
HEAT = {"contact.friction_coefficient": 0.4, "strip.convection": 12.0, "punch.wear_coefficient": 2e-14}
NOISE = {"strip.mean_temperature": 1.0, "friction_force": 40.0, "wear_depth_punch": 5e-8}  # K, N, m


def end_values(scene, settings, loads, speed, distance):
    """Worn volumes of four tests at each load."""
    load = np.repeat(loads, 4)
    one = np.ones(load.size)

    def tests(clean, random):
        volume = one if clean is None else clean * np.exp(random.normal(0.0, SCATTER, load.size))
        return fit.Records(load, speed * one, distance * one, volume)

    return Scene.load(scene).set(settings), tests, WEAR


def histories(settings, speeds):
    """Temperature, friction force and wear of a brake that drags over 300 m and cools, at two speeds."""

    def inputs(speed):
        end = 300.0 / speed
        return {"time [s]": [0.0, end, end + 0.5, 1200.0], "sliding_velocity [m/s]": [speed, speed, 0.0, 0.0], "normal_load [kN]": [2, 2, 0, 0]}

    def tests(clean, random):
        made, at = [], 0
        for number, speed in enumerate(speeds):
            measured = {}
            braked = np.linspace(1.0, 300.0 / speed, 30)
            for name, times in (("strip.mean_temperature", np.linspace(20.0, 1200.0, 60)), ("friction_force", braked), ("wear_depth_punch", braked)):
                values = np.ones(times.size) if clean is None else clean[at : at + times.size] + random.normal(0.0, NOISE[name], times.size)
                measured[name] = (times, values)
                at += times.size
            made.append(fit.Test(inputs(speed), measured, f"drag {number + 1}"))
        return made

    start = {"contact.friction_coefficient": 0.3, "strip.convection": 20.0, "punch.wear_coefficient": 1e-14}
    return Scene.load("disc_brake").set({**settings, **start}), tests, HEAT


CASES = {
    "lumped, below, end values": lambda: end_values("pin_on_disk", LUMPED, (2.5, 10.0, 40.0), 0.1, 300.0),
    "line, below, end values": lambda: end_values("pin_on_disk", LINE, (2.5, 10.0, 40.0), 0.1, 300.0),
    "lumped, above, end values": lambda: end_values("disc_brake", LUMPED, (1000.0, 2000.0, 4000.0), 10.0, 30.0),
    "line, above, end values": lambda: end_values("disc_brake", LINE, (1000.0, 2000.0, 4000.0), 10.0, 30.0),
    "lumped, below, histories": lambda: histories(LUMPED, (2.5, 1.5)),
    "line, above, histories": lambda: histories(LINE, (22.0, 16.0)),
}


def inside(case, sets, first=0):
    """How many of the intervals of each parameter hold the truth."""
    scene, tests, truth = CASES[case]()
    clean = fit.Model(scene, tests(None, None)).predict(truth)
    exact = np.array(list(truth.values()))

    def holds(seed):
        drawn = tests(clean, np.random.default_rng(seed))
        found = fit.fit(fit.Model(scene, drawn), tuple(truth), companion=False)
        assert found.names == tuple(truth), (seed, found.undetermined)
        low, high = found.intervals
        return (low < exact) & (exact < high)

    # The library computes without the interpreter's lock.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return sum(np.array(held, int) for held in pool.map(holds, range(first, first + sets)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--case", nargs="+", choices=CASES, default=list(CASES))
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    wrong = False
    for case in options.case:
        begin = time.monotonic()
        count = inside(case, options.sets)
        wrong |= bool(np.any((count < 0.9 * options.sets) | (count > 0.99 * options.sets)))
        print(f"{case}: {', '.join(map(str, count))} of {options.sets}, {time.monotonic() - begin:.0f} s", flush=True)
    sys.exit("outside of 90 to 99 in 100" if wrong else 0)


if __name__ == "__main__":
    main()
