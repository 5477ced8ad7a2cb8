"""States of other scenes, reset and recovery, scenes side by side; replay, damage and threads are tested in Rust."""

import numpy as np
from component import ERROR, Component, status_of
from drive_inputs import STEP, udds

CHECKED = ("wear_depth", "contact_temperature", "friction_force", "stored_heat", "dissipated_energy", "estimated_error")


def drive(component, inputs):
    return component.run(inputs, STEP, CHECKED)


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
