"""The runs: engagement by three masters, the explicit limit, a hill, judder, the thermoelastic limit.

`unpacked` is the clutch's FMU (contact.Unpacked). Tables are structured arrays with a row for every communication
point; their units are in UNITS.
"""

import time
from dataclasses import dataclass, replace

import numpy as np
from contact import Contact
from masters import ImplicitMaster, explicit_step
from plant import RADIANS_PER_SECOND, Plant

UNITS = {
    "time": "s",
    "engine_speed": "rad/s",
    "vehicle_speed": "rad/s",
    "slip": "rad/s",
    "load": "N",
    "torque": "N.m",
    "contact_temperature": "K",
    "contact_temperature_max": "K",
    "friction_coefficient": "1",
    "wear_depth_punch": "m",
    "dissipated_energy": "J",
    "critical_speed": "m/s",
    "bristle_deflection": "m",
}
OUTPUTS = (
    "contact_temperature",
    "contact_temperature_max",
    "friction_coefficient",
    "wear_depth_punch",
    "dissipated_energy",
    "critical_speed",
    "bristle_deflection",
)
FULL_LOAD = 5000.0  # N
START_SPEED = 3000.0 * RADIANS_PER_SECOND
CLOSING_TIME = 1.0  # s
# Regularised friction in place of the scene's bristle.
REGULARISED = {
    "contact.stick_stiffness": 0.0,
    "contact.stick_damping": 0.0,
    "contact.regularization_velocity": 0.01,  # m/s
}
# Facings that start at 250 degC, where friction falls with temperature.
HOT = {"ambient_temperature": 523.15}


@dataclass(frozen=True)
class Run:
    """A table and the work of the run."""

    table: np.ndarray
    step: float  # s
    seconds: float  # wall time
    iterations: np.ndarray = None  # of the implicit master: steps of the contact
    evaluations: np.ndarray = None  # with the states held

    def __getitem__(self, name):
        return self.table[name]

    @property
    def steps_per_second(self):
        return (len(self.table) - 1) / self.seconds


def closing(now):
    """Clamping force [N]."""
    return FULL_LOAD * min(now / CLOSING_TIME, 1.0)


def empty(count):
    return np.zeros(count + 1, dtype=[(name, np.float64) for name in UNITS])


def note(row, contact, values):
    """Fills a row with values by name and the contact's outputs."""
    for name, value in values.items():
        row[name] = value
    for name, value in zip(OUTPUTS, contact.get(*OUTPUTS)):
        row[name] = value


def capacity(unpacked):
    """Torque that the clutch carries when closed, roughly [N m]."""
    force = unpacked.start("contact.friction_coefficient") * FULL_LOAD * unpacked.start("contact.faces")
    return force * unpacked.start("contact.mean_radius")


def check_capacity(unpacked, plant=Plant()):
    """Raises ValueError where the clutch would slip for ever."""
    if not capacity(unpacked) > 1.5 * plant.stuck_torque:
        raise ValueError(
            f"this scene is no clutch of a passenger car: it carries {capacity(unpacked):.3g} N.m, and the engine needs "
            f"{plant.stuck_torque:.3g} N.m of it and half as much in reserve"
        )


def engage(unpacked, step, parameters=None, plant=Plant(), duration=2.0, implicit=False):
    """From 3,000 rev/min with the vehicle at rest until both turn together, and on."""
    count = round(duration / step)
    table = empty(count)
    slip, vehicle = START_SPEED, 0.0
    with Contact(unpacked, parameters or {}, slip, 0.0) as contact:
        master = ImplicitMaster(plant, contact, capacity(unpacked))
        note(table[0], contact, {"slip": slip, "engine_speed": slip})
        begin = time.perf_counter()
        for index in range(1, count + 1):
            load = closing(index * step)
            if implicit:
                slip, torque = master.step(slip, load, step)
            else:
                slip, torque = explicit_step(plant, contact, slip, load, step)
            vehicle += step * (torque - plant.resistance) / plant.vehicle_inertia
            note(
                table[index],
                contact,
                {"time": index * step, "slip": slip, "engine_speed": vehicle + slip, "vehicle_speed": vehicle,
                 "load": load, "torque": torque},
            )
        seconds = time.perf_counter() - begin
    if not implicit:
        return Run(table, step, seconds)
    return Run(table, step, seconds, np.array(master.iterations), np.array(master.evaluations))


def stuck_slip(plant, contact):
    """Slip at which regularised friction carries the torque that keeps both sides together."""
    low, high = -1.0, 1.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        contact.set(middle, FULL_LOAD)
        low, high = (low, middle) if contact.torque() > plant.stuck_torque else (middle, high)
    return 0.5 * (low + high)


def predicted_limit(unpacked, plant=Plant()):
    """Longest stable step [s] of the explicit master at stick, from the output `friction_slope`."""
    with Contact(unpacked, REGULARISED, 0.0, FULL_LOAD) as contact:
        contact.set(stuck_slip(plant, contact), FULL_LOAD)
        return plant.explicit_limit(contact.get("friction_slope"), unpacked.start("contact.mean_radius"))


def grows(unpacked, step, plant=Plant(), steps=400):
    """Whether a small disturbance of the stuck slip grows under the explicit master."""
    with Contact(unpacked, REGULARISED, 0.0, FULL_LOAD) as contact:
        rest = stuck_slip(plant, contact)
        slip = rest * (1.0 + 1e-4)
        contact.set(slip, FULL_LOAD)
        path = [slip]
        for _ in range(steps):
            slip, _ = explicit_step(plant, contact, slip, FULL_LOAD, step)
            path.append(slip)
    # The disturbance alternates from step to step; second differences leave out that the rest itself moves as heat
    # flows.
    sizes = np.abs(np.diff(path, 2))
    return bool(sizes[-10:].max() > sizes[0])


def observed_limit(unpacked, predicted, plant=Plant(), halvings=8):
    """Longest stable step [s] of the explicit master, found by trying between half and twice the predicted one."""
    low, high = 0.5 * predicted, 2.0 * predicted
    if grows(unpacked, low, plant) or not grows(unpacked, high, plant):
        raise RuntimeError(f"the explicit limit is not between {low:.3g} s and {high:.3g} s")
    for _ in range(halvings):
        middle = (low * high) ** 0.5
        low, high = (low, middle) if grows(unpacked, middle, plant) else (middle, high)
    return (low * high) ** 0.5


HILL_GRADE = 0.10
HILL_STEP = 0.010  # s
# Parked in gear: the engine stands, the clutch holds the car. Stable under an explicit master of step h and mass m for
# h k < c < 2 m/h - h k/2, here 5 to 16 kN.s/m: half-way.
HILL_BRISTLE = {"contact.stick_stiffness": 5e5, "contact.stick_damping": 1e4}


def hill(unpacked, seconds=60.0):
    """The car on a 10 % grade, in gear, held by the clutch against the standing engine. Returns the run and the car's
    travel [m]."""
    ratio, wheel_radius, mass = 13.0, 0.31, 1500.0
    slope = np.arctan(HILL_GRADE)
    # Rolling resistance helps to hold; without it the case is the harder one.
    torque = mass * 9.80665 * np.sin(slope) * wheel_radius / ratio
    plant = replace(Plant(), engine_inertia=float("inf"), engine_torque=0.0, resistance=torque)
    count = round(seconds / HILL_STEP)
    table = empty(count)
    travel = np.zeros(count + 1)
    slip = 0.0
    with Contact(unpacked, HILL_BRISTLE, slip, FULL_LOAD) as contact:
        note(table[0], contact, {"load": FULL_LOAD, "torque": contact.torque()})
        begin = time.perf_counter()
        for index in range(1, count + 1):
            slip, held = explicit_step(plant, contact, slip, FULL_LOAD, HILL_STEP)
            travel[index] = travel[index - 1] + HILL_STEP * slip / ratio * wheel_radius
            note(table[index], contact, {"time": index * HILL_STEP, "slip": slip, "load": FULL_LOAD, "torque": held})
        seconds = time.perf_counter() - begin
    return Run(table, HILL_STEP, seconds), travel


@dataclass(frozen=True)
class Driveline:
    """The transmission's input shaft on the driveline's spring, for judder."""

    shaft_inertia: float = 0.02  # kg m2, clutch disc, input shaft and first gears
    stiffness: float = 60.0  # N m/rad, side shafts seen through the first gear: 10 kN m/rad over 13 squared
    damping: float = 0.11  # N m s/rad, a twentieth of the critical one

    @property
    def frequency(self):
        """Hz, of the shaft against the vehicle's large inertia."""
        return np.sqrt(self.stiffness / self.shaft_inertia) / (2.0 * np.pi)

    def growth_rate(self, torque_slope, vehicle_inertia=Plant().vehicle_inertia):
        """1/s, of a small oscillation while slipping, `torque_slope` [N m s/rad] being dT/dslip."""
        damping = self.damping * (1.0 + self.shaft_inertia / vehicle_inertia)
        return -(torque_slope + damping) / (2.0 * self.shaft_inertia)


JUDDER_SLIP = 3.5  # rad/s, engine over vehicle
JUDDER_TORQUE = 35.0  # N m: the car is held on a 10 % grade by the slipping clutch


def judder(unpacked, static_friction_ratio, seconds=2.0, step=5e-4, driveline=Driveline(), plant=Plant()):
    """Creeping with a slipping clutch at a governed engine speed. Returns the run (its `vehicle_speed` is that of the
    input shaft) and the torque's slope at the start [N m s/rad]."""
    parameters = {"contact.static_friction_ratio": static_friction_ratio}
    engine = 900.0 * RADIANS_PER_SECOND
    with Contact(unpacked, parameters, JUDDER_SLIP, 1000.0) as contact:
        # Force at which the clutch carries the torque: friction is proportional to it.
        load = 1000.0 * JUDDER_TORQUE / contact.torque()
        contact.set(JUDDER_SLIP, load)
        torque_slope = contact.torque_slope()
        count = round(seconds / step)
        table = empty(count)
        vehicle = engine - JUDDER_SLIP
        shaft = vehicle + 1e-3
        twist = JUDDER_TORQUE / driveline.stiffness
        note(
            table[0],
            contact,
            {"slip": engine - shaft, "load": load, "torque": contact.torque(), "engine_speed": engine,
             "vehicle_speed": shaft},
        )
        begin = time.perf_counter()
        for index in range(1, count + 1):
            torque = contact.torque()
            shafts = driveline.stiffness * twist + driveline.damping * (shaft - vehicle)
            shaft += step * (torque - shafts) / driveline.shaft_inertia
            vehicle += step * (shafts - JUDDER_TORQUE) / plant.vehicle_inertia
            twist += step * (shaft - vehicle)
            contact.set(engine - shaft, load)
            contact.step(step)
            note(
                table[index],
                contact,
                {"time": index * step, "slip": engine - shaft, "load": load, "torque": torque,
                 "engine_speed": engine, "vehicle_speed": shaft},
            )
        seconds = time.perf_counter() - begin
    return Run(table, step, seconds), torque_slope


def observed_growth_rate(run, driveline=Driveline()):
    """Rate [1/s] of the oscillation's envelope while it is small: a straight line through the logarithms of the range of
    the shaft's acceleration in each period."""
    period = round(1.0 / (driveline.frequency * run.step))
    acceleration = np.diff(run["vehicle_speed"]) / run.step
    count = len(acceleration) // period
    ranges = np.ptp(acceleration[: count * period].reshape(count, period), axis=1)
    middles = (np.arange(count) + 0.5) * period * run.step
    # Once the slip swings by a tenth, friction's slope is no longer the one of the start.
    largest = 2.0 * 0.1 * JUDDER_SLIP * 2.0 * np.pi * driveline.frequency
    small = np.maximum.accumulate(ranges) < largest
    if small.sum() < 3:
        raise RuntimeError("too few periods of small oscillation to read a growth rate from")
    return float(np.polyfit(middles[small], np.log(ranges[small]), 1)[0])


# A clutch of carbon on carbon, as in racing: conducts well, is soft and hardly expands.
CARBON = {
    f"{body}.{name}": value
    for body in ("punch", "strip")
    for name, value in (
        ("youngs_modulus", 2e10), ("poissons_ratio", 0.2), ("density", 1750.0), ("specific_heat", 1200.0),
        ("conductivity", 80.0), ("thermal_expansion", 1e-6), ("height", 0.006),
    )
} | {"strip.property_table.points": 0, "contact.friction_coefficient": 0.25, "contact.static_friction_ratio": 1.0}


def across_critical_speed(unpacked, seconds=2.0, step=1e-2):
    """Slip prescribed from none to twice the critical speed: where the output `critical_speed` is crossed."""
    mean_radius = unpacked.start("contact.mean_radius")
    count = round(seconds / step)
    table = empty(count)
    with Contact(unpacked, CARBON, 0.0, FULL_LOAD) as contact:
        contact.set(1.0, FULL_LOAD)
        highest = 2.0 * contact.get("critical_speed") / mean_radius
        contact.set(0.0, FULL_LOAD)
        note(table[0], contact, {"load": FULL_LOAD})
        begin = time.perf_counter()
        for index in range(1, count + 1):
            slip = highest * index / count
            contact.set(slip, FULL_LOAD)
            contact.step(step)
            note(table[index], contact, {"time": index * step, "slip": slip, "load": FULL_LOAD, "torque": contact.torque()})
        seconds = time.perf_counter() - begin
    return Run(table, step, seconds)
