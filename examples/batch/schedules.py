"""Schedules of inputs: nominal ones, a file, and of a car's brake a drive cycle, or stop after stop from motorway speed."""

import sys
from pathlib import Path

import numpy as np

from sliding_contact.host import Schedule

sys.path.append(str(Path(__file__).resolve().parents[1] / "disc_brake"))

import road_load  # noqa: E402  (it lies beside the scene it belongs to)

INPUTS = ("sliding_velocity", "normal_load")
DATA = Path(__file__).resolve().parents[1] / "data"


# Schedules of the front brake of a car.
CYCLES = ("udds", "hwfet", "stops")


def of_name(name, scene, interpolation=None):
    """`nominal`, `udds`, `hwfet`, `stops`, or the path of a CSV file of inputs as `simulate` takes it.

    Returns the schedule, its communication step [s] and the distance that the car drives in it [m]; `None` where there is no car.
    """
    if name not in CYCLES:
        if name != "nominal" and not Path(name).is_file():
            raise ValueError(f"the schedule {name!r} is neither a file nor one of nominal, {', '.join(CYCLES)}")
        nominal = scene.trajectory(None if name == "nominal" else name)
        # Linear between their rows, as in `simulate`.
        interpolation = interpolation or "linear"
        start, time = nominal.time[0], nominal.time - nominal.time[0]
        if start != 0.0:
            print(f"{name}: times are counted from its first row, {start:g} s", file=sys.stderr)
        step = float(time[-1] / np.ceil(time[-1] / nominal.step - 1e-6))
        return Schedule(nominal.inputs, time, nominal.values, interpolation), step, None
    faces, path = scene["contact.faces"], scene["strip.path"]
    if (faces, path) != (2, "closed"):
        raise ValueError(
            f"the schedule {name} is that of a car's brake with contact.faces = 2 and strip.path = closed, and the scene {scene.name} has "
            f"{faces} and {path}; take nominal, or a file of its inputs"
        )
    time, speed = repeated_stops() if name == "stops" else road_load.read_cycle(DATA / f"{name}.csv")
    drive = road_load.front_brake(time, speed, road_load.Brake.of(scene.start_values()))
    values = np.column_stack([drive.sliding_velocity, drive.normal_load])
    return Schedule(INPUTS, drive.time, values, interpolation or "hold"), 0.1, float(np.trapezoid(speed, time))


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
