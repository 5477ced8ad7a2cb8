"""Other importers from their own wheels: each must reproduce fmpy's trajectory.

Run by `cargo fmu test --importers`. Each importer has an environment of its own, because their pins clash; one that pip
cannot install is skipped with pip's reason.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description
from fmpy.simulation import instantiate_fmu

FOLDER = Path(__file__).resolve().parent
FMU = Path(os.environ["SLIDING_CONTACT_FMU"])
ENVIRONMENTS = Path(os.environ["SLIDING_CONTACT_IMPORTERS"])
UDDS = FOLDER.parents[2] / "examples" / "data" / "udds.csv"
REQUIREMENTS = json.loads((FOLDER / "requirements.json").read_text())

# Its multiples are numbers of the machine, so that importers that count nanoseconds step at the very same instants.
STEP = 0.125  # s
TOLERANCE = 1e-12  # of each output's range
# Plain Python that is published without a wheel.
ONLY_SOURCES = ["delta", "MiniSom", "xdsmjs"]


def environment(importer):
    """Python of the importer's own environment; made where it is not there yet."""
    pins = REQUIREMENTS[importer]
    folder = ENVIRONMENTS / importer
    python = folder / "bin" / "python"
    stamp = folder / "installed.json"
    if stamp.is_file() and json.loads(stamp.read_text()) == pins:
        return python
    subprocess.run([sys.executable, "-m", "venv", "--clear", "--without-pip", folder], check=True)
    command = [sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-input", "--no-deps"]
    sources = [word for name in ONLY_SOURCES for word in ("--no-binary", name)]
    result = subprocess.run([*command, "--only-binary", ":all:", *sources, *pins], capture_output=True, text=True)
    if result.returncode != 0:
        reason = (result.stderr.strip() or "pip gave no reason").splitlines()[-1]
        pytest.skip(f"{importer} cannot be installed: {reason}")
    stamp.write_text(json.dumps(pins))
    return python


def inputs():
    """Sliding velocity and load of a brake over the UDDS: 2 kN for every 1 m/s2 of deceleration. One row per step."""
    time, speed = np.loadtxt(UDDS, delimiter=",", skiprows=1, unpack=True)
    at = np.arange(0.0, time[-1], STEP)
    deceleration = np.maximum(0.0, -np.diff(speed) / np.diff(time))
    load = 2000.0 * deceleration[np.searchsorted(time, at, side="right") - 1]
    return np.column_stack([np.interp(at, time, speed) * 0.1175 / 0.31, load])


@pytest.fixture(scope="module")
def recording():
    """Names of all real outputs, inputs, and what fmpy gets after every step."""
    description = read_model_description(FMU)
    outputs = [v for v in description.modelVariables if v.causality in ("output", "local") and v.type == "Real" and "[" not in v.name]
    references = {variable.name: variable.valueReference for variable in description.modelVariables}
    instance = instantiate_fmu(extract(str(FMU)), description, "CoSimulation")
    instance.setupExperiment(startTime=0.0)
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    table, rows = inputs(), []
    for index, row in enumerate(table):
        instance.setReal([references["sliding_velocity"], references["normal_load"]], row)
        instance.doStep(index * STEP, STEP)
        rows.append(instance.getReal([variable.valueReference for variable in outputs]))
    instance.terminate()
    instance.freeInstance()
    rows = np.array(rows)
    assert len(rows) > 10_000 and np.ptp(rows[:, [v.name == "contact_temperature" for v in outputs]]) > 10.0
    return [variable.name for variable in outputs], table, rows


@pytest.mark.parametrize("importer", sorted(set(REQUIREMENTS) - {"fmu-manipulation-toolbox"}))
def test_the_trajectory_is_the_one_of_fmpy(importer, recording, tmp_path):
    names, table, expected = recording
    (tmp_path / "inputs.json").write_text(json.dumps(table.tolist()))
    command = [environment(importer), FOLDER / "drive.py", importer, FMU, str(STEP), "inputs.json", "outputs.json"]
    result = subprocess.run([*command, *names], cwd=tmp_path, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr[-3000:]
    found = np.array(json.loads((tmp_path / "outputs.json").read_text()))
    assert found.shape == expected.shape
    span = np.ptp(expected, axis=0)
    deviation = np.abs(found - expected).max(axis=0) / np.where(span > 0.0, span, 1.0)
    worst = int(deviation.argmax())
    print(f"{importer}: largest deviation {deviation[worst]:.1e} of the range, in {names[worst]}")
    assert np.all(deviation <= TOLERANCE), f"{names[worst]} deviates by {deviation[worst]:.1e} of its range"


def test_the_checks_of_fmu_manipulation_toolbox_find_nothing(tmp_path):
    python = environment("fmu-manipulation-toolbox")
    result = subprocess.run(
        [python.parent / "fmutool", "-input", FMU, "-check"], cwd=tmp_path, capture_output=True, text=True
    )
    said = result.stdout + result.stderr
    assert result.returncode == 0, said
    assert "seems to be compliant with FMI-2.0" in said and "No semantic error" in said, said
    assert "WARNING" not in said and "ERROR" not in said, said
