"""What is driven: speed over time, grade of the road over position, and where the pedal is pressed for a stop."""

import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "disc_brake"))

import road_load  # noqa: E402  (it lies beside the scene it belongs to)

KILOMETRES_PER_HOUR = 1.0 / 3.6


@dataclass(frozen=True)
class Manoeuvre:
    """One drive. The vehicle reads both tables as straight lines between their rows, constant outside."""

    name: str
    duration: float  # s
    speed: tuple  # time [s], reference speed [m/s]
    road: tuple  # position [m], grade [1]
    parameters: dict = field(default_factory=dict)  # of the vehicle


LEVEL = (np.array([0.0]), np.array([0.0]))
STEP = 0.010  # s, of the explicit masters
DESCENT_SPEED = 80.0 * KILOMETRES_PER_HOUR
DESCENT_GRADE = 0.08
DESCENT_LENGTH = 7000.0  # m
RUN_IN = 100.0  # m of level road before the descent
RUN_OUT = 300.0  # m of level road behind it: the driver has let go of the brake and is at the speed of the stop
STOP_TIME = 12.0  # s, enough for a full stop


def cycle(path, duration=None):
    """A drive cycle on a level road."""
    time, speed = road_load.read_cycle(path)
    duration = float(time[-1]) if duration is None else duration
    # A driver's foot takes about a second: the samples' corners are rounded over two of them, the distance is kept.
    padded = np.pad(speed, 1, mode="edge")
    smooth = np.where(speed == 0.0, 0.0, 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:])
    return Manoeuvre(path.stem, duration, (time, smooth), LEVEL)


def stop(name, length):
    """At 80 km/h down `length` metres of an 8 % descent with the brakes alone, then a full stop on the level."""
    begin = (RUN_IN + length + RUN_OUT if length > 0.0 else RUN_IN) / DESCENT_SPEED
    road = LEVEL
    if length > 0.0:
        # The grade sets in over 20 m.
        position = np.array([RUN_IN, RUN_IN + 20.0, RUN_IN + length - 20.0, RUN_IN + length])
        road = (position, np.array([0.0, -DESCENT_GRADE, -DESCENT_GRADE, 0.0]))
    return Manoeuvre(
        name,
        round(begin + STOP_TIME),
        (np.array([0.0]), np.array([DESCENT_SPEED])),
        road,
        {"initial_speed": DESCENT_SPEED, "stop_time": begin, "stop_deceleration": 8.0},
    )


def descent(length=DESCENT_LENGTH):
    return stop("descent", length)


def cold_stop():
    return stop("cold_stop", 0.0)


def hill(grade=-0.10, seconds=60.0):
    """Rolls down a 10 % grade at 2 m/s, stops on it within two seconds and stands there for a minute."""
    return Manoeuvre(
        "hill",
        seconds + 4.0,
        (np.array([0.0, 0.5, 2.5]), np.array([2.0, 2.0, 0.0])),
        (np.array([0.0]), np.array([grade])),
        {"initial_speed": 2.0},
    )
