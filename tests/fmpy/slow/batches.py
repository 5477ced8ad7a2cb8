"""What the tests of batches share: the scene, its inputs, and processes that are run and waited for."""

import os
import sys
import time

import pytest

from conftest import ROOT

BATCH = ROOT / "examples" / "batch"
sys.path.insert(0, str(BATCH))

# `cargo fmu test --slow` puts the Python package on the path.
pytest.importorskip("sliding_contact")

import schedules  # noqa: E402
from sliding_contact import Scene, host  # noqa: E402

INPUTS = ("sliding_velocity", "normal_load")


def needed(variable):
    path = os.environ.get(variable)
    if path is None:
        pytest.skip(f"{variable} is not set: `cargo fmu test --slow` sets it")
    return path


@pytest.fixture(scope="module")
def brake(fmus):
    with host.Fmu(fmus("disc_brake").folder) as fmu:
        yield fmu


@pytest.fixture(scope="module")
def cycle():
    """The first 240 s of the UDDS, a row per second."""
    schedule, *_ = schedules.of_name("udds", Scene.load("disc_brake"))
    return host.Schedule(INPUTS, schedule.times[:241], schedule.values[:241])


def clean_environment():
    return {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}


def wait_for(condition, process):
    end = time.monotonic() + 60.0
    while not condition():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end, "nothing happened for a minute"
        time.sleep(0.01)
