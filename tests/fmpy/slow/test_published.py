"""Published solutions beside the model's (examples/published): every deviation lies in its band, and leaves it when the
model is changed."""

import os
from pathlib import Path

import pytest

import example_modules

published = example_modules.load("published", "cases", "model")
CASES = published.cases.CASES


def model(*changes):
    command = os.environ.get("SLIDING_CONTACT_COMMAND")
    if command is None:
        pytest.skip("SLIDING_CONTACT_COMMAND is not set: `cargo fmu test --slow` sets it")
    return published.model.Model(Path(command), changes)


@pytest.mark.parametrize("name", CASES)
def test_deviations_are_within_their_bands(name):
    for item in CASES[name].compute(model()).comparisons:
        assert item.holds, f"{item.quantity}: {item.published:g} published, {item.model:g} computed, band {item.band}"


@pytest.mark.parametrize("name", CASES)
def test_a_changed_model_leaves_its_bands(name):
    assert not all(item.holds for item in CASES[name].compute(model(CASES[name].change)).comparisons)
