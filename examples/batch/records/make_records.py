"""Makes pin_on_disk.csv: synthetic records with known truth, so that a fit can be judged.

    python make_records.py > pin_on_disk.csv

Conditions around those of ASTM G99 (10 N, 0.1 m/s, 1,000 m, steel on steel), three tests at each load; volumes from the
scene with the truth below, times exp(normal noise).
"""

import numpy as np

from sliding_contact import Scene, fit

TRUTH = {fit.COEFFICIENT: 1.2e-14, fit.PRESSURE_EXPONENT: 1.3}
SCATTER = 0.10  # of ln(volume): about what repeated tests show
LOADS = (2.5, 5.0, 10.0, 20.0, 40.0)  # N
DISTANCES = (300.0, 1000.0)  # m
SPEED = 0.1  # m/s
REPETITIONS = 3
SEED = 1999
# The records stay what they are, whatever `auto` chooses.
LEVEL = {"solver.fidelity": "line", "solver.cells": 9, "solver.tolerance": 1e-2}


def scene():
    return Scene.load("pin_on_disk").set(LEVEL)


def conditions():
    table = [(load, SPEED, distance, 1.0) for load in LOADS for distance in DISTANCES for _ in range(REPETITIONS)]
    return fit.Records(*np.array(table).T)


def noise(seed):
    return np.random.default_rng(seed).normal(0.0, SCATTER, len(LOADS) * len(DISTANCES) * REPETITIONS)


def main():
    tests = conditions()
    volumes = fit.Model(scene(), tests).predict(TRUTH) * np.exp(noise(SEED))
    print("# Synthetic: made by make_records.py, which holds the truth. Steel pin on a steel disk, conditions around ASTM G99.")
    print("load [N],speed [m/s],distance [m],volume [mm3]")
    for load, speed, distance, volume in zip(tests.load, tests.speed, tests.distance, volumes):
        print(f"{load:g},{speed:g},{distance:g},{1e9 * volume:.4g}")


if __name__ == "__main__":
    main()
