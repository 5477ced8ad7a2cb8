"""The level of the contact line through fmpy: state, run-in start."""

import time

import numpy as np
import pytest
from component import ERROR, OK, Component

LOAD = 1e4
STATIONS = 33


def stations(name):
    return [f"profile.{name}[{station + 1}]" for station in range(STATIONS)]


PRESSURE = stations("pressure")
# Without thermal distortion: these tests check the contact.
COLD = {
    "solver.fidelity": "line",
    "solver.heat": "mean",
    "punch.thermal_expansion": 0.0,
    "strip.thermal_expansion": 0.0,
}
CHECKED = [*PRESSURE, *stations("wear_punch"), "approach", "tilt", "contact_temperature", "friction_force"]


@pytest.fixture
def line(fmus):
    """Instances of the reciprocating punch at the level of the line, initialised with the given values."""
    made = []

    def initialise(values=(), velocity=1e-2, load=LOAD):
        component = Component(fmus("reciprocating_punch"))
        made.append(component)
        inputs = {"sliding_velocity": velocity, "normal_load": load}
        return component.initialise({**COLD, **dict(values), **inputs})

    yield initialise
    for component in made:
        component.slave.freeInstance()


def reciprocating(count):
    """Inputs of `count` steps: reciprocating sliding under an intermittent load."""
    phase = np.arange(count)
    return np.column_stack([1.5e-2 * np.sin(0.21 * phase), np.maximum(LOAD * np.cos(0.13 * phase), 0.0)])


def test_a_state_restored_into_other_parameters_replays_to_the_bit(line):
    component = line({"solver.cells": 129, "wear_acceleration": 100.0})
    inputs = reciprocating(60)
    component.run(inputs[:30], 0.05, CHECKED)
    state = component.slave.getFMUstate()
    data = component.slave.serializeFMUstate(state)
    component.slave.freeFMUstate(state)
    assert len(data) <= 256 * 1024
    kept = component.time
    first = component.run(inputs[30:], 0.05, CHECKED)
    assert np.all(np.ptp(first[:, :STATIONS], axis=0) > 0.0)
    # Another number of cells, another holder.
    other = line({"solver.cells": 17, "holder.constraint": "translate_and_rotate", "holder.pivot_height": 0.03})
    copy = other.slave.deSerializeFMUstate(data)
    other.slave.setFMUstate(copy)
    other.slave.freeFMUstate(copy)
    other.time = kept
    np.testing.assert_array_equal(other.run(inputs[30:], 0.05, CHECKED), first)


def test_keeping_and_restoring_a_state_takes_well_under_a_millisecond(line):
    component = line({"solver.cells": 129})
    component.step(0.1)
    times = []
    for _ in range(50):
        begin = time.perf_counter()
        state = component.slave.getFMUstate()
        component.slave.setFMUstate(state)
        component.slave.freeFMUstate(state)
        times.append(time.perf_counter() - begin)
    # The least: other processes may be running.
    assert min(times) < 0.5e-3


def test_a_refused_step_is_recovered_from_by_a_kept_state(line):
    component = line({"solver.cells": 33, "punch.wear_coefficient": 1e-9})
    component.step(0.1)
    state, before = component.slave.getFMUstate(), component.get(*CHECKED)
    assert component.try_step(1e4) == ERROR
    assert "worn through" in component.messages[-1].text
    assert component.try_step(0.1) == ERROR, "an instance in error does not step"
    component.slave.setFMUstate(state)
    component.slave.freeFMUstate(state)
    np.testing.assert_array_equal(component.get(*CHECKED), before)
    assert component.try_step(0.1) == OK


def test_a_run_in_start_has_the_steady_pressure_and_no_wear(line):
    flat, run_in = (line({"solver.cells": 65, "contact.initial_shape": shape}) for shape in ("flat", "run_in"))
    mean = LOAD / 6e-4
    assert flat.get(*PRESSURE)[-1] > 4.0 * mean
    pressure = {}
    for sign in (1, -1):
        run_in.set(sliding_velocity=sign * 1e-2)
        pressure[sign] = run_in.get(*PRESSURE)
        assert pressure[sign].max() <= 2.0 * mean * (1.0 + 1e-3)
    np.testing.assert_allclose((pressure[1] + pressure[-1]) / mean, 2.0, atol=1e-2)
    np.testing.assert_allclose(pressure[1][[0, -1]] / mean, [0.0, 2.0], atol=1e-6)
    assert run_in.get("wear_depth") == 0.0
    np.testing.assert_array_equal(run_in.get(*stations("wear_punch")), 0.0)
