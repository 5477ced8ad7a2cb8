"""What an importer meets of the description and the log; the table of statuses is tested in Rust."""

import math

import pytest
from component import ERROR, OK, Component, status_of
from lxml import etree


def test_rules_that_join_parameters_are_checked_at_the_end_of_initialisation(component):
    # A pivot higher than half the width over the friction coefficient admits no equilibrium: the punch tips over.
    component.set({"holder.constraint": "translate_and_rotate", "holder.pivot_height": 1.0})
    component.slave.setupExperiment(startTime=0.0)
    assert status_of(component.slave.enterInitializationMode) == OK
    assert status_of(component.slave.exitInitializationMode) == ERROR
    assert "holder.pivot_height" in component.log()
    component.slave.reset()
    assert component.initialise().try_step(0.1) == OK


def test_steps_that_are_no_steps(component):
    component.initialise(sliding_velocity=5.0, normal_load=1000.0)
    component.step(0.5)
    before = component.outputs()
    assert component.try_step(0.0) == OK
    assert component.outputs() == before


def test_a_negative_load_is_an_open_contact_and_logged_once(component):
    component.initialise(sliding_velocity=5.0, normal_load=-100.0)
    for _ in range(5):
        assert component.try_step(0.1) == OK
    names = ("friction_force", "pressure_mean", "wear_depth", "dissipated_energy")
    assert list(component.get(*names)) == [0.0] * len(names)
    assert sum("normal_load" in message.text for message in component.messages) == 1


def test_get_answers_to_set_without_a_step(component):
    component.initialise(sliding_velocity=5.0, normal_load=1000.0)
    force = component.get("friction_force")
    component.set(normal_load=2000.0, sliding_velocity=-5.0)
    assert component.get("friction_force") == pytest.approx(-2.0 * force, rel=1e-12)
    assert component.get("friction_power") == pytest.approx(5.0 * 2.0 * force, rel=1e-12)


def test_a_wrong_guid_gives_null(stock):
    with pytest.raises(Exception, match="instantiate"):
        Component(stock, guid="{00000000-0000-0000-0000-000000000000}")


def test_log_categories_are_declared_and_text_survives(component, stock):
    document = etree.parse(f"{stock.folder}/modelDescription.xml")
    declared = {category.get("name") for category in document.iterfind("LogCategories/Category")}
    component.try_set("punch.height", -1.0)
    component.initialise(normal_load=-1.0, sliding_velocity=1.0)
    component.step(0.1)
    assert component.messages
    assert all(message.category in declared for message in component.messages)
    with Component(stock, name="100 % #r1# %s %n") as named:
        named.try_set("punch.height", -1.0)
        assert "punch.height" in named.log()


def test_start_values_are_those_of_the_description(component):
    for name, variable in component.fmu.variables.items():
        if variable.type == "Real" and variable.start is not None:
            assert component.get(name) == float(variable.start), name


def test_profiles_and_outputs_are_finite_from_the_start(component):
    component.initialise(sliding_velocity=5.0, normal_load=1000.0)
    names = [name for name, variable in component.fmu.variables.items() if variable.type == "Real"]
    assert all(math.isfinite(value) for value in component.get(*names))
