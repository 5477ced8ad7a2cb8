"""The FMU of two rings face to face, and the growth of its pressure waves in theory."""

import shutil
import time
from dataclasses import dataclass

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STATIONS = 33
STEP = 0.1  # communication step [s]
LOAD = 200.0  # [N]
SCALARS = (
    "contact_temperature",
    "contact_temperature_max",
    "contact_fraction",
    "pressure_max",
    "dissipated_energy",
    "stored_heat",
    "heat_lost_ambient",
    "heat_lost_punch_top",
    "heat_lost_strip_base",
)


class Unpacked:
    """An FMU on disk, unpacked; use as a context manager."""

    def __init__(self, path):
        self.description = read_model_description(str(path), validate=True)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.folder = extract(str(path))

    def start(self, name):
        return float(self.variables[name].start)

    def level(self):
        """Level, cells and tolerance of a run."""
        item = next(item for item in self.variables["solver.fidelity"].declaredType.items if int(item.value) == int(self.start("solver.fidelity")))
        tolerance = self.start("solver.tolerance") or float(self.description.defaultExperiment.tolerance)
        return f"level {item.name}, {self.start('solver.cells'):.0f} cells, tolerance {tolerance:g}"

    def references(self, *names):
        return [self.variables[name].valueReference for name in names]

    def started(self, speed):
        """An initialised instance that is going to slide at `speed` [m/s]."""
        slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="rings",
        )
        slave.instantiate()
        if speed > 0.0:
            slave.setReal(self.references("nominal.velocity"), [speed])
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.setReal(self.references("normal_load", "sliding_velocity"), [LOAD, speed])
        slave.exitInitializationMode()
        return slave

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        shutil.rmtree(self.folder, ignore_errors=True)


@dataclass(frozen=True)
class Run:
    """Rows are instants."""

    speed: float  # [m/s]
    time: np.ndarray  # [s]
    x: np.ndarray  # stations around the ring [m]
    pressure: np.ndarray  # [Pa]
    temperature: np.ndarray  # [K]
    scalars: dict  # name to values
    seconds: float  # wall time

    def waves(self, count):
        """Amplitude of the first waves of the pressure over its mean, by instant and wave number."""
        # The last station is the first one, once round.
        around = self.pressure[:, :-1].copy()
        around[:, 0] = 0.5 * (self.pressure[:, 0] + self.pressure[:, -1])
        spectrum = np.fft.rfft(around, axis=1)
        return 2.0 * np.abs(spectrum[:, 1 : count + 1]) / np.abs(spectrum[:, :1])


def critical_speed(unpacked):
    """The output `critical_speed` [m/s]."""
    slave = unpacked.started(0.0)
    try:
        return slave.getReal(unpacked.references("critical_speed"))[0]
    finally:
        slave.freeInstance()


def slide(unpacked, speed, duration):
    """Slides at a constant speed [m/s] for `duration` [s]."""
    names = [f"profile.{name}[{k + 1}]" for name in ("pressure", "temperature") for k in range(STATIONS)]
    watched = unpacked.references(*names, *SCALARS)
    slave = unpacked.started(speed)
    try:
        x = np.array(slave.getReal(unpacked.references(*(f"profile.x[{k + 1}]" for k in range(STATIONS)))))
        rows = [slave.getReal(watched)]
        steps = round(duration / STEP)
        begin = time.perf_counter()
        for step in range(steps):
            slave.doStep(step * STEP, STEP)
            rows.append(slave.getReal(watched))
        seconds = time.perf_counter() - begin
    finally:
        slave.freeInstance()
    values = np.array(rows)
    scalars = dict(zip(SCALARS, values[:, 2 * STATIONS :].T, strict=True))
    return Run(speed, STEP * np.arange(steps + 1), x, values[:, :STATIONS], values[:, STATIONS : 2 * STATIONS], scalars,
               seconds)  # fmt: skip


@dataclass(frozen=True)
class Rings:
    """What the theory of two half-planes needs; the first body rests, the second one moves at -V against the waves."""

    conductivity: np.ndarray  # [W/(m.K)]
    diffusivity: np.ndarray  # [m2/s]
    expansion: np.ndarray  # alpha (1 + nu) [1/K]
    modulus: float  # E* [Pa]
    friction: float
    conductance: float  # [W/(m2.K)]
    length: float  # once round [m]

    @classmethod
    def of(cls, unpacked):
        def both(name):
            return np.array([unpacked.start(f"{body}.{name}") for body in ("punch", "strip")])

        ratio = both("poissons_ratio")
        return cls(
            conductivity=both("conductivity"),
            diffusivity=both("conductivity") / (both("density") * both("specific_heat")),
            expansion=both("thermal_expansion") * (1.0 + ratio),
            modulus=1.0 / np.sum((1.0 - ratio**2) / both("youngs_modulus")),
            friction=unpacked.start("contact.friction_coefficient"),
            conductance=unpacked.start("contact.conductance"),
            length=unpacked.start("punch.width"),
        )

    def growth(self, count, speed):
        """Growth rate [1/s] of wave `count` at `speed` [m/s]: the root s of

        mu V = Z(s),  Z = sum K l T / (E* m sum alpha (1 + nu) T/(l + m)),  l_i^2 = m^2 + (s - i m v_i)/kd_i,

        v the bodies' velocities against the first one; by Newton's method from a wave that rests there.
        """
        m = 2.0 * np.pi * count / self.length
        velocity = np.array([0.0, -speed])

        def residual(s):
            decay = np.sqrt(m * m + (s - 1j * m * velocity) / self.diffusivity)
            uptake = self.conductivity * decay
            warm = 1.0 + uptake[::-1] / (2.0 * self.conductance)
            lift = np.sum(self.expansion * warm / (decay + m))
            return np.sum(uptake * warm) / (self.modulus * m * lift) - self.friction * speed

        unit = self.diffusivity[0] * m * m
        s = 0.0 + 0.0j
        for _ in range(100):
            slope = (residual(s + 1e-6 * unit) - residual(s - 1e-6 * unit)) / (2e-6 * unit)
            change = residual(s) / slope
            # A wave may not decay faster than it does without friction.
            s -= change * min(1.0, 0.5 * unit / abs(change))
            if abs(change) < 1e-9 * unit:
                break
        return s.real
