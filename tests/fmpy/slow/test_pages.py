"""Numbers of the pages: those that a command computes are what it computes now (docs/results.py)."""

import importlib.util

import pytest

from conftest import ROOT

SPECIFICATION = importlib.util.spec_from_file_location("results_of_pages", ROOT / "docs" / "results.py")
results = importlib.util.module_from_spec(SPECIFICATION)
SPECIFICATION.loader.exec_module(results)


@pytest.mark.parametrize("name", results.CHECKS)
def test_the_pages_have_the_numbers_of_the_command(name):
    assert list(results.differences(name)) == []


def test_a_number_is_compared_to_its_last_digit_and_replaced():
    page = "It reaches 171 °C,\nloses 3.74 µm in 1,369 s, closes to below 1e-14, and gains +0.4 %."
    passage = "reaches {} °C, loses {} µm in {} s, closes to below {}, and gains {} %"
    fine = (171.4, 3.745, 1369, results.Below(3e-15), 0.41)
    assert results.compared(page, passage, fine) == (page, [])
    new, differing = results.compared(page, passage, (173.2, 3.76, 1371, results.Below(3e-14), -0.73))
    assert len(differing) == 5
    assert new == "It reaches 173 °C,\nloses 3.76 µm in 1,371 s, closes to below 3e-14, and gains -0.7 %."
    assert results.compared(page, "loses {} mm", (1.0,)) == (page, ["0 passages read 'loses {} mm'"])
