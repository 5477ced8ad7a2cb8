"""Saving, restoring and transferring the state of an instance; fresh instances; several instances side by side."""

import threading

import numpy as np
import pytest
from component import DISCARD, ERROR, OK, Component, status_of
from drive_inputs import STEP, udds

CHECKED = ("wear_depth", "contact_temperature", "friction_force", "stored_heat", "dissipated_energy", "estimated_error")


def drive(component, inputs):
    return component.run(inputs, STEP, CHECKED)


def test_replay_after_rollback_is_bit_identical(stock, component):
    _, inputs = udds(stock, 300)
    component.initialise()
    drive(component, inputs[:1500])
    state, kept = component.slave.getFMUstate(), component.time
    first = drive(component, inputs[1500:])
    component.slave.setFMUstate(state)
    component.time = kept
    again = drive(component, inputs[1500:])
    component.slave.freeFMUstate(state)
    assert np.ptp(first[:, 0]) > 0.0
    np.testing.assert_array_equal(first, again)


def test_state_holds_inputs_and_parameters(component):
    component.initialise(sliding_velocity=3.0, normal_load=1000.0)
    state = component.slave.getFMUstate()
    before = component.outputs()
    component.set({"contact.friction_coefficient": 0.2, "sliding_velocity": -1.0, "normal_load": 10.0})
    assert component.outputs() != before
    component.slave.setFMUstate(state)
    assert component.outputs() == before
    component.slave.freeFMUstate(state)


def test_serialised_state_goes_to_another_instance(stock, component):
    _, inputs = udds(stock, 200)
    component.initialise()
    drive(component, inputs[:1200])
    state = component.slave.getFMUstate()
    data = component.slave.serializeFMUstate(state)
    component.slave.freeFMUstate(state)
    assert len(data) <= 2048
    here = drive(component, inputs[1200:])
    with Component(stock, name="other") as other:
        other.initialise({"punch.height": 0.02})
        copy = other.slave.deSerializeFMUstate(data)
        other.slave.setFMUstate(copy)
        other.slave.freeFMUstate(copy)
        other.time = 1200 * STEP
        there = drive(other, inputs[1200:])
    np.testing.assert_array_equal(here, there)


@pytest.mark.parametrize("damage", ["first byte", "middle byte", "last byte", "short", "long", "empty", "other"])
def test_damaged_bytes_are_refused_and_change_nothing(component, damage):
    component.initialise(sliding_velocity=3.0, normal_load=1000.0)
    component.step(1.0)
    state = component.slave.getFMUstate()
    data = bytearray(component.slave.serializeFMUstate(state))
    component.slave.freeFMUstate(state)
    if damage.endswith("byte"):
        data[{"first": 0, "middle": len(data) // 2, "last": -1}[damage.split()[0]]] ^= 1
    data = {"short": data[:-1], "long": data + b"\0", "empty": b"", "other": b"FMU state" * 20}.get(damage, data)
    before = component.outputs()
    assert status_of(component.slave.deSerializeFMUstate, bytes(data)) == ERROR
    assert component.outputs() == before
    assert component.try_step(0.1) == OK


def test_state_of_another_scene_is_refused(fmus):
    with Component(fmus("clutch")) as clutch, Component(fmus("disc_brake")) as brake:
        clutch.initialise()
        brake.initialise()
        state = clutch.slave.getFMUstate()
        data = clutch.slave.serializeFMUstate(state)
        clutch.slave.freeFMUstate(state)
        assert status_of(brake.slave.deSerializeFMUstate, data) == ERROR


def test_reset_gives_a_fresh_instance(stock, component):
    _, inputs = udds(stock, 150)
    with Component(stock, name="fresh") as fresh:
        expected = drive(fresh.initialise(), inputs)
    component.initialise({"punch.height": 0.02, "contact.faces": 1}, sliding_velocity=5.0, normal_load=3000.0)
    drive(component, inputs[:700])
    component.slave.reset()
    np.testing.assert_array_equal(drive(component.initialise(), inputs), expected)


def test_reset_and_restored_state_recover_from_an_error(component):
    component.initialise(sliding_velocity=3.0, normal_load=1000.0)
    component.step(1.0)
    state = component.slave.getFMUstate()
    component.step(1.0)
    expected = component.outputs()
    component.slave.setFMUstate(state)
    component.time = 1.0
    component.set(normal_load=float("nan"))
    assert component.try_step(1.0) == ERROR
    assert "normal_load" in component.log()
    assert component.try_step(1.0) == ERROR, "an instance in error does not step"
    component.slave.setFMUstate(state)
    component.slave.freeFMUstate(state)
    component.step(1.0)
    assert component.outputs() == expected

    component.set(sliding_velocity=float("inf"))
    assert component.try_step(1.0) == ERROR
    component.slave.reset()
    component.initialise(sliding_velocity=3.0, normal_load=1000.0)
    component.step(1.0)
    component.step(1.0)
    assert component.outputs() == expected


def test_scenes_in_one_process_do_not_disturb_each_other(fmus):
    """Each scene alone, then all of them in turns: the same bits."""
    scenes = ("disc_brake", "clutch", "pin_on_disk")
    pairs = [(2.0, 20.0), (1.0, 10.0), (-0.5, 15.0)] * 20

    def alone(scene):
        with Component(fmus(scene)) as component:
            return component.initialise().run(pairs, STEP, CHECKED)

    expected = {scene: alone(scene) for scene in scenes}
    components = {scene: Component(fmus(scene), name=scene).initialise() for scene in scenes}
    try:
        turns = {scene: [] for scene in scenes}
        for pair in pairs:
            for scene, component in components.items():
                turns[scene].append(component.run([pair], STEP, CHECKED)[0])
    finally:
        for component in components.values():
            component.slave.freeInstance()
    for scene in scenes:
        np.testing.assert_array_equal(np.array(turns[scene]), expected[scene])
    assert len({tuple(rows[-1]) for rows in expected.values()}) == len(scenes)


def test_instances_in_threads_give_the_results_of_one(stock):
    _, inputs = udds(stock, 150)
    with Component(stock) as component:
        expected = drive(component.initialise(), inputs)
    found = [None] * 4

    def work(index):
        with Component(stock, name=f"thread {index}") as component:
            found[index] = drive(component.initialise(), inputs)

    threads = [threading.Thread(target=work, args=(index,)) for index in range(len(found))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for rows in found:
        np.testing.assert_array_equal(rows, expected)


def test_discard_leaves_the_instance_usable(component):
    assert component.try_set("punch.height", -1.0) == DISCARD
    assert "punch.height" in component.log() and "-1" in component.log()
    component.initialise(sliding_velocity=1.0, normal_load=100.0)
    component.step(0.1)
    assert component.get("punch.height") == component.fmu.start("punch.height")
