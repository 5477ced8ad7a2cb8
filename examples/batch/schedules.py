"""Schedules of a brake's inputs: a drive cycle, or stop after stop from motorway speed."""

import csv
import sys
from pathlib import Path

import numpy as np

from sliding_contact.host import Schedule

sys.path.append(str(Path(__file__).resolve().parents[1] / "disc_brake"))

import road_load  # noqa: E402  (it lies beside the scene it belongs to)

INPUTS = ("sliding_velocity", "normal_load")
DATA = Path(__file__).resolve().parents[1] / "data"


def of_name(name, brake, interpolation="hold"):
    """`udds`, `hwfet`, `stops`, or the path of a CSV file with the columns time and one for each input.

    Returns the schedule and the distance that the car drives in it [m]; `None` where a file does not tell.
    """
    if name == "stops":
        time, speed = repeated_stops()
    elif (DATA / f"{name}.csv").is_file():
        time, speed = road_load.read_cycle(DATA / f"{name}.csv")
    elif Path(name).is_file():
        return read(name, interpolation), None
    else:
        raise ValueError(f"the schedule {name!r} is neither a file nor one of udds, hwfet, stops")
    drive = road_load.front_brake(time, speed, brake)
    values = np.column_stack([drive.sliding_velocity, drive.normal_load])
    return Schedule(INPUTS, drive.time, values, interpolation), float(np.trapezoid(speed, time))


def repeated_stops(stops=15, speed=100 / 3.6, deceleration=8.0, acceleration=2.5, cruise=20.0, rest=5.0, row=0.1):
    """Time [s] and speed [m/s] of a car that brakes from `speed` to rest again and again."""
    one = [(0.0, speed), (cruise, speed), (cruise + speed / deceleration, 0.0)]
    one.append((one[-1][0] + rest, 0.0))
    one.append((one[-1][0] + speed / acceleration, speed))
    period = one[-1][0]
    corners = [(at * period + time, value) for at in range(stops) for time, value in one[: -1]]
    corners.append((stops * period, speed))
    times, speeds = zip(*corners)
    time = row * np.arange(int(np.floor(times[-1] / row)) + 1)
    return time, np.interp(time, times, speeds)


def read(path, interpolation="hold"):
    """A schedule from a CSV file: the column time [s], and one for each input, named as in the FMU, in its unit."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if len(rows) < 2 or not rows[0] or rows[0][0].strip() != "time":
        raise ValueError(f"{path} must have a header that starts with time, and rows")
    try:
        table = np.array(rows[1:], dtype=np.float64)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return Schedule(tuple(name.strip() for name in rows[0][1:]), table[:, 0], table[:, 1:], interpolation)
