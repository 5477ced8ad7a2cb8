"""Scenes: values with units, arrays, what is refused, and that threads may share the library."""

import pickle
import re

import numpy as np
import pytest

from conftest import STOP
from sliding_contact import Error, Scene, fit, fmu, host

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def test_what_only_python_can_get_wrong_is_refused():
    scene = Scene.load("disc_brake")
    result = scene.simulate(STOP)
    for wrong, text in (
        (lambda: scene.simulate({"time [s]": [0, 1], "sliding_velocity [m/s]": [1, 2, 3]}), "has 2 rows, others have 3"),
        (lambda: scene.simulate({"time [s]": [0, 1], "sliding_velocty [m/s]": 1}), 'inputs, line 1, column 2: "sliding_velocty [m/s]"'),
        (lambda: scene.simulate({"time [s]": [0, 1], "sliding_velocity [m/s]": [1, "fast"]}), '"fast" is no number'),
        (lambda: scene.simulate(STOP, step=0.0), "step = 0 s must be above 0 s"),
        (lambda: scene.simulate(STOP, step="5 kN"), "step = '5 kN': \"5 kN\" has the wrong unit \"kN\"; accepted are s, min, h, ms"),
        (lambda: scene.simulate(STOP, step=float("nan")), "step = nan must be a finite number"),
        (lambda: scene.simulate(STOP, at="late"), "at = 'late'"),
        (lambda: scene.steady(cells=9.5), "cells = 9.5 must be a whole number from 1 to 1025"),
        (lambda: scene.steady(cells=100_000), "cells = 100000 must be a whole number from 1 to 1025"),
        (lambda: scene.steady(return_speed="fast"), "return_speed = 'fast' must be a finite number"),
        (lambda: scene.cycles("ten"), "cycles = 'ten' must be a finite number"),
        (lambda: scene.steady(cold="no"), "cold = 'no' must be True or False"),
        (lambda: scene.simulate(STOP, strict=1), "strict = 1 must be True or False"),
        (lambda: scene.plan(STOP, tolerance=float("nan")), "tolerance = nan must be a finite number"),
        (lambda: scene.set({"punch.width": None}), "punch.width = None: accepted are numbers"),
        (lambda: scene.set({"punch.width": 1j}), "punch.width = 1j is complex; a real number is accepted"),
        (lambda: scene.set({"punch.width": np.complex64(0.08)}), "punch.width = (0.07999999821186066+0j) is complex"),
        (lambda: scene.set({"punch.width [mm]": np.array(80 + 1j)}), "punch.width [mm] = (80+1j) is complex"),
        (lambda: scene.set({"contact.friction_fade.factor": np.ones(8) + 1j}), "contact.friction_fade.factor = (1+1j) is complex"),
        (lambda: scene.set_numbers({"solver.fidelity": 1j}), "solver.fidelity = 1j is complex"),
        (lambda: scene.simulate({**STOP, "normal_load [kN]": np.array([0, 8, 8, 1j])}), "inputs: the column 'normal_load [kN]' = 0j is complex"),
        (lambda: scene.simulate({**STOP, "normal_load [kN]": np.complex128(8)}), "inputs: the column 'normal_load [kN]' = (8+0j) is complex"),
        (lambda: scene.simulate(STOP, step=np.complex128(1)), "step = (1+0j) is complex"),
        (lambda: scene.simulate(STOP, at=np.array([1j])), "at = 1j is complex"),
        (lambda: result.compare({"time [s]": [0, 1j], "contact_temperature [degC]": 20}), "measured: the column 'time [s]' = 1j is complex"),
        (lambda: fit.Records([1.0 + 2j], [1.0], [1.0], [1.0]), "records: load has the complex number (1+2j)"),
        (lambda: host.Schedule(("normal_load",), [0.0], [[1j]]), "schedule: values has the complex number 1j"),
        (lambda: scene.set(["punch.width"]), "set takes a dictionary"),
        (lambda: scene.set({"punch.width [kN]": 3}), "wrong unit \"kN\"; accepted are m, mm"),
        (lambda: scene.set({"punch.width [mm]": "3 mm"}), "punch.width [mm] = '3 mm': the name has the unit already"),
        (lambda: scene[3], "3 is no name of a variable"),
        (lambda: Scene.load(3), "3 is no scene; accepted are the path of a scene file and the names clutch, disc_brake"),
        (lambda: result["contact_temprature"], "no input or output 'contact_temprature'"),
        (lambda: result["contact_temperature [bar]"], "wrong unit"),
        (lambda: result.profiles, "solver.fidelity"),
        (lambda: scene["punch.widht"], "no variable"),
        (lambda: result.plot("stop.jpg"), "stop.jpg: .svg, .pdf, .png are drawn, not .jpg"),
        (lambda: fmu("disc_break"), "disc_brake"),
    ):
        with pytest.raises((Error, OSError)) as raised:
            wrong()
        assert text in str(raised.value)
    before = scene["punch.width"]
    with pytest.raises(Error):
        scene.set({"punch.width": 0.08, "punch.height": -1})
    assert scene["punch.width"] == before, "what is refused changes nothing"


def test_values_have_units_both_ways():
    scene = Scene.load("disc_brake").set({"punch.width": "80 mm", "normal_load": "12 kN", "contact.shear_coupling": False})
    assert scene["punch.width"] == 0.08 and scene["punch.width [cm]"] == 8.0 and scene["normal_load [kN]"] == 12.0
    assert scene["contact.shear_coupling"] is False and scene.unit("contact.shear_coupling") == "1"
    scene["punch.width"] = np.float64(0.09)
    assert scene["punch.width"] == 0.09 and scene.copy()["punch.width"] == 0.09
    result = scene.simulate(STOP)
    assert result["contact_temperature [degC]"] == pytest.approx(result["contact_temperature"] - 273.15)
    assert result["sliding_velocity [km/h]"].max() == pytest.approx(36.0)
    assert result["time [min]"][-1] == pytest.approx(5 / 60)


def test_arrays_of_no_dimension_are_numbers(tmp_path):
    scene = Scene.load("disc_brake").set({"punch.width": np.array(0.08), "punch.height [mm]": np.array(20), "normal_load": np.array("4 kN")})
    assert (scene["punch.width"], scene["punch.height [mm]"], scene["normal_load"]) == (0.08, 20.0, 4000.0)
    scene.set_numbers({"punch.width": np.array(0.09), "solver.fidelity": np.array(2)})
    assert scene["punch.width"] == 0.09
    constant = {**STOP, "normal_load [kN]": np.array(4)}
    one, other = (scene.simulate(inputs, step=step) for inputs, step in ((constant, np.array(0.1)), ({**STOP, "normal_load [kN]": 4}, 0.1)))
    assert np.array_equal(one["contact_temperature"], other["contact_temperature"])
    assert fit.Records(np.array(1.0), [1.0], [1.0], [1.0]).load.tolist() == [1.0]
    mixed = {**STOP, "normal_load [kN]": [np.array(0), np.float32(8), 8, 0]}
    assert np.array_equal(scene.simulate(mixed)["wear_depth"], scene.simulate(STOP)["wear_depth"])


def test_arrays_are_read_and_set_as_in_a_scene_file():
    table = "contact.friction_table"
    scene = Scene.load("disc_brake")
    stock = scene[f"{table}.speed"]
    assert stock.tolist() == list(range(16)) and f"{table}.speed" in scene and scene.unit(f"{table}.speed") == "m/s"
    scene.set({f"{table}.points": 3, f"{table}.speed": [0, "18 km/h", 20], f"{table}.coefficient": np.array([0.5, 0.4, 0.3])})
    assert scene[f"{table}.speed"].tolist() == [0, 5, 20, *stock[3:]] and scene[f"{table}.speed [km/h]"][2] == pytest.approx(72)
    assert scene[f"{table}.speed[2]"] == 5 and scene[f"{table}.coefficient"][2] == 0.3
    # A shorter table: what it leaves out is as the scene has it, not as the longer one.
    scene.set({table: {"speed": [0, 8], "coefficient": [0.5, 0.4]}})
    assert scene[f"{table}.points"] == 2
    assert scene[f"{table}.speed"].tolist() == [0, 8, *stock[2:]]
    scene.set(f"{table}.speed", [0, 9])
    assert scene[f"{table}.speed"][1] == 9 and scene.copy()[f"{table}.speed"][1] == 9
    fade = "contact.friction_fade"
    scene.set({f"{fade}.temperature [degC]": [20, 300], f"{fade}.factor": [1, "70 %"]})
    assert scene[f"{fade}.factor"].tolist() == [1.0] + 7 * [0.7] and scene[f"{fade}.temperature [degC]"][1] == pytest.approx(300)
    assert Scene.load("hot_spots")["contact.initial_gap [um]"].shape == (33,)
    for name, value, text in (
        (f"{table}.speed", list(range(17)), "has 17 elements, but must have 1 to 16"),
        ("contact.friction_fade.factor", [1.0, 0.9], "has 2 elements, but must have 8"),
        (fade, {"factor": [1.0, 0.9], "temperature": [300, 400, 500]}, f"has 2 elements, but must have 8, or as many as {fade}.temperature"),
        (f"{table}.speed", 3.0, "must be an array of 16 elements"),
        (f"{table}.speed", None, "one name and its value"),
        (f"{table}.speeed", [1], f"did you mean {table}.speed"),
    ):
        with pytest.raises(Error, match=re.escape(text)):
            scene.set(name, value)
    with pytest.raises(Error, match=re.escape(f"{table}.speed has the elements 1 to 16")):
        scene[f"{table}.speed[17]"]
    with pytest.raises(Error, match=re.escape(f"did you mean {table}.speed")):
        scene[f"{table}.sped"]


def test_a_scene_is_the_numbers_that_its_fmu_starts_with():
    for name in ("clutch", "pin_on_disk"):
        scene = Scene.load(name)
        numbers = scene.start_values()
        assert numbers["solver.fidelity"] in (1.0, 2.0, 3.0, 4.0) and "sliding_velocity" not in numbers
        stock = Scene.load()
        changed = {own: value for own, value in numbers.items() if stock.start_values()[own] != value}
        assert stock.set_numbers(changed).start_values() == numbers
    with pytest.raises(Error, match="solver.fidelity = 9 is none of 1 to"):
        Scene.load("clutch").set_numbers({"solver.fidelity": 9})


def test_a_simulation_stays_in_its_process():
    with pytest.raises(TypeError, match="belongs to its process"):
        pickle.dumps(Scene.load("disc_brake").set({"nominal.duration": "1 s"}).simulate())
    again = pickle.loads(pickle.dumps(Scene.load("disc_brake").set({"punch.width": 0.08})))
    assert again["punch.width"] == 0.08
