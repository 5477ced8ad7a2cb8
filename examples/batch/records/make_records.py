"""Makes pin_on_disk.csv: synthetic records with known truth, so that a fit can be judged.

    python make_records.py SlidingContact.pin_on_disk.fmu libfmu_host.so > pin_on_disk.csv

Conditions around those of ASTM G99 (10 N, 0.1 m/s, 1,000 m, steel on steel), three tests at each load; volumes from the
FMU with the truth below, times exp(normal noise).
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import host  # noqa: E402
import wear_law  # noqa: E402

TRUTH = {wear_law.COEFFICIENT: 1.2e-14, wear_law.EXPONENTS["pressure"]: 1.3}
SCATTER = 0.10  # of ln(volume): about what repeated tests show
LOADS = (2.5, 5.0, 10.0, 20.0, 40.0)  # N
DISTANCES = (300.0, 1000.0)  # m
SPEED = 0.1  # m/s
REPETITIONS = 3
SEED = 1999


def conditions():
    table = [(load, SPEED, distance, 1.0) for load in LOADS for distance in DISTANCES for _ in range(REPETITIONS)]
    return wear_law.Records(*np.array(table).T)


def noise(seed):
    return np.random.default_rng(seed).normal(0.0, SCATTER, len(LOADS) * len(DISTANCES) * REPETITIONS)


def main(fmu, library):
    tests = conditions()
    with tempfile.TemporaryDirectory() as scratch, host.Fmu(host.unpack(fmu, Path(scratch) / "fmu"), library) as own:
        volumes = wear_law.Model(own, tests).volumes(TRUTH) * np.exp(noise(SEED))
    print("# Synthetic: made by make_records.py, which holds the truth. Steel pin on a steel disk, conditions around ASTM G99.")
    print(",".join(wear_law.COLUMNS))
    for load, speed, distance, volume in zip(tests.load, tests.speed, tests.distance, volumes):
        print(f"{load:g},{speed:g},{distance:g},{1e9 * volume:.4g}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
