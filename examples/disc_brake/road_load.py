"""From a car's speed over time to the load and the sliding velocity of one front brake.

The brake force at the wheels closes the balance of the car along the road,

    brake force = -(m a + m g f + rho cd A v^2 / 2)      where that is positive, else 0,

(m mass, a acceleration, f rolling resistance, rho density of air, cd A drag area, v speed). One front disc takes its
share, and the pads' load follows from the brake's own data, which are read from the FMU:

    normal load per face = share * brake force * wheel radius / (faces * mu * mean radius)
    sliding velocity     = v * mean radius / wheel radius
"""

from dataclasses import dataclass

import numpy as np

GRAVITY = 9.80665  # m/s2
AIR_DENSITY = 1.2  # kg/m3, dry air at 20 degC and sea level
HIGHEST_PRESSURE = 10e6  # Pa: above what pads are pressed with in a full stop (about 4 MPa), so the brake is no car's


@dataclass(frozen=True)
class Car:
    """A mid-size car."""

    mass: float = 1500.0  # kg, with driver: the car of the brake's stop from 100 km/h
    front_share: float = 0.70  # of the brake force on the front axle: weight moves forward in braking
    wheel_radius: float = 0.31  # m, rolling radius of a 205/55 R16 tyre
    rolling_resistance: float = 0.012  # 1, radial tyres on asphalt
    drag_area: float = 0.66  # m2: cd 0.30 times 2.2 m2 of frontal area
    hold_grade: float = 0.03  # 1: at rest the driver presses as if to hold an automatic's creep, 3 % of the weight

    @classmethod
    def of(cls, settings):
        """This car with other properties, NAME=VALUE each."""
        return cls(**{name: float(value) for name, _, value in (text.partition("=") for text in settings)})


@dataclass(frozen=True)
class Brake:
    """Properties of the brake that relate brake force to load; see `Brake.of` for where it comes from."""

    mean_radius: float  # m
    friction_coefficient: float  # 1
    faces: int  # 1
    pad_area: float  # m2, one face

    @classmethod
    def of(cls, start_values):
        """From the start values of the FMU (name to value)."""
        return cls(
            mean_radius=float(start_values["contact.mean_radius"]),
            friction_coefficient=float(start_values["contact.friction_coefficient"]),
            faces=int(start_values["contact.faces"]),
            pad_area=float(start_values["punch.width"]) * float(start_values["depth"]),
        )


@dataclass(frozen=True)
class Drive:
    """Time series of a drive; arrays of one length."""

    time: np.ndarray  # s
    speed: np.ndarray  # m/s, of the car
    sliding_velocity: np.ndarray  # m/s, of the disc's surface under the pad
    normal_load: np.ndarray  # N, per face

    def signals(self):
        """Inputs as fmpy takes them: a structured array, linear between its rows."""
        names = ("time", "sliding_velocity", "normal_load")
        rows = zip(self.time, self.sliding_velocity, self.normal_load)
        return np.array(list(rows), dtype=[(name, np.float64) for name in names])


def read_cycle(path):
    """Reads the columns `time_s, speed_m_per_s` and `trip`, if there are trips, which `cargo fmu run --cycle` makes of others, and
    checks that time increases."""
    with open(path, encoding="utf-8") as file:
        header = file.readline().strip()
    if header.removesuffix(",trip") != "time_s,speed_m_per_s":
        raise ValueError(f"{path}: the columns must be time_s,speed_m_per_s, not {header}; cargo fmu run --cycle converts units")
    time, speed = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1), unpack=True)
    if time.size < 2 or not np.all(np.diff(time) > 0.0):
        raise ValueError(f"{path}: time_s must increase from row to row")
    if not np.all(np.isfinite(speed)) or np.any(speed < 0.0):
        raise ValueError(f"{path}: speed_m_per_s must be finite and not negative")
    return time - time[0], speed


def read_trips(path):
    """Number of every trip of a cycle and the times [s] of its first row and of that of the next trip; none without a column `trip`."""
    with open(path, encoding="utf-8") as file:
        if not file.readline().strip().endswith(",trip"):
            return []
    time, trip = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 2), unpack=True)
    first = [0, *(np.flatnonzero(np.diff(trip)) + 1)]
    ends = [*time[first[1:]], time[-1]]
    return [(int(trip[row]), float(time[row] - time[0]), float(end - time[0])) for row, end in zip(first, ends)]


def brake_force(time, speed, car):
    """Force of all brakes together at the wheels [N], >= 0.

    The acceleration is the central difference over the neighbouring samples: a driver moves the pedal within about the
    second that separates them, so a force that jumps from sample to sample would be of the table, not of the car.
    """
    acceleration = np.gradient(speed, time)
    rolling = car.mass * GRAVITY * car.rolling_resistance
    drag = 0.5 * AIR_DENSITY * car.drag_area * speed**2
    driving = np.maximum(0.0, -(car.mass * acceleration + rolling + drag))
    # Held from the sample after the stop to the one before the start, so that no held brake is dragged along.
    at_rest = speed == 0.0
    held = at_rest & np.append(at_rest[1:], True) & np.insert(at_rest[:-1], 0, True)
    return np.where(held, np.maximum(driving, car.mass * GRAVITY * car.hold_grade), driving)


def front_brake(time, speed, brake, car=Car()):
    """The drive of one front brake."""
    torque = 0.5 * car.front_share * brake_force(time, speed, car) * car.wheel_radius
    load = torque / (brake.faces * brake.friction_coefficient * brake.mean_radius)
    pressure = load.max() / brake.pad_area
    if not pressure <= HIGHEST_PRESSURE:
        raise ValueError(
            f"this scene is no brake of a {car.mass:g} kg car: stopping it takes a mean pressure of {pressure / 1e6:.3g} MPa "
            f"on {brake.pad_area * 1e4:.3g} cm2, the limit is {HIGHEST_PRESSURE / 1e6:g} MPa"
        )
    return Drive(time, speed, speed * brake.mean_radius / car.wheel_radius, load)
