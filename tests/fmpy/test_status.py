"""Spot checks of the status policy as an importer meets it; the whole table is tested in Rust."""

import math
from ctypes import byref

import pytest
from component import DISCARD, ERROR, OK, Component, status_of
from fmpy.fmi2 import fmi2CoSimulation, fmi2ModelExchange
from lxml import etree

NAN, INFINITY = float("nan"), float("inf")


@pytest.mark.parametrize(
    "name, value, status",
    [
        ("punch.height", 0.02, OK),
        ("punch.height", 0.0, DISCARD),
        ("punch.height", 11.0, DISCARD),
        ("punch.height", NAN, DISCARD),
        ("punch.poissons_ratio", 0.5, DISCARD),
        ("contact.faces", 0, DISCARD),
        ("contact.faces", 3, OK),
        ("solver.fidelity", 9, DISCARD),
        ("solver.fidelity", 0, DISCARD),
        ("contact.shear_coupling", False, OK),
        ("sliding_velocity", NAN, OK),
        ("normal_load", -5.0, OK),
        ("wear_depth", 1.0, ERROR),
        ("profile.x[1]", 1.0, ERROR),
    ],
)
def test_setting_before_initialisation(component, name, value, status):
    assert component.try_set(name, value) == status


@pytest.mark.parametrize("name, status", [("punch.height", ERROR), ("contact.friction_coefficient", OK),
                                          ("ambient_temperature", OK), ("wear_acceleration", OK),
                                          ("sliding_velocity", OK)])
def test_only_inputs_and_tunable_parameters_are_set_between_steps(component, name, status):
    component.initialise()
    component.step(0.1)
    before = component.get("punch.height")
    assert component.try_set(name, 300.0 if name == "ambient_temperature" else 1.0) == status
    assert component.get("punch.height") == before
    assert component.try_step(0.1) == OK


def test_a_vector_is_checked_before_any_of_it_is_stored(component):
    names = ("punch.height", "strip.height")
    references = [component.fmu.variables[name].valueReference for name in names]
    before = component.get(*names)
    assert status_of(component.slave.setReal, references, [0.02, -1.0]) == DISCARD
    assert (component.get(*names) == before).all()


def test_unknown_and_mistyped_references_are_errors(component):
    variables = component.fmu.variables
    assert status_of(component.slave.getReal, [10**6]) == ERROR
    assert status_of(component.slave.setReal, [10**6], [1.0]) == ERROR
    assert status_of(component.slave.getInteger, [variables["punch.height"].valueReference]) == ERROR
    assert status_of(component.slave.getReal, [variables["contact.faces"].valueReference]) == ERROR
    assert component.initialise().try_step(0.1) == OK


def test_wrong_order_is_an_error_and_leaves_the_instance_usable(component):
    assert component.try_step(0.1) == ERROR
    assert status_of(component.slave.exitInitializationMode) == ERROR
    component.initialise()
    assert status_of(component.slave.enterInitializationMode) == ERROR
    assert component.try_step(0.1) == OK
    assert status_of(component.slave.terminate) == OK
    assert component.try_step(0.1) == ERROR


@pytest.mark.parametrize("value", [NAN, INFINITY, -INFINITY])
@pytest.mark.parametrize("name", ["sliding_velocity", "normal_load", "ambient_temperature_offset"])
def test_an_input_that_is_no_number_fails_the_next_step(component, name, value):
    component.initialise()
    assert component.try_set(name, value) == OK
    assert component.try_step(0.1) == ERROR
    assert name in component.log()
    assert status_of(component.slave.terminate) == OK


def test_rules_that_join_parameters_are_checked_at_the_end_of_initialisation(component):
    # A pivot higher than half the width over the friction coefficient admits no equilibrium: the punch tips over.
    component.set({"holder.constraint": "translate_and_rotate", "holder.pivot_height": 1.0})
    component.slave.setupExperiment(startTime=0.0)
    assert status_of(component.slave.enterInitializationMode) == OK
    assert status_of(component.slave.exitInitializationMode) == ERROR
    assert "holder.pivot_height" in component.log()
    component.slave.reset()
    assert component.initialise().try_step(0.1) == OK


def test_stop_time(component):
    component.initialise(stop=1.0)
    assert component.try_step(0.6) == OK
    assert component.try_step(0.4 + 1e-10) == OK, "rounding past the stop time is absorbed"
    assert component.try_step(0.1) == ERROR


def test_steps_that_are_no_steps(component):
    component.initialise(sliding_velocity=5.0, normal_load=1000.0)
    component.step(0.5)
    before = component.outputs()
    assert component.try_step(0.0) == OK
    assert component.outputs() == before


@pytest.mark.parametrize("size", [-0.1, NAN, INFINITY])
def test_steps_that_are_wrong(component, size):
    component.initialise()
    assert component.try_step(size) == ERROR


def test_communication_point(component):
    component.initialise()
    assert component.try_step(0.1, at=1e-13) == OK, "rounding drift is absorbed"
    assert component.try_step(0.1, at=5.0) == ERROR


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


def instantiate(component, kind=fmi2CoSimulation, name=b"raw", location=None):
    """Instantiates once more through the library of an instance; frees and returns whether there was one."""
    handle = component.slave.fmi2Instantiate(
        name, kind, component.fmu.description.guid.encode(), location, byref(component.callbacks), 0, 1
    )
    if handle:
        component.slave.fmi2FreeInstance(handle)
    return bool(handle)


@pytest.mark.parametrize(
    "location",
    [None, b"", b"file:///opt/fmu/resources", b"file:/opt/fmu/resources", b"file://localhost/opt/a%20b/", b"/opt/fmu/resources",
     b"C:\\fmu\\resources", b"file:///C:/fmu", b"http://example.org/x", b"\xff\xfe", b"file:///" + b"x" * 5000],
)
def test_every_spelling_of_the_resource_location_is_accepted(component, location):
    assert instantiate(component, location=location)


@pytest.mark.parametrize("arguments", [{"kind": fmi2ModelExchange}, {"kind": 7}, {"name": b""}, {"name": None}])
def test_a_wrong_type_or_name_gives_null(component, arguments):
    assert not instantiate(component, **arguments)


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


def test_with_logging_off_warnings_and_errors_are_reported(stock):
    with Component(stock, logging=False) as component:
        component.set(**{"nominal.velocity": 2.0})  # Below the critical speed, of which the scene warns.
        component.initialise(normal_load=-1.0, sliding_velocity=1.0)
        component.step(0.1)
        component.step(0.1)
        [warning] = component.messages
        assert warning.category == "logStatusWarning" and "normal_load = -1 N is below 0 N" in warning.text
        component.set(normal_load=NAN)
        assert component.try_step(0.1) == ERROR
        assert [message.category for message in component.messages] == ["logStatusWarning", "logStatusError"]


def test_start_values_are_those_of_the_description(component):
    for name, variable in component.fmu.variables.items():
        if variable.type == "Real" and variable.start is not None:
            assert component.get(name) == float(variable.start), name


def test_profiles_and_outputs_are_finite_from_the_start(component):
    component.initialise(sliding_velocity=5.0, normal_load=1000.0)
    names = [name for name, variable in component.fmu.variables.items() if variable.type == "Real"]
    assert all(math.isfinite(value) for value in component.get(*names))
