"""Fixtures: the FMUs, unpacked once for all tests."""

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples" / "disc_brake"))

from component import Component, Fmu  # noqa: E402

SCENES = ("disc_brake", "pin_on_disk", "reciprocating_punch", "clutch")


def file_of(scene):
    """Path of a packaged scene; `None`: the stock FMU."""
    folder = Path(os.environ.get("SLIDING_CONTACT_FMU_FOLDER", ROOT / "target" / "fmu"))
    path = folder / ("SlidingContact.fmu" if scene is None else f"SlidingContact.{scene}.fmu")
    if not path.is_file():
        pytest.fail(f"{path} is missing: make it with `cargo fmu package {scene or ''}`".rstrip())
    return path


@pytest.fixture(scope="session")
def fmus():
    """Unpacked FMU by scene name; `None`: the stock FMU."""
    kept = {}

    def get(scene=None):
        if scene not in kept:
            kept[scene] = Fmu.unpack(file_of(scene))
        return kept[scene]

    yield get
    for fmu in kept.values():
        fmu.remove()


@pytest.fixture
def stock(fmus):
    return fmus(None)


@pytest.fixture
def component(stock):
    """An instance of the stock FMU, not initialised."""
    with Component(stock) as instance:
        yield instance
