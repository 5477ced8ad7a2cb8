"""The clutch between engine and vehicle: examples/clutch."""

import numpy as np
import pytest
from conftest import file_of
from example_modules import load

example = load("clutch", "cases", "contact", "masters", "plant", "report")
cases = example.cases


@pytest.fixture(scope="module")
def clutch():
    with example.contact.Unpacked(file_of("clutch")) as unpacked:
        yield unpacked


@pytest.fixture(scope="module")
def predicted(clutch):
    return cases.predicted_limit(clutch)


@pytest.fixture(scope="module")
def quiet(clutch, predicted):
    return cases.engage(clutch, 0.9 * predicted, cases.REGULARISED, duration=1.2)


def figures(run, clutch):
    return example.report.engagement(run, clutch.start("contact.mean_radius"))


def test_friction_slope_predicts_the_longest_stable_explicit_step(clutch, predicted):
    assert cases.observed_limit(clutch, predicted) == pytest.approx(predicted, rel=0.01)


def test_explicit_coupling_chatters_above_that_step_only(clutch, predicted, quiet):
    torque = example.plant.Plant().stuck_torque
    below = figures(quiet, clutch)
    assert below["torque_stuck_N_m"] == pytest.approx(torque, rel=1e-3)
    assert below["torque_chatter_N_m"] < 0.05
    above = figures(cases.engage(clutch, 2.0 * predicted, cases.REGULARISED, duration=1.2), clutch)
    assert above["torque_chatter_N_m"] > 2.0 * torque


def test_the_bristle_sticks_and_stays(clutch, predicted, quiet):
    step = 1e-3
    assert step > 10.0 * predicted
    run = cases.engage(clutch, step)
    stuck = figures(run, clutch)
    assert stuck["slip_ends_s"] == pytest.approx(example.report.end_of_slip(quiet), abs=5.0 * step)
    assert stuck["torque_stuck_N_m"] == pytest.approx(example.plant.Plant().stuck_torque, rel=1e-6)
    assert stuck["slip_chatter_rad_per_s"] < 1e-9
    # Engine, vehicle and heat: momentum is conserved, and the loss of kinetic energy is friction heat.
    plant = example.plant.Plant()
    gained = plant.engine_inertia * (run["engine_speed"][-1] - run["engine_speed"][0])
    gained += plant.vehicle_inertia * run["vehicle_speed"][-1]
    assert gained == pytest.approx((plant.engine_torque - plant.resistance) * run["time"][-1], rel=1e-9)
    work = np.sum(run["torque"][1:] * 0.5 * (run["slip"][1:] + run["slip"][:-1])) * run.step
    assert run["dissipated_energy"][-1] == pytest.approx(work, rel=5e-3)
    assert run["wear_depth_punch"][-1] == run["wear_depth_punch"][run["time"] > 1.0][0] > 0.0


@pytest.mark.parametrize("start", [{}, cases.HOT], ids=["warm", "hot"])
def test_newton_with_roll_back_takes_four_iterations_at_fifty_times_the_limit(clutch, predicted, start):
    run = cases.engage(clutch, 50.0 * predicted, cases.REGULARISED | start, implicit=True)
    assert run.iterations.max() <= 4
    stuck = figures(run, clutch)
    assert stuck["torque_stuck_N_m"] == pytest.approx(example.plant.Plant().stuck_torque, rel=1e-5)
    # Implicit Euler is of first order: the end of slip is within a step or two of the fine explicit run's.
    fine = cases.engage(clutch, 5e-4, start, duration=1.2)
    assert stuck["slip_ends_s"] == pytest.approx(example.report.end_of_slip(fine), abs=2.5 * run.step)


def test_roll_back_leaves_no_trace(clutch):
    with example.contact.Contact(clutch, cases.REGULARISED, 100.0, cases.FULL_LOAD) as contact:
        contact.step(1e-2)
        contact.save()
        results = []
        for slip in (50.0, 200.0, 50.0):
            contact.restore()
            contact.set(slip, cases.FULL_LOAD)
            contact.step(1e-2)
            results.append(contact.get(*cases.OUTPUTS))
    assert results[0] == results[2] != results[1]


def test_a_scene_that_is_no_clutch_is_refused():
    with example.contact.Unpacked(file_of("pin_on_disk")) as unpacked, pytest.raises(ValueError, match="no clutch"):
        cases.check_capacity(unpacked)


def test_it_holds_a_parked_car_on_a_ten_percent_grade_for_a_minute(clutch):
    run, travel = cases.hill(clutch)
    assert run["time"][-1] == pytest.approx(60.0)
    assert np.abs(travel).max() < 1e-3
    # It has come to rest: creep would go on.
    assert np.ptp(travel[len(travel) // 2 :]) < 1e-9


def test_a_clutch_that_carries_too_little_lets_the_car_roll(clutch, monkeypatch):
    monkeypatch.setattr(cases, "FULL_LOAD", 400.0)
    _, travel = cases.hill(clutch, seconds=5.0)
    assert travel[-1] > 0.1


def test_judder_grows_at_the_rate_of_friction_falling_with_speed(clutch):
    driveline = cases.Driveline()
    run, slope = cases.judder(clutch, 1.17)
    assert driveline.growth_rate(slope) > 5.0
    assert cases.observed_growth_rate(run) == pytest.approx(driveline.growth_rate(slope), rel=0.05)
    # It ends in stick and slip.
    late = run["slip"][run["time"] > 1.0]
    assert late.min() < 0.1 and late.max() > 2.0 * cases.JUDDER_SLIP


def test_constant_friction_does_not_judder(clutch):
    driveline = cases.Driveline()
    run, slope = cases.judder(clutch, 1.0)
    assert slope == pytest.approx(0.0, abs=1e-6)
    assert cases.observed_growth_rate(run) == pytest.approx(driveline.growth_rate(slope), rel=0.05)
    assert np.ptp(run["slip"]) < 0.01


def test_slip_crosses_the_thermoelastic_limit_that_the_contact_tells(clutch):
    run = cases.across_critical_speed(clutch)
    speed = run["slip"] * clutch.start("contact.mean_radius")
    assert np.all(run["critical_speed"] > 0.0)
    assert run["time"][np.argmax(speed > run["critical_speed"])] == pytest.approx(1.0, abs=0.05)
    # A lining of resin conducts worse, is less stiff and expands more: its limit is lower.
    with example.contact.Contact(clutch, {}, 10.0, cases.FULL_LOAD) as contact:
        assert contact.get("critical_speed") < run["critical_speed"][-1]
