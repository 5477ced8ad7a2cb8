"""Tests of the Python package, as `cargo fmu test --slow` runs them: from the package as a folder on the path."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STOP = {"time [s]": [0, 0.3, 4, 5], "sliding_velocity [km/h]": [36, 36, 0, 0], "normal_load [kN]": [0, 8, 8, 0]}


def needed(variable):
    value = os.environ.get(variable)
    if value is None:
        pytest.skip(f"{variable} is not set: `cargo fmu test --slow` sets it")
    return value


def command(folder, *arguments):
    environment = os.environ | {"CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")}
    program = needed("SLIDING_CONTACT_COMMAND")
    return subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True, env=environment)


@pytest.fixture
def stop_csv(tmp_path):
    path = tmp_path / "stop.csv"
    path.write_text(",".join(STOP) + "\n" + "\n".join(",".join(map(str, row)) for row in zip(*STOP.values())) + "\n")
    return path
