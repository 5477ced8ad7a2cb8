"""Results are those of the command line to the last bit, and so are refusals; warnings, figures."""

import csv
import json
import pickle
import re
import subprocess
import sys
import warnings

import numpy as np
import pytest

from conftest import STOP, command
from sliding_contact import Error, Scene, SceneWarning, StepFailed, fmu, host

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def test_results_are_those_of_the_command_to_the_last_bit(tmp_path, stop_csv):
    line = {"punch.width": "80 mm", "solver.fidelity": "line", "solver.cells": 9}
    result = Scene.load("disc_brake").set(line).simulate(STOP, at=[1.0, 2.0])
    settings = [part for name, value in line.items() for part in ("--set", f"{name}={value}")]
    run = command(tmp_path, "simulate", "disc_brake", "--inputs", str(stop_csv), *settings, "--at", "1,2", "-o", "out.csv")
    assert run.returncode == 0, run.stderr
    with open(tmp_path / "out.csv", newline="") as file:
        header, *table = csv.reader(file)
    table = np.array(table, dtype=float)
    assert header == ["time [s]", *(f"{name} [{unit}]" for name, unit in result.units.items())]
    assert np.array_equal(table[:, 0], result.time)
    for column, name in zip(table.T[1:], result):
        assert np.array_equal(column, result[name]), name
    with open(tmp_path / "out.profiles.csv", newline="") as file:
        own = np.array(list(csv.reader(file))[1:], dtype=float)
    profiles = result.profiles
    assert np.array_equal(profiles.time, [1.0, 2.0]) and profiles.pressure.shape == (2, profiles.x.size)
    expected = (np.tile(profiles.x, 2), profiles.pressure, profiles.temperature, profiles.wear_punch, profiles.wear_strip)
    assert all(np.array_equal(column, np.ravel(values)) for column, values in zip(own.T[1:], expected))


def test_beside_a_record_the_table_is_that_of_the_command(tmp_path):
    """A run without strokes is one of a rig beside a record: volume over distance, running-in; its step follows the record."""
    rows = "".join(f"{time},10,4000,{20 + 3 * time}\n" for time in range(0, 30, 3))
    (tmp_path / "rig.csv").write_text("time [s],sliding_velocity [m/s],normal_load [N],contact_temperature [degC]\n" + rows)
    rig = tmp_path / "rig.csv"
    result = Scene.load("disc_brake").simulate(rig, measured=rig)
    assert result.record["rig"]["worn_volume_per_distance"] > 0.0 and result.record["measured"][0]["points"] == 10
    assert set(np.arange(0.0, 30.0, 3.0)) <= set(result.time)
    arguments = ["simulate", "disc_brake", "--inputs", "rig.csv", "--measured", "rig.csv"]
    own = subprocess.run([sys.executable, "-m", "sliding_contact", *arguments], cwd=tmp_path, capture_output=True, text=True)
    printed = [
        [line for line in text.splitlines() if not line.startswith(("cost", "inputs"))]
        for text in (command(tmp_path, *arguments).stdout, own.stdout, str(result))
    ]
    assert printed[0] == printed[1] == printed[2]
    assert {"worn", "running-in", "deviation"} <= {line.split()[0] for line in printed[0]}


def test_steady_cycles_and_plan_are_those_of_the_commands(tmp_path, stop_csv):
    punch = Scene.load("reciprocating_punch")
    for arguments, record in (
        (["steady", "reciprocating_punch", "--cells", "17"], punch.steady(cells=17).record),
        (["cycles", "reciprocating_punch", "--cells", "9", "--cycles", "1000", "--cold"], punch.cycles(1000, cells=9, cold=True).record),
        (["plan", "reciprocating_punch", "--tolerance", "0.1"], punch.plan(tolerance=0.1).record),
    ):
        run = command(tmp_path, *arguments, "--json")
        assert run.returncode == 0, run.stderr
        record.pop("scene_warnings")
        assert json.loads(run.stdout) == record, arguments[0]


@pytest.mark.parametrize(
    "refused, arguments",
    [
        (lambda: Scene.load("disc_break"), ["simulate", "disc_break"]),
        (lambda: Scene.load("nowhere/scene.toml"), ["simulate", "nowhere/scene.toml"]),
        (lambda: Scene.load("disc_brake").set({"punch.widht": 1}), ["simulate", "disc_brake", "--set", "punch.widht=1"]),
        (lambda: Scene.load("disc_brake").set({"punch.width": "80 mph"}), ["simulate", "disc_brake", "--set", "punch.width=80 mph"]),
        (lambda: Scene.load("disc_brake").set({"punch.width": -1}), ["simulate", "disc_brake", "--set", "punch.width=-1"]),
        (lambda: Scene.load("disc_brake").set({"solver.fidelity": "best"}), ["simulate", "disc_brake", "--set", "solver.fidelity=best"]),
        (lambda: Scene.load("disc_brake").simulate("none.csv"), ["simulate", "disc_brake", "--inputs", "none.csv"]),
        (lambda: Scene.load("disc_brake").simulate("bad.csv"), ["simulate", "disc_brake", "--inputs", "bad.csv"]),
        (lambda: Scene.load("disc_brake").simulate("unit.csv"), ["simulate", "disc_brake", "--inputs", "unit.csv"]),
        (lambda: Scene.load("disc_brake").simulate(at=[-1.0]), ["simulate", "disc_brake", "--at", "-1"]),
        (lambda: Scene.load("disc_brake").cycles(10), ["cycles", "disc_brake", "--cycles", "10"]),
        (lambda: Scene.load("reciprocating_punch").cycles(0.5), ["cycles", "reciprocating_punch", "--cycles", "0.5"]),
        (lambda: Scene.load("disc_brake").steady(return_speed=1.0), ["steady", "disc_brake", "--return-speed", "1"]),
        (lambda: Scene.load("disc_brake").simulate().compare("late.csv"), ["simulate", "disc_brake", "--measured", "late.csv"]),
    ],
)
def test_errors_have_the_text_of_the_command_line(tmp_path, monkeypatch, refused, arguments):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.csv").write_text("time [s],sliding_velocity [m/s],normal_load [N]\n0,1,2\n1,fast,2\n")
    (tmp_path / "unit.csv").write_text("time [s],sliding_velocity\n0,1\n1,1\n")
    (tmp_path / "late.csv").write_text("time [s],contact_temperature [degC]\n1e6,20\n")
    with pytest.raises(Error) as raised:
        refused()
    run = command(tmp_path, *arguments)
    assert run.returncode != 0
    assert f"error: {raised.value}" in run.stderr.splitlines(), (str(raised.value), run.stderr)


def test_the_plan_on_inputs_names_settings_of_the_scene():
    brake = Scene.load("disc_brake")
    plan = brake.plan(STOP, tolerance=0.1)
    assert plan.estimated_error <= 0.1 and len(plan.frame()) >= 3
    brake.set(plan.settings)
    assert (brake["solver.fidelity"], brake["solver.tolerance"]) == (plan.level, 0.1)


def test_results_of_steady_states_and_cycles_are_arrays():
    state = Scene.load("reciprocating_punch").steady(cells=17)
    assert [stroke.direction for stroke in state.strokes] == ["forward", "backward"]
    assert state.heat["strokes"][0]["temperature_punch"].shape == state.x.shape == state.shape.shape == (17,)
    worn = Scene.load("reciprocating_punch").cycles(1e4, cells=9, tolerance=1e-2, cold=True)
    assert worn.cycles[-1] == 1e4 and np.all(np.diff(worn.wear_depth_punch) > 0) and np.all(np.isnan(worn.contact_temperature))
    assert worn.computed < 1e4


def test_a_step_that_fails_keeps_the_run_before_it():
    fast = {"time [s]": [0, 1, 2], "sliding_velocity [m/s]": [1, 1, 1e5], "normal_load [N]": [1e3, 1e3, 1e9]}
    with pytest.raises(StepFailed, match="the scene disc_brake: the step from .* failed") as raised:
        Scene.load("disc_brake").simulate(fast)
    result = raised.value.result
    assert 0.5 < result.time[-1] < 2.0 and result["dissipated_energy"][-1] > 0.0
    # The run stays in its process, the exception need not.
    again = pickle.loads(pickle.dumps(raised.value))
    assert type(again) is StepFailed and str(again) == str(raised.value) and again.result is None


def test_a_warning_is_a_warning_of_python():
    drag = {"time [s]": [0, 20], "sliding_velocity [m/s]": [10, 10], "normal_load [kN]": [8, 8]}
    with pytest.warns(SceneWarning, match="thermoelastically unstable"):
        Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 9}).simulate(drag)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Scene.load("pin_on_disk").set({"nominal.duration": "10 s", "solver.tolerance": 1e-2}).simulate()


def test_an_unstable_steady_state_says_so():
    rings = Scene.load("hot_spots")
    with pytest.warns(SceneWarning, match=r"sliding speed 0.2 m/s is 2.98 times the critical speed 0.067") as told:
        state = rings.steady()
    assert len(told) == 1 and state.heat["warnings"] == [str(told[0].message)]
    highest = state.heat["contact_temperature"]
    assert highest["highest_on_half"]["cells"] == 32
    assert highest["highest_on_half"]["value"] == pytest.approx(highest["highest"], abs=1e-2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rings.set("nominal.velocity", 0.05).steady().heat["warnings"] == []


def test_figures_are_drawn(tmp_path):
    pytest.importorskip("matplotlib")
    measured = {"time [s]": [0.5, 2.0], "contact_temperature [degC]": [90, 110]}
    line = Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 9}).simulate(STOP)
    for ending in ("svg", "pdf", "png"):
        line.plot(tmp_path / f"stop.{ending}", measured=measured)
    svg = (tmp_path / "stop.svg").read_text()
    assert "measured" in svg and "hottest point" in svg and "mean of both surfaces" in svg and "over the contact, at the time" in svg
    assert (tmp_path / "stop.pdf").read_bytes().startswith(b"%PDF") and (tmp_path / "stop.png").stat().st_size > 10_000
    punch = Scene.load("reciprocating_punch")
    assert len(punch.steady(cells=17).plot(tmp_path / "steady.svg").axes) == 3
    assert len(punch.cycles(1e3, cells=9, tolerance=1e-2).plot().axes) == 3
    deviation = line.compare(measured)["contact_temperature"]
    exact = np.interp(deviation.time, line.time, line["contact_temperature"]) - deviation.measured
    assert deviation.root_mean_square == pytest.approx(np.sqrt(np.mean(exact**2)))


def test_files_make_their_folder_and_say_why_they_cannot_be_written(tmp_path):
    pytest.importorskip("matplotlib")
    result = Scene.load("disc_brake").set({"nominal.duration": "1 s"}).simulate()
    result.plot(tmp_path / "not" / "there" / "stop.svg")
    assert "<svg" in (tmp_path / "not" / "there" / "stop.svg").read_text()
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.svg").mkdir()
    for wrong in (tmp_path / "file" / "stop.svg", tmp_path / "folder.svg"):
        with pytest.raises(Error, match=re.escape(f"writing {wrong}: [Errno")):
            result.plot(wrong)
    with pytest.raises(Error, match=re.escape(f"writing {tmp_path / 'file' / 'fmu'}: [Errno")):
        host.unpack(fmu("disc_brake"), tmp_path / "file" / "fmu")


def test_a_mistyped_name_of_a_result_is_told_with_those_like_it():
    with pytest.raises(Error, match="there is no input or output 'wear_depht'; did you mean wear_depth"):
        Scene.load("disc_brake").simulate()["wear_depht"]


def test_one_table_of_a_rig_is_inputs_and_record():
    """The inputs that were driven are no measurements, a load of another course is one."""
    time = np.arange(0.0, 5.0, 0.5)
    rig = {"time [s]": time, "sliding_velocity [m/s]": 8.0, "normal_load [N]": 2000.0 + 100.0 * time, "friction_force [N]": 800.0 + 30.0 * time}
    rig = {name: np.where(time == 2.0, np.nan, values) if name != "time [s]" else values for name, values in rig.items()}
    result = Scene.load("disc_brake").simulate(rig, step=0.3)
    assert list(result.compare(rig)) == ["friction_force"]
    drawn = {axis.get_ylabel(): len(axis.lines) for axis in result.plot(measured=rig).axes}
    assert (drawn["normal load (N)"], drawn["friction force (N)"]) == (1, 2), drawn
    assert list(result.compare({**rig, "normal_load [N]": 2000.0})) == ["normal_load", "friction_force"]
    with pytest.raises(Error, match="has inputs only; compared are outputs of the FMU"):
        result.compare({name: rig[name] for name in list(rig)[:3]})
