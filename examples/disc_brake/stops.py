"""Stops from 100 km/h: the car's speed follows from the torque that its brake gives, at the lumped level and on the
contact line.

    m dv/dt = -(T/(share R) + m g f + rho cd A v^2/2),   share: of one front brake in all brakes, T its torque, R: wheel

The pedal goes down in 0.2 s to the load that decelerates the car at 8 m/s2 while the brake is cold, and stays: what
friction loses when it gets hot, the car loses in deceleration.
"""

import shutil
import time as clock
from dataclasses import dataclass

import numpy as np
from fmpy import extract
from fmpy.fmi2 import FMU2Slave
from road_load import AIR_DENSITY, GRAVITY, Brake, Car
from simulation import describe

SPEED = 100.0 / 3.6  # m/s, at the start of every stop
DECELERATION = 8.0  # m/s2, of the cold brake
RAMP = 0.2  # s, in which the pedal goes down
STEP = 0.01  # s, braking
FREE_STEP = 0.5  # s, between the stops
ACCELERATION = 2.0  # m/s2, back to speed
INTERVAL = 45.0  # s, from stop to stop
STOPS = 15
SNAPSHOTS = (0.1, 0.2, 0.5, 1.0, 2.0, 3.0)  # s, in one stop: when the contact line is drawn
STATIONS = 33
LEVELS = {"lumped": {"solver.fidelity": 2}, "line": {"solver.fidelity": 3, "solver.cells": 33}}
SCALARS = (
    "contact_temperature",
    "contact_temperature_max",
    "strip.mean_temperature",
    "friction_torque",
    "friction_coefficient",
    "pressure_mean",
    "pressure_max",
    "contact_fraction",
    "wear_depth_punch",
)
PROFILES = ("pressure", "temperature")


@dataclass(frozen=True)
class Course:
    """One level through one run; arrays over the times recorded."""

    time: np.ndarray  # s
    speed: np.ndarray  # m/s, of the car
    values: dict  # of `SCALARS`
    profiles: dict  # of `PROFILES` over x at each of `snapshots`
    snapshots: np.ndarray  # s
    x: np.ndarray  # stations [m]
    distance: np.ndarray  # m, of each stop
    duration: np.ndarray  # s, of each stop
    stop: np.ndarray  # number of the stop at every time, -1 between them
    seconds: float  # wall time
    critical_speed: float  # m/s

    def __getitem__(self, name):
        return self.values[name]

    def over_stops(self, name, reduce):
        """One number for each stop, while the pedal is down and the car moves."""
        braking = (self["pressure_mean"] > 0.0) & (self.speed > 1e-6)
        return np.array(
            [reduce(self[name][(self.stop == number) & braking]) for number in range(len(self.distance))]
        )


class BrakedCar:
    """A car and one of its front brakes as an instance of the FMU; use as a context manager."""

    def __init__(self, fmu, level, stops, car):
        description, start = describe(fmu)
        self.car, self.brake = car, Brake.of(start)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.folder = extract(str(fmu))
        self.slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=level,
        )
        torque = 0.5 * car.front_share * car.mass * DECELERATION * car.wheel_radius
        self.load = torque / (self.brake.faces * self.brake.friction_coefficient * self.brake.mean_radius)
        self.ratio = self.brake.mean_radius / car.wheel_radius
        self.time, self.rows = 0.0, []
        self.slave.instantiate()
        for name, value in LEVELS[level].items():
            self.slave.setInteger([self.references[name]], [value])
        nominal = {
            "nominal.load": self.load,
            "nominal.velocity": SPEED * self.ratio,
            "nominal.duration": 4.0 * stops,
            "solver.tolerance": 1e-3,
        }
        self.slave.setReal([self.references[name] for name in nominal], list(nominal.values()))
        self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.inputs = [self.references["sliding_velocity"], self.references["normal_load"]]
        self.watched = [self.references[name] for name in SCALARS]

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

    def profile(self, name):
        names = [self.references[f"profile.{name}[{station + 1}]"] for station in range(STATIONS)]
        return np.array(self.slave.getReal(names))

    def resistance(self, speed):
        """Deceleration by rolling resistance and drag, m/s2."""
        drag = 0.5 * AIR_DENSITY * self.car.drag_area * speed**2
        return GRAVITY * self.car.rolling_resistance + drag / self.car.mass

    def advance(self, speed, rate, load, load_rate, length, number):
        """One communication step with inputs linear in it; returns the torque at its end."""
        self.slave.setReal(self.inputs, [speed * self.ratio, load])
        self.slave.setRealInputDerivatives(self.inputs, [1, 1], [rate * self.ratio, load_rate])
        self.slave.doStep(self.time, length)
        self.time += length
        end = speed + rate * length
        self.slave.setReal(self.inputs, [end * self.ratio, load + load_rate * length])
        values = self.slave.getReal(self.watched)
        self.rows.append((self.time, end, number, *values))
        return abs(values[SCALARS.index("friction_torque")])


def stop(car, number, snapshots, taken):
    """Brakes from `SPEED` to rest; returns distance and duration."""
    speed, torque, begin, distance = SPEED, 0.0, car.time, 0.0
    while speed > 0.0:
        pressed = car.time - begin
        load = car.load * min(1.0, pressed / RAMP)
        load_rate = car.load / RAMP if pressed < RAMP - 0.5 * STEP else 0.0
        braking = 2.0 * torque / (car.car.front_share * car.car.wheel_radius * car.car.mass)
        rate = -(braking + car.resistance(speed))
        # The last step ends at rest.
        length = min(STEP, -speed / rate)
        distance += length * (speed + 0.5 * rate * length)
        ends = length < STEP
        torque = car.advance(speed, rate, load, load_rate, length, number)
        speed = 0.0 if ends else speed + rate * length
        if len(taken) < len(snapshots) and car.time - begin >= snapshots[len(taken)] - 0.5 * STEP:
            taken.append([car.profile(name) for name in PROFILES])
    return distance, car.time - begin


def drive(fmu, level, stops, snapshots=(), of=Car()):
    """`stops` stops of a car one after the other, `INTERVAL` from start to start; profiles at `snapshots` [s] in the first."""
    with BrakedCar(fmu, level, stops, of) as car:
        begin, taken, results = clock.perf_counter(), [], []
        for number in range(stops):
            start = car.time
            results.append(stop(car, number, snapshots, taken))
            if number + 1 == stops:
                break
            speed = 0.0
            while car.time < start + INTERVAL - 1e-9:
                length = min(FREE_STEP, start + INTERVAL - car.time)
                rate = min(ACCELERATION, (SPEED - speed) / length)
                car.advance(speed, rate, 0.0, 0.0, length, -1)
                speed += rate * length
        table = np.array(car.rows)
        distance, duration = np.array(results).T
        return Course(
            time=table[:, 0],
            speed=table[:, 1],
            stop=table[:, 2].astype(int),
            values=dict(zip(SCALARS, table[:, 3:].T, strict=True)),
            profiles={name: np.array([both[index] for both in taken]) for index, name in enumerate(PROFILES)},
            snapshots=np.array(snapshots[: len(taken)]),
            x=car.profile("x"),
            distance=distance,
            duration=duration,
            seconds=clock.perf_counter() - begin,
            critical_speed=float(car.slave.getReal([car.references["critical_speed"]])[0]),
        )


def drive_both(fmu, stops, snapshots=(), car=Car()):
    """The same at every level."""
    return {level: drive(fmu, level, stops, snapshots, car) for level in LEVELS}


def figures(courses):
    """Numbers of a run by level."""

    def of(course):
        return {
            "stopping_distance_first_m": float(course.distance[0]),
            "stopping_distance_longest_m": float(course.distance.max()),
            "contact_temperature_peak_degC": float(course["contact_temperature_max"].max() - 273.15),
            "disc_temperature_peak_degC": float(course["strip.mean_temperature"].max() - 273.15),
            "friction_coefficient_least": float(course.over_stops("friction_coefficient", np.min).min()),
            "pressure_peak_MPa": float(course.over_stops("pressure_max", np.max).max() / 1e6),
            "contact_fraction_least": float(course.over_stops("contact_fraction", np.min).min()),
            "pad_wear_um": float(course["wear_depth_punch"][-1] * 1e6),
            "seconds": course.seconds,
        }

    return {level: of(course) for level, course in courses.items()}


def table(summary):
    """One column for each run and level."""
    columns = {f"{run}, {level}": values for run, levels in summary.items() for level, values in levels.items()}
    names = list(next(iter(columns.values())))
    width = max(map(len, names))
    lines = [f"  {'':{width}}" + "".join(f"{name:>18}" for name in columns)]
    lines += [f"  {name:{width}}" + "".join(f"{values[name]:>18.4g}" for values in columns.values()) for name in names]
    return "\n".join(lines)
