"""Isothermal wear of a flat punch on a half-plane with Tamaas, as a competent user of it would compute it.

Reads the scene as JSON from standard input and writes one JSON object per run (see fmu-build/lab/src/chart/peers.rs).

Tamaas solves the contact of an elastic half-plane with a rigid surface, periodic along x, by conjugate gradients on FFTs.
Archard's law is stepped around it, explicitly: the surface loses k p ds. Two schemes, Euler's and Heun's, with steps
that are parts of the stability bound `k ds < 2 lambda_min`, `lambda_min = 2 c/(pi E*)` being the compliance of the
shortest wave on points at a distance c. The punch stands in a period of 16 half-widths, and the leading effect of its
images, a parabola `pi P x^2/(3 E* L^2)` of displacement (P load per depth, L period), is taken off the surface. Solves start
from the pressure before. As the runs that it is compared with, a short run is repeated and the fastest counts.
"""

import json
import sys
import time

import numpy as np
import tamaas as tm

PERIOD = 16  # half-widths
# Error of a contact solution as Tamaas measures it, relative to the height of the surface: 1e-8 gives the same pressures at
# twice the cost, 1e-3 others by up to a fifth.
CONJUGATE_GRADIENTS = 1e-5
REPEATS = 0.1  # total processor time of the repeated measurements of a short run, s
DEEP = 30.0  # depth of the surface beside the punch, which never touches


class Punch:
    """The wearing punch on `count` points, in the units E* = a = mean pressure = k = 1: the problem is linear."""

    def __init__(self, count):
        # The points stand in the middle of the cells that tile the punch.
        self.total = count * PERIOD // 2
        self.spacing = 2.0 / count
        x = (np.arange(self.total) - (self.total - 1) / 2) * self.spacing
        self.inside = np.abs(x) < 1.0
        self.mean_over_period = 2.0 / PERIOD
        images = np.pi * 2.0 * x**2 / (3.0 * PERIOD**2)
        self.surface = np.where(self.inside, images, -DEEP)
        self.model = tm.Model(tm.model_type.basic_1d, [float(PERIOD)], [self.total])
        self.model.E, self.model.nu = 1.0, 0.0
        self.solver = tm.PolonskyKeerRey(self.model, self.surface.copy(), CONJUGATE_GRADIENTS)
        self.solves = 0

    def pressure(self, worn):
        """Pressure on the punch after `worn` of it is gone."""
        surface = self.surface.copy()  # the solver works on an array of its own
        surface[self.inside] -= worn
        self.solver.surface[:] = surface
        self.solver.solve(self.mean_over_period)
        self.solves += 1
        return self.model.traction[self.inside].copy()

    def bound(self):
        """Longest stable path of an explicit step."""
        return 4.0 * self.spacing / np.pi


def station_peak(pressure, stations):
    """Largest mean over the intervals of the stations, the outer ones halved, of cell values on the punch."""
    count = pressure.size
    primitive = np.concatenate(([0.0], np.cumsum(pressure))) / count
    edges = np.clip((np.arange(stations + 1) - 0.5) / (stations - 1), 0.0, 1.0)
    values = np.interp(edges, np.linspace(0.0, 1.0, count + 1), primitive)
    return np.max(np.diff(values) / np.diff(edges))


def run(scene, count, part, scheme):
    value = scene["parameters"].get
    half_width = 0.5 * value("punch.width")
    modulus = value("strip.youngs_modulus") / (1.0 - value("strip.poissons_ratio") ** 2)
    velocity, load = scene["inputs"][0][1], scene["inputs"][0][2]
    mean = load / (value("punch.width") * value("depth"))
    samples = []
    begin = time.process_time()
    punch = Punch(count)
    ready = time.process_time()
    # Path in a/(k E*), worn depth in a times mean pressure over E*.
    worn, path, steps = np.zeros(count), 0.0, 0
    pressure = punch.pressure(worn)
    for sample in scene["samples"]:
        target = value("punch.wear_coefficient") * velocity * sample * modulus / half_width
        number = max(1, int(np.ceil((target - path) / (part * punch.bound()))))
        step = (target - path) / number
        for _ in range(number):
            if scheme == "Euler":
                worn = worn + step * pressure
                pressure = punch.pressure(worn)
            else:
                predicted = punch.pressure(worn + step * pressure)
                worn = worn + 0.5 * step * (pressure + predicted)
                pressure = punch.pressure(worn)
            steps += 1
        path = target
        depth = half_width * mean / modulus * worn.mean()
        samples.append([depth, None, None, mean * station_peak(pressure, scene["stations"])])
    end = time.process_time()
    return {
        "family": f"Tamaas, {scheme}, steps {part:g} of the explicit bound",
        "setting": f"{count} points under the punch, {punch.solves} contact solutions",
        "initialisation": ready - begin,
        "seconds": end - begin,
        "steps": steps,
        "samples": samples,
    }


def fastest(*arguments):
    """The fastest of as many equal runs as there is time for."""
    best = run(*arguments)
    spent = best["seconds"]
    while spent < REPEATS:
        again = run(*arguments)
        spent += again["seconds"]
        if again["seconds"] < best["seconds"]:
            best = again
    return best


def main():
    scene = json.load(sys.stdin)
    tm.set_log_level(tm.LogLevel.error)
    for scheme, part in (("Euler", 0.9), ("Heun", 0.9), ("Heun", 0.3)):
        for count in (32, 64, 128, 256):
            print(json.dumps(fastest(scene, count, part, scheme)), flush=True)


if __name__ == "__main__":
    main()
