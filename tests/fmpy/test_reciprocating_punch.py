"""The reciprocating punch until its wear is steady: examples/reciprocating_punch, with few cells and wear
accelerated. The direct steady state comes from the FMU itself, started from the run-in shape."""

import numpy as np
import pytest
from conftest import file_of
from example_modules import load

strokes = load("reciprocating_punch", "strokes").strokes

LOAD = 1e4
CELLS = 33
CYCLES = 900
ACCELERATION = 10.0
HOLDERS = {
    "translate": {"holder.constraint": "translate"},
    "rotate": {"holder.constraint": "translate_and_rotate", "holder.pivot_height": 30e-3},
}


@pytest.fixture(scope="module")
def punch():
    with strokes.Unpacked(file_of("reciprocating_punch")) as unpacked:
        yield unpacked


@pytest.fixture(scope="module", params=HOLDERS)
def parameters(request):
    return {**HOLDERS[request.param], "solver.cells": CELLS}


@pytest.fixture(scope="module")
def history(punch, parameters):
    return strokes.slide(punch, parameters, LOAD, CYCLES, ACCELERATION)


def run_in(punch, parameters, velocity):
    """Pressure and tilt of the direct steady state in one direction."""
    with strokes.Punch(punch, {**parameters, "contact.initial_shape": "run_in"}, LOAD, velocity) as started:
        return started.profile("pressure"), float(started.get("tilt")[0])


def test_edge_pressures_go_to_zero_and_to_twice_the_mean(history):
    first, last = history.pressure[:2] / history.mean, history.pressure[-2:] / history.mean
    # New: the elastic edges, the leading one the higher for the moment of friction.
    assert first[0, -1] > 4.0 and first[1, 0] > 4.0
    np.testing.assert_allclose(last[:, [0, -1]], [[0.0, 2.0], [2.0, 0.0]], atol=2e-3)
    # In between the trailing edge lifts off, long before the leading one has come down to twice the mean.
    released = np.argmax(history.pressure[::2, 0] == 0.0)
    assert 0 < released and history.pressure[2 * released, -1] > 3.0 * history.mean


def test_both_directions_mirror_each_other(history):
    # But for the wear of half a cycle between them.
    np.testing.assert_allclose(history.pressure[-2], history.pressure[-1][::-1], atol=2e-3 * history.mean)
    assert history.tilt[-2] == pytest.approx(-history.tilt[-1], rel=1e-2)


def test_half_stroke_means_add_to_twice_the_mean_pressure(history):
    np.testing.assert_allclose((history.means[1] + history.means[-1]) / history.mean, 2.0, atol=1e-3)
    # Each of them is far from even.
    assert np.ptp(history.means[1]) > 1.9 * history.mean


def test_it_ends_in_the_direct_steady_state(punch, parameters, history):
    for row, velocity in ((-2, 1e-2), (-1, -1e-2)):
        pressure, tilt = run_in(punch, parameters, velocity)
        distance = np.sqrt(np.mean((history.pressure[row] - pressure) ** 2)) / history.mean
        assert distance < 1e-3
        assert np.sqrt(np.mean((history.pressure[row + 2] - pressure) ** 2)) > 0.3 * history.mean
        assert history.tilt[row] == pytest.approx(tilt, rel=1e-2, abs=1e-9)


def test_the_direct_steady_state_stays(punch, parameters):
    started = {**parameters, "contact.initial_shape": "run_in"}
    history = strokes.slide(punch, started, LOAD, 100)
    # Only the wear within a half-stroke changes the shape.
    change = np.abs(history.pressure - np.tile(history.pressure[:2], (len(history.pressure) // 2, 1)))
    assert change.max() < 1e-3 * history.mean
    assert history.worn[-1].min() > 0.0


def test_pressure_and_tilt_jump_at_reversal_and_the_worn_shape_does_not(parameters, history):
    (pressure_before, worn_before), (pressure_after, worn_after) = history.reversal["before"], history.reversal["after"]
    np.testing.assert_array_equal(worn_after, worn_before)
    assert worn_before.min() > 0.0
    assert np.abs(pressure_after - pressure_before).max() == pytest.approx(2.0 * history.mean, rel=1e-2)
    jump = history.tilt[-2] - history.tilt[-1]
    assert jump == 0.0 if parameters["holder.constraint"] == "translate" else abs(jump) > 1e-5


def test_accelerated_wear_takes_the_same_way(punch, parameters, history):
    cycles = (history.half_strokes[::2] + 1) // 2
    near = np.argmin(np.abs(cycles - 20))
    slow = strokes.slide(punch, parameters, LOAD, int(ACCELERATION) * int(cycles[near]))
    np.testing.assert_allclose(slow.pressure[-2], history.pressure[2 * near], atol=2e-2 * history.mean)
    assert np.abs(slow.pressure[-2] - history.pressure[0]).max() > 0.2 * history.mean


def test_heat_warms_the_punch_and_changes_what_wears(punch, parameters):
    cycles = 60
    cold, hot = (
        strokes.slide(punch, chosen, LOAD, cycles) for chosen in (parameters, strokes.hot(punch, parameters))
    )
    ambient = punch.start("ambient_temperature")
    # Half of 24 W on 6 cm2 for 38 s: 2 q sqrt(t/(pi k rho c)), 6 K, and a little less over the strip's longer path.
    for history in (cold, hot):
        assert 3.0 < history.temperature[-1].mean() - ambient < 12.0
    # Thermal bulging makes the middle wear more and the edges less.
    middle, edges = strokes.STATIONS // 2, [0, -1]
    assert hot.worn[-1, middle] > cold.worn[-1, middle]
    assert hot.worn[-1, edges].sum() < cold.worn[-1, edges].sum()
