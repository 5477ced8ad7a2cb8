"""A corner of a car held on a hill by the bristle state, the plant integrated by an explicit master."""

import numpy as np
import pytest
from component import Component

GRAVITY = 9.80665
MASS = 1500.0 / 4  # kg, one corner
WHEEL_RADIUS = 0.31  # m


def hill(fmu, grade, load, seconds, step, stiffness, damping):
    """Travel of the car [m] and friction force [N] over time; semi-implicit Euler with the component's force held over
    each step, which is what a co-simulation master without iteration does."""
    lever = fmu.start("contact.mean_radius") / WHEEL_RADIUS
    pull = MASS * GRAVITY * np.sin(np.arctan(grade))
    parameters = {"contact.stick_stiffness": stiffness, "contact.stick_damping": damping}
    rows = []
    with Component(fmu) as component:
        component.initialise(parameters, sliding_velocity=0.0, normal_load=load)
        position = velocity = 0.0
        for _ in range(round(seconds / step)):
            force = component.get("friction_force")
            velocity += step * (pull - force * lever) / MASS
            position += step * velocity
            component.set(sliding_velocity=velocity * lever)
            component.step(step)
            rows.append((position, force, component.get("bristle_deflection")))
        assert component.get("contact_fraction") == 1.0
        energy = component.get("dissipated_energy")
    return np.array(rows), lever, pull, energy


# An explicit master of step h and mass m (at the disc: the car's over the lever squared, 2.6 t) is stable in stick for
# h k < c < 2 m/h - h k/2, with 10 ms from 1e5 to 4.7e5 N.s/m; the pull deflects the bristle by 0.1 mm.
STIFFNESS = 1e7  # N/m
DAMPING = 2e5  # N.s/m


def test_a_corner_of_a_car_stays_on_a_ten_percent_grade_for_a_minute(fmus):
    fmu = fmus("disc_brake")
    friction = fmu.start("contact.friction_coefficient") * fmu.start("contact.faces")
    lever = fmu.start("contact.mean_radius") / WHEEL_RADIUS
    pull = MASS * GRAVITY * np.sin(np.arctan(0.10))
    load = 2.0 * pull / (friction * lever)  # twice what holds
    rows, lever, pull, energy = hill(fmu, 0.10, load, 60.0, 0.010, STIFFNESS, DAMPING)
    position, force, deflection = rows.T
    assert position.max() < 1e-3 and position.min() > -1e-3
    # It came to rest where the bristle carries the pull, and no longer moves: creep would go on.
    assert position[-1] == pytest.approx(pull / lever / STIFFNESS / lever, rel=1e-3)
    assert abs(position[-1] - position[len(position) // 2]) < 1e-7
    assert force[-1] * lever == pytest.approx(pull, rel=1e-6)
    assert abs(deflection[-1]) * STIFFNESS == pytest.approx(pull / lever, rel=1e-6)
    assert 0.0 <= energy < 1.0


def test_the_bristle_gives_way_where_the_brake_is_too_weak(fmus):
    fmu = fmus("disc_brake")
    friction = fmu.start("contact.friction_coefficient") * fmu.start("contact.faces")
    lever = fmu.start("contact.mean_radius") / WHEEL_RADIUS
    pull = MASS * GRAVITY * np.sin(np.arctan(0.10))
    load = 0.5 * pull / (friction * lever)  # half of what holds
    rows, *_ = hill(fmu, 0.10, load, 5.0, 0.010, STIFFNESS, DAMPING)
    # Half the pull is left: s = a t^2 / 2.
    assert rows[-1, 0] == pytest.approx(0.5 * 0.5 * pull / MASS * 25.0, rel=0.02)


def test_regularised_friction_creeps_at_the_speed_of_its_formula(fmus):
    """v = v_reg r / sqrt(1 - r^2), r the pull over what the contact can hold: way (a) of standing still."""
    fmu = fmus("disc_brake")
    with Component(fmu) as component:
        load, ratio, speed = 2000.0, 0.5, 0.01
        component.initialise({"contact.regularization_velocity": speed}, normal_load=load)
        component.set(sliding_velocity=speed * ratio / np.sqrt(1.0 - ratio**2))
        limit = component.get("friction_force_kinetic")
        assert component.get("friction_force") == pytest.approx(ratio * limit, rel=1e-9)
        slope = component.get("friction_slope")
        step = 1e-7
        force = component.get("friction_force")
        component.set(sliding_velocity=speed * ratio / np.sqrt(1.0 - ratio**2) + step)
        assert (component.get("friction_force") - force) / step == pytest.approx(slope, rel=1e-4)
