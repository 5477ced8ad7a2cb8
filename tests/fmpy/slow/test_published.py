"""Published solutions beside the model's (examples/published): every deviation lies in its band, and leaves it when the
model is changed."""

import os
import re
from pathlib import Path

import pytest

import example_modules

published = example_modules.load("published", "cases", "model", "plots")
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


@pytest.mark.parametrize("name", CASES)
def test_the_figure_of_the_page_is_the_one_that_is_drawn(name, tmp_path):
    drawn = published.plots.draw(CASES[name].compute(model()), tmp_path / f"{name}.svg")
    committed = example_modules.EXAMPLES / "published" / f"{name}.svg"
    assert texts(drawn) == texts(committed), "`cargo fmu run published` draws it anew"
    assert size(drawn) == pytest.approx(size(committed), rel=0.02), "curves with other points"


def texts(path):
    return re.findall(r"<text[^>]*>(?:<[^>]*>)*([^<]*)<", path.read_text(encoding="utf-8"))


def size(path):
    return len(path.read_text(encoding="utf-8"))


def test_every_case_has_its_figure_and_its_row_in_the_page():
    folder = example_modules.EXAMPLES / "published"
    page = (folder / "README.md").read_text(encoding="utf-8")
    for name in CASES:
        assert (folder / f"{name}.svg").is_file() and f"({name}.svg)" in page, name
