"""Inputs that change within a step: derivatives, reversals, touch-down and lift-off; subdivision of the communication step."""

import numpy as np
import pytest
from component import Component

RESULTS = ("wear_depth", "dissipated_energy", "stored_heat", "contact_temperature", "sliding_distance")
TOLERANCE = 1e-3


def ramp(fmu, velocity, load, duration, steps, derivatives=True):
    """Results after inputs that go from first to last value linearly, in so many steps, and the highest temperature.

    Without derivatives each step holds the values in its middle.
    """
    with Component(fmu) as component:
        # The stock scene itself declares 1e-2.
        component.initialise(tolerance=TOLERANCE)
        size, peak = duration / steps, 0.0
        rate = [(pair[1] - pair[0]) / duration for pair in (velocity, load)]
        for step in range(steps):
            at = size * (step if derivatives else step + 0.5)
            component.set(sliding_velocity=velocity[0] + rate[0] * at, normal_load=load[0] + rate[1] * at)
            if derivatives:
                component.set_input_derivative("sliding_velocity", rate[0])
                component.set_input_derivative("normal_load", rate[1])
            component.step(size)
            peak = max(peak, component.get("contact_temperature"))
        # The outputs that depend on the inputs, at the values of the end.
        component.set(sliding_velocity=velocity[1], normal_load=load[1])
        return dict(zip(RESULTS, component.get(*RESULTS))), peak


RAMPS = {
    "stop": ((10.0, 0.0), (4000.0, 4000.0)),
    "reversal": ((6.0, -4.0), (3000.0, 3000.0)),
    "touch-down": ((8.0, 8.0), (-1500.0, 3000.0)),
    "lift-off": ((8.0, 8.0), (3000.0, -4500.0)),
    "both": ((-5.0, 5.0), (2000.0, -700.0)),
}


@pytest.mark.parametrize("name", RAMPS)
def test_one_step_with_derivatives_equals_a_thousand(stock, name):
    velocity, load = RAMPS[name]
    one, _ = ramp(stock, velocity, load, 2.0, 1)
    fine, peak = ramp(stock, velocity, load, 2.0, 1000)
    held, _ = ramp(stock, velocity, load, 2.0, 4000, derivatives=False)
    for result in RESULTS:
        # Errors of a temperature are relative to the peak rise.
        scale = peak - stock.start("ambient_temperature") if result == "contact_temperature" else fine[result]
        assert abs(held[result] - fine[result]) <= 0.1 * TOLERANCE * scale, result
        assert abs(one[result] - fine[result]) <= TOLERANCE * scale, result


@pytest.mark.parametrize("name", RAMPS)
@pytest.mark.parametrize("steps", [2, 3, 4, 5, 7, 10, 20, 50, 100, 200, 500])
def test_crossings_are_located_wherever_they_fall_in_a_step(stock, name, steps):
    velocity, load = RAMPS[name]
    found, _ = ramp(stock, velocity, load, 2.0, steps)
    fine, peak = ramp(stock, velocity, load, 2.0, 1000)
    for result in RESULTS:
        scale = peak - stock.start("ambient_temperature") if result == "contact_temperature" else fine[result]
        assert abs(found[result] - fine[result]) <= TOLERANCE * scale, result


@pytest.mark.parametrize("name", RAMPS)
def test_distance_and_energy_of_a_ramp_are_exact(stock, name):
    """The integrals of |v| and mu F |v| over one step, with a regularised sign of no weight here."""
    (v0, v1), (f0, f1) = RAMPS[name]
    duration = 2.0
    found, _ = ramp(stock, (v0, v1), (f0, f1), duration, 1)
    friction = stock.start("contact.friction_coefficient") * stock.start("contact.faces")
    # Piecewise polynomials between the zeros of v and F: three Gauss points per piece are exact.
    zeros = [-a * duration / (b - a) for a, b in ((v0, v1), (f0, f1)) if a * b < 0.0]
    breakpoints = sorted([0.0, duration, *zeros])
    points, weights = np.polynomial.legendre.leggauss(3)
    distance = energy = 0.0
    for low, high in zip(breakpoints, breakpoints[1:]):
        at = 0.5 * (low + high) + 0.5 * (high - low) * points
        speed = np.abs(v0 + (v1 - v0) * at / duration)
        load = np.maximum(0.0, f0 + (f1 - f0) * at / duration)
        distance += 0.5 * (high - low) * (weights @ speed)
        energy += 0.5 * (high - low) * (weights @ (friction * load * speed))
    assert found["sliding_distance"] == pytest.approx(distance, rel=1e-9)
    assert found["dissipated_energy"] == pytest.approx(energy, rel=1e-9)


def test_derivatives_hold_for_one_step_and_setting_clears_them(component):
    component.initialise(sliding_velocity=1.0, normal_load=1000.0)

    def distance(size):
        before = component.get("sliding_distance")
        component.step(size)
        return component.get("sliding_distance") - before

    component.set_input_derivative("sliding_velocity", 2.0)
    assert distance(1.0) == pytest.approx(2.0, rel=1e-12)
    # The input keeps its value; its derivative is cleared.
    component.set(sliding_velocity=1.0)
    assert distance(1.0) == pytest.approx(1.0, rel=1e-12)
    component.set_input_derivative("sliding_velocity", 2.0)
    component.set(sliding_velocity=1.0)
    assert distance(1.0) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
def test_cutting_the_communication_step_changes_results_by_at_most_the_tolerance(stock, tolerance):
    """A stop at constant inputs, a coast, a stop: the same inputs in steps of 2 s and in steps of a hundredth of that."""
    inputs = [(10.0, 4000.0), (8.0, 4000.0), (8.0, 0.0), (3.0, 5000.0), (0.0, 500.0), (-2.0, 3000.0)] * 3

    def drive(pieces):
        with Component(stock) as component:
            component.initialise({"solver.tolerance": tolerance})
            rows = component.run(np.repeat(inputs, pieces, axis=0), 2.0 / pieces, RESULTS)
            return rows[pieces - 1 :: pieces]

    whole, cut = drive(1), drive(100)
    scale = np.abs(cut).max(axis=0)
    scale[RESULTS.index("contact_temperature")] -= stock.start("ambient_temperature")
    change = np.abs(whole - cut).max(axis=0) / scale
    assert (change <= tolerance).all(), dict(zip(RESULTS, change))
