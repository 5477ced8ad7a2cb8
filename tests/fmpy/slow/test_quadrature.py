"""Heat partition and wear over the drive cycle against an independent solution of the same equations."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from component import Component
from conftest import ROOT
from drive_inputs import STEP, udds
from quadrature import Model

SECONDS = 400.0  # a third of the cycle, with its fastest stretch


# Tables by name, and the admissible deviation of the heat from the independent solution with them. At the scene's own tolerance
# the error of the time steps counts too; far below it only a difference of the equations would show.
BOUNDS = {"scene": 1e-3, "fine": 1e-6}
NAMES = ("heat_received_punch", "heat_received_strip", "stored_heat", "dissipated_energy", "wear_depth_punch",
         "wear_volume_strip")


def tables(name):
    folder = Path(os.environ.get("SLIDING_CONTACT_FMU_FOLDER", ROOT / "target" / "fmu"))
    path = folder / f"tables.{name}.json"
    if not path.is_file():
        pytest.fail(f"{path} is missing: `cargo fmu test --slow` makes it with `cargo fmu tables`")
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module", params=BOUNDS)
def runs(request, fmus):
    fmu, data = fmus(None), tables(request.param)
    _, inputs = udds(fmu, SECONDS)
    with Component(fmu) as component:
        component.initialise({"solver.tolerance": data["tolerance"]})
        rows = component.run(inputs, STEP, NAMES)
    return BOUNDS[request.param], fmu, inputs, dict(zip(NAMES, rows.T)), Model(data).run(inputs, STEP)


def test_heat(runs):
    bound, _, _, found, expected = runs
    errors = {}
    for column, name in enumerate(NAMES[:3]):
        errors[name] = np.abs(found[name] - expected[:, column]).max() / np.abs(expected[:, column]).max()
    print(errors)
    assert max(errors.values()) <= bound, errors


def test_wear(runs):
    _, fmu, inputs, found, _ = runs
    slid = np.abs(inputs[:, 0]) * STEP
    pressure = inputs[:, 1] / (fmu.start("punch.width") * fmu.start("depth"))
    depth = np.cumsum(fmu.start("punch.wear_coefficient") * pressure * slid)
    assert np.abs(found["wear_depth_punch"] - depth).max() <= 1e-9 * depth[-1]
    volume = np.cumsum(fmu.start("strip.wear_coefficient") * inputs[:, 1] * slid) * fmu.start("contact.faces")
    assert np.abs(found["wear_volume_strip"] - volume).max() <= 1e-9 * volume[-1]


def test_energy_in(runs):
    _, fmu, inputs, found, _ = runs
    friction = fmu.start("contact.friction_coefficient") * fmu.start("contact.faces")
    work = np.cumsum(friction * inputs[:, 1] * np.abs(inputs[:, 0])) * STEP
    assert np.abs(found["dissipated_energy"] - work).max() <= 1e-9 * work[-1]
