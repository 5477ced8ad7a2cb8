"""Heat split and wear over the drive cycle against an independent solution of the same equations."""

import json
import os

import numpy as np
import pytest
from component import Component
from conftest import ROOT
from drive_inputs import STEP, udds
from quadrature import Model

SECONDS = 400.0  # a third of the cycle, with its fastest stretch


@pytest.fixture(scope="module")
def tables():
    path = os.environ.get("SLIDING_CONTACT_TABLES", ROOT / "target" / "fmu" / "tables.json")
    if not os.path.isfile(path):
        pytest.fail(f"{path} is missing: cargo fmu tables > {path}")
    with open(path, encoding="utf-8") as file:
        return json.load(file)


@pytest.fixture(scope="module")
def runs(fmus, tables):
    fmu = fmus(None)
    _, inputs = udds(fmu, SECONDS)
    names = ("heat_received_punch", "heat_received_strip", "stored_heat", "dissipated_energy",
             "wear_depth_punch", "wear_volume_strip")
    with Component(fmu) as component:
        component.initialise({"solver.tolerance": tables["tolerance"]})
        rows = component.run(inputs, STEP, names)
    return fmu, inputs, dict(zip(names, rows.T)), Model(tables).run(inputs, STEP)


@pytest.mark.parametrize("column, name", enumerate(["heat_received_punch", "heat_received_strip", "stored_heat"]))
def test_heat(runs, column, name):
    _, _, found, expected = runs
    error = np.abs(found[name] - expected[:, column]).max() / np.abs(expected[:, column]).max()
    print(f"{name}: {error:.1e}")
    assert error <= 1e-6


def test_wear(runs):
    fmu, inputs, found, _ = runs
    slid = np.abs(inputs[:, 0]) * STEP
    pressure = inputs[:, 1] / (fmu.start("punch.width") * fmu.start("depth"))
    depth = np.cumsum(fmu.start("punch.wear_coefficient") * pressure * slid)
    assert np.abs(found["wear_depth_punch"] - depth).max() <= 1e-9 * depth[-1]
    volume = np.cumsum(fmu.start("strip.wear_coefficient") * inputs[:, 1] * slid) * fmu.start("contact.faces")
    assert np.abs(found["wear_volume_strip"] - volume).max() <= 1e-9 * volume[-1]


def test_energy_in(runs):
    fmu, inputs, found, _ = runs
    friction = fmu.start("contact.friction_coefficient") * fmu.start("contact.faces")
    work = np.cumsum(friction * inputs[:, 1] * np.abs(inputs[:, 0])) * STEP
    assert np.abs(found["dissipated_energy"] - work).max() <= 1e-9 * work[-1]
