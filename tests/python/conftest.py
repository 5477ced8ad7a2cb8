"""Tests of the Python package, as `cargo fmu test --slow` runs them: from the package as a folder on the path."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STOP = {"time [s]": [0, 0.3, 4, 5], "sliding_velocity [km/h]": [36, 36, 0, 0], "normal_load [kN]": [0, 8, 8, 0]}


def needed(variable):
    value = os.environ.get(variable)
    if value is None:
        pytest.skip(f"{variable} is not set: `cargo fmu test --slow` sets it")
    return value
