"""The reciprocating punch's FMU at the level of the contact line in reciprocating sliding."""

import shutil
import time
from dataclasses import dataclass

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

AMPLITUDE = 1.5e-3  # of the punch's displacement [m]
FREQUENCY = 10.0  # angular [rad/s]
STEPS = 10  # in a half-stroke; even, so that a step ends in its middle
STATIONS = 33
# The level of the contact line, for pressure and wear alone.
COLD = {
    "solver.fidelity": "line",
    "solver.heat": "mean",
    "punch.thermal_expansion": 0.0,
    "strip.thermal_expansion": 0.0,
}
HOT_CELLS = 33
PROFILES = ("pressure", "wear_punch", "temperature")
SCALARS = ("tilt", "approach")


class Unpacked:
    """An FMU on disk, unpacked; use as a context manager."""

    def __init__(self, path):
        self.description = read_model_description(str(path), validate=True)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.folder = extract(str(path))

    def start(self, name):
        return float(self.variables[name].start)

    def references(self, *names):
        return [self.variables[name].valueReference for name in names]

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        shutil.rmtree(self.folder, ignore_errors=True)


class Punch:
    """One initialised instance; enumeration items may be given by name. Use as a context manager."""

    def __init__(self, unpacked, parameters, load, velocity=0.0):
        self.unpacked = unpacked
        self.time = 0.0
        self.slave = FMU2Slave(
            guid=unpacked.description.guid,
            unzipDirectory=unpacked.folder,
            modelIdentifier=unpacked.description.coSimulation.modelIdentifier,
            instanceName="punch",
        )
        self.slave.instantiate()
        for name, value in {**COLD, **parameters}.items():
            self._set(name, value)
        self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        self._set("normal_load", load)
        self._set("sliding_velocity", velocity)
        self.slave.exitInitializationMode()
        self.velocity = unpacked.references("sliding_velocity")

    def _set(self, name, value):
        variable = self.unpacked.variables[name]
        if isinstance(value, str):
            value = next(int(item.value) for item in variable.declaredType.items if item.name == value)
        setter = self.slave.setReal if variable.type == "Real" else self.slave.setInteger
        setter([variable.valueReference], [value])

    def profile(self, name):
        return self.get(*(f"profile.{name}[{station + 1}]" for station in range(STATIONS)))

    def get(self, *names):
        return np.array(self.slave.getReal(self.unpacked.references(*names)))

    def step(self, velocity, length):
        self.slave.setReal(self.velocity, [velocity])
        self.slave.doStep(self.time, length)
        self.time += length

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        self.slave.freeInstance()


@dataclass(frozen=True)
class History:
    """Half-strokes under one holder; rows are those that were recorded, in pairs: forward, backward."""

    x: np.ndarray  # stations [m]
    half_strokes: np.ndarray  # number of every recorded half-stroke, from 1; odd ones go forward
    pressure: np.ndarray  # at its middle, by half-stroke and station [Pa]
    worn: np.ndarray  # worn depth of the punch there [m]
    temperature: np.ndarray  # of the contact there [K]
    tilt: np.ndarray  # [rad]
    approach: np.ndarray  # [m]
    mean: float  # mean pressure [Pa]
    means: dict  # over the last half-stroke forward (1) and backward (-1), by station [Pa]
    reversal: dict  # pressure and worn depth at the stations just before and after the last reversal [Pa, m]
    acceleration: float  # of the wear
    seconds: float  # wall time
    steps: int

    @property
    def cycles(self):
        """Cycles of unaccelerated wear at every recorded half-stroke."""
        return self.acceleration * 0.5 * self.half_strokes


def recorded(cycles):
    """Cycles to record: each of the first ones, then ever fewer, and the last."""
    return np.unique(np.concatenate([np.arange(1, 6), np.geomspace(6, max(cycles, 6), 80).astype(int), [cycles]]))


def velocities():
    """Velocity in every step of a forward half-stroke: the displacement -A cos(10 t) exact at the ends of the steps."""
    corners = -AMPLITUDE * np.cos(np.pi * np.arange(STEPS + 1) / STEPS)
    return np.diff(corners) / step_length()


def step_length():
    return np.pi / FREQUENCY / STEPS


def hot(unpacked, parameters):
    """The same holder with the distortion by heat that the scene's materials have."""
    expansions = {name: unpacked.start(name) for name in COLD if name.endswith("thermal_expansion")}
    return {**parameters, **expansions, "solver.heat": "resolved", "solver.cells": HOT_CELLS}


def slide(unpacked, parameters, load, cycles, acceleration=1.0):
    """Reciprocating sliding of `cycles` cycles under a dead load."""
    length, speeds = step_length(), velocities()
    chosen, rows, numbers = set(recorded(cycles).tolist()), [], []
    watched = unpacked.references(
        *(f"profile.{name}[{station + 1}]" for name in PROFILES for station in range(STATIONS)), *SCALARS
    )
    with Punch(unpacked, {**parameters, "wear_acceleration": acceleration}, load) as punch:
        x = punch.profile("x")
        begin = time.perf_counter()
        for cycle in range(1, cycles + 1):
            if cycle == cycles:
                depths = [punch.profile("wear_punch")]
            for direction in (1, -1):
                for part, speed in enumerate(speeds):
                    punch.step(direction * speed, length)
                    if part + 1 == STEPS // 2 and cycle in chosen:
                        rows.append(punch.slave.getReal(watched))
                        numbers.append(2 * cycle - (direction > 0))
                if cycle == cycles:
                    depths.append(punch.profile("wear_punch"))
        seconds = time.perf_counter() - begin
        reversal = {"before": (punch.profile("pressure"), punch.profile("wear_punch"))}
        # The outputs follow the input: the pressure under friction forward, nothing moved yet.
        punch.slave.setReal(punch.velocity, [speeds[0]])
        reversal["after"] = (punch.profile("pressure"), punch.profile("wear_punch"))
    values = np.array(rows)
    # The wear law with both exponents 1 read backwards: depth = k p s.
    wear_of_unit_pressure = unpacked.start("punch.wear_coefficient") * 2.0 * AMPLITUDE * acceleration
    forward, backward = np.diff(depths, axis=0) / wear_of_unit_pressure
    return History(
        x=x,
        half_strokes=np.array(numbers),
        pressure=values[:, :STATIONS],
        worn=values[:, STATIONS : 2 * STATIONS],
        temperature=values[:, 2 * STATIONS : 3 * STATIONS],
        tilt=values[:, -2],
        approach=values[:, -1],
        mean=load / ((x[-1] - x[0]) * unpacked.start("depth")),
        means={1: forward, -1: backward},
        reversal=reversal,
        acceleration=acceleration,
        seconds=seconds,
        steps=2 * cycles * STEPS,
    )
