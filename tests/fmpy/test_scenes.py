"""Every scene reproduces the behaviour that its name describes."""

import numpy as np
import pytest
from component import Component
from conftest import SCENES


@pytest.mark.parametrize("scene", SCENES)
def test_energy_is_closed_in_every_scene(fmus, scene):
    fmu = fmus(scene)
    with Component(fmu) as component:
        component.initialise()
        time = np.linspace(0.0, 20.0, 400)
        load = fmu.start("nominal.load") * (1.0 + 0.5 * np.sin(time))
        velocity = fmu.start("nominal.velocity") * np.sin(0.7 * time)
        names = ("dissipated_energy", "stored_heat", "heat_lost_ambient", "heat_lost_punch_top", "heat_lost_strip_base",
                 "heat_received_punch", "heat_received_strip", "wear_volume_punch", "wear_volume_strip")
        rows = component.run(np.column_stack([velocity, load]), 0.05, names)
    made, stored, *lost, punch, strip, punch_wear, strip_wear = rows.T
    assert made[-1] > 0.0
    assert np.abs(made - stored - sum(lost)).max() <= 1e-9 * made[-1]
    assert np.abs(made - punch - strip).max() <= 1e-9 * made[-1]
    for volume in (punch_wear, strip_wear):
        assert (np.diff(volume) >= 0.0).all()
    assert punch_wear[-1] + strip_wear[-1] > 0.0


def test_pin_on_disk_wears_the_volume_of_archard(fmus):
    """1000 m of constant load: k F s for each body, the standard's own evaluation."""
    fmu = fmus("pin_on_disk")
    load, speed, distance = fmu.start("nominal.load"), fmu.start("nominal.velocity"), 1000.0
    with Component(fmu) as component:
        component.initialise(sliding_velocity=speed, normal_load=load)
        for _ in range(1000):
            component.step(distance / speed / 1000)
        assert component.get("sliding_distance") == pytest.approx(distance, rel=1e-12)
        for body in ("punch", "strip"):
            coefficient = fmu.start(f"{body}.wear_coefficient")
            assert fmu.start(f"{body}.wear_pressure_exponent") == fmu.start(f"{body}.wear_velocity_exponent") == 1.0
            expected = coefficient * load * distance * fmu.start("contact.faces")
            assert component.get(f"wear_volume_{body}") == pytest.approx(expected, rel=1e-9)
        work = fmu.start("contact.friction_coefficient") * load * distance * fmu.start("contact.faces")
        assert component.get("dissipated_energy") == pytest.approx(work, rel=1e-9)


def test_reciprocating_punch_wears_the_same_in_both_directions(fmus):
    fmu = fmus("reciprocating_punch")
    stroke, omega, steps = 1.5e-3, 10.0, 200
    period = 2.0 * np.pi / omega
    # Mean velocity of every step of u = stroke sin(omega t): what it slides in the step is exact.
    position = stroke * np.sin(omega * period * np.arange(steps + 1) / steps)
    velocity = np.diff(position) / (period / steps)
    load = fmu.start("nominal.load")
    with Component(fmu) as component:
        component.initialise()
        rows = component.run(
            [(v, load) for v in np.tile(velocity, 20)], period / steps,
            ("sliding_distance", "wear_depth", "wear_volume_punch", "wear_volume_strip"),
        )
    cycles = rows[steps - 1 :: steps]
    assert cycles[-1, 0] == pytest.approx(20 * 4 * stroke, rel=1e-9)
    volume = sum(fmu.start(f"{body}.wear_coefficient") for body in ("punch", "strip")) * load * 20 * 4 * stroke
    assert cycles[-1, 2] + cycles[-1, 3] == pytest.approx(volume * fmu.start("contact.faces"), rel=1e-6)
    halves = rows[steps // 4 - 1 :: steps // 2, 1]
    assert np.diff(halves) == pytest.approx(np.diff(halves).mean(), rel=1e-6)


def test_clutch_engages(fmus):
    """A clutch brings its two sides to one speed: the energy in is that of the slip lost, J dw^2 / 2."""
    fmu = fmus("clutch")
    inertia, slip, step = 0.15, 100.0, 1e-3  # kg m2, rad/s, s
    radius = fmu.start("contact.mean_radius")
    with Component(fmu) as component:
        component.initialise()
        energy = 0.5 * inertia * slip**2
        peak = 0.0
        for index in range(20000):
            load = fmu.start("nominal.load") * min(1.0, index * step / 0.3)
            component.set(sliding_velocity=slip * radius, normal_load=load)
            torque = component.get("friction_force") * radius
            if slip - step * torque / inertia <= 0.0:
                break
            slip -= step * torque / inertia
            component.step(step)
            peak = max(peak, component.get("contact_temperature_max"))
        else:
            pytest.fail(f"the clutch still slips at {slip:.3g} rad/s after 20 s")
        made = component.get("dissipated_energy")
    # The master's Euler step takes torque of the step's beginning for both, so work and loss differ by its error.
    assert made == pytest.approx(energy, rel=0.02)
    assert fmu.start("ambient_temperature") < peak < fmu.start("ambient_temperature") + 500.0


def test_time_steps_of_a_control_unit(fmus):
    """Steps of a millisecond for a minute give what steps of a tenth of a second give."""
    fmu = fmus("disc_brake")
    names = ("contact_temperature", "wear_depth", "stored_heat")
    found = []
    for step in (0.1, 0.001):
        with Component(fmu) as component:
            component.initialise(sliding_velocity=8.0, normal_load=2000.0)
            for _ in range(round(30.0 / step)):
                component.step(step)
            found.append(component.get(*names))
    found = np.array(found)
    found[:, 0] -= fmu.start("ambient_temperature")
    np.testing.assert_allclose(found[0], found[1], rtol=1e-3)
