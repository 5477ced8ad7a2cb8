"""The drive cycle as the tests use it: one row of inputs for every step."""

import road_load
from conftest import ROOT

import numpy as np

STEP = 0.1


def udds(fmu, seconds=None):
    """Drive of a front brake over the UDDS (see examples/disc_brake) and its inputs, held over each step of `STEP`."""
    time, speed = road_load.read_cycle(ROOT / "examples" / "data" / "udds.csv")
    names = ("contact.mean_radius", "contact.friction_coefficient", "contact.faces", "punch.width", "depth")
    drive = road_load.front_brake(time, speed, road_load.Brake.of({name: fmu.start(name) for name in names}))
    steps = round((time[-1] if seconds is None else seconds) / STEP)
    at = STEP * np.arange(steps)
    inputs = np.column_stack(
        [np.interp(at, drive.time, drive.sliding_velocity), np.interp(at, drive.time, drive.normal_load)]
    )
    return drive, inputs
