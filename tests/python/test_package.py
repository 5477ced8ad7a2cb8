"""The functions of the package: what they return, what they refuse, and that they run in parallel."""

import csv
import json
import os
import pickle
import re
import subprocess
import threading
import time
import warnings
import zipfile

import numpy as np
import pytest

import sliding_contact
from conftest import ROOT, STOP, needed
from sliding_contact import Error, Scene, SceneWarning, StepFailed, fit, fmu, host, scenes

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")

TESTS = fit.Records([5.0, 10.0, 20.0, 40.0], [0.1] * 4, [1000.0] * 4, [1e-10, 2e-10, 4e-10, 8e-10])


def command(folder, *arguments):
    environment = os.environ | {"CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")}
    program = needed("SLIDING_CONTACT_COMMAND")
    return subprocess.run([program, *arguments], cwd=folder, capture_output=True, text=True, env=environment)


def rows(text):
    return text + "\n".join(",".join(str(column[row]) for column in STOP.values()) for row in range(4)) + "\n"


@pytest.fixture
def stop_csv(tmp_path):
    path = tmp_path / "stop.csv"
    path.write_text(rows(",".join(STOP) + "\n"))
    return path


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


def test_inputs_are_the_same_as_dictionary_frame_and_file(stop_csv):
    pandas = pytest.importorskip("pandas")
    scene = Scene.load("disc_brake")
    ways = [STOP, {**STOP, "normal_load [kN]": np.array(STOP["normal_load [kN]"])}, pandas.DataFrame(STOP), stop_csv, str(stop_csv)]
    first, *others = [scene.simulate(inputs)["contact_temperature"] for inputs in ways]
    assert all(np.array_equal(first, other) for other in others)
    again = scene.simulate(scene.simulate(STOP).frame("sliding_velocity [m/s]", "normal_load [N]"))
    assert again["dissipated_energy"][-1] == pytest.approx(scene.simulate(STOP)["dissipated_energy"][-1], rel=1e-3)


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


def test_a_step_that_fails_keeps_the_run_before_it():
    fast = {"time [s]": [0, 1, 2], "sliding_velocity [m/s]": [1, 1, 1e5], "normal_load [N]": [1e3, 1e3, 1e9]}
    with pytest.raises(StepFailed, match="the scene disc_brake: the step from .* failed") as raised:
        Scene.load("disc_brake").simulate(fast)
    result = raised.value.result
    assert 0.5 < result.time[-1] < 2.0 and result["dissipated_energy"][-1] > 0.0
    # The run stays in its process, the exception need not.
    again = pickle.loads(pickle.dumps(raised.value))
    assert type(again) is StepFailed and str(again) == str(raised.value) and again.result is None


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


def test_the_table_of_a_run_is_read_again(tmp_path):
    pandas = pytest.importorskip("pandas")
    scene = Scene.load("disc_brake")
    result = scene.simulate(STOP)
    for index in (True, False):
        path = tmp_path / f"run-{index}.csv"
        result.frame().to_csv(path, index=index)
        for table in (path, pandas.read_csv(path)):
            deviations = result.compare(table)
            assert set(deviations) == set(result)
            assert all(abs(own.largest) <= 1e-12 * max(own.range, np.abs(own.measured).max()) for own in deviations.values())
            again = scene.simulate(table)
            assert again.time[-1] == result.time[-1]
            assert again["dissipated_energy"][-1] == pytest.approx(result["dissipated_energy"][-1], rel=1e-6)
    columns = result.frame("contact_temperature [degC]", "normal_load [kN]")
    columns.iloc[::3].to_csv(path)
    assert set(result.compare(path)) == {"contact_temperature", "normal_load"}


def test_the_default_step_shows_peaks_and_a_record_of_the_model_itself():
    """A stop of a minute in a day: its peak, and a record by steps of its own, are those of fine steps."""
    day = {
        "time [s]": [0, 40_000, 40_001, 40_060, 40_061, 86_400],
        "sliding_velocity [m/s]": [12, 12, 12, 0, 0, 0],
        "normal_load [N]": [0, 0, 2000, 2000, 0, 0],
    }
    times = np.linspace(39_990, 40_200, 4201)
    fine_day = {name: np.interp(times, day["time [s]"], column) for name, column in day.items()}
    for changes in ({}, {"solver.fidelity": "line", "solver.cells": 9}):
        scene = Scene.load("disc_brake").set(changes)
        result, fine = scene.simulate(day), scene.simulate(fine_day)
        assert result.time.size < 3000
        for name in ("contact_temperature_max", "contact_temperature", "pressure_max", "friction_force"):
            rise = fine[name].max() - fine[name][0]
            assert result.record["variables"][name]["maximum"] == pytest.approx(fine[name].max(), abs=5e-3 * rise), name
        record = {"time [s]": fine.time, "contact_temperature [K]": fine["contact_temperature"]}
        deviation = result.compare(record)["contact_temperature"]
        assert abs(deviation.largest) < 2e-2 * deviation.range, deviation


def test_a_warning_is_a_warning_of_python():
    drag = {"time [s]": [0, 20], "sliding_velocity [m/s]": [10, 10], "normal_load [kN]": [8, 8]}
    with pytest.warns(SceneWarning, match="thermoelastically unstable"):
        Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 9}).simulate(drag)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Scene.load("pin_on_disk").set({"nominal.duration": "10 s", "solver.tolerance": 1e-2}).simulate()


def test_threads_run_in_parallel_and_give_the_same_bits():
    """The interpreter's lock is released: the main thread counts while others compute."""
    scene = Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 17})
    expected = scene.simulate(STOP)
    results = [None] * 4
    counted, done = 0, threading.Event()

    def work(at):
        results[at] = scene.simulate(STOP)
        if all(results):
            done.set()

    threads = [threading.Thread(target=work, args=(at,)) for at in range(4)]
    for thread in threads:
        thread.start()
    while not done.wait(1e-3) and any(thread.is_alive() for thread in threads):
        counted += 1
    for thread in threads:
        thread.join()
    # With the lock held there would be a turn or two for every thread.
    assert counted > 20, counted
    for result in results:
        assert all(np.array_equal(result[name], expected[name]) for name in expected)


def test_progress_is_reported_and_an_exception_ends_the_run():
    parts = []

    def interrupt(part):
        parts.append(part)
        raise KeyboardInterrupt

    scene = Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 33, "nominal.duration": "20000 s"})
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        scene.simulate(progress=interrupt)
    assert len(parts) == 1 and 0.0 <= parts[0] < 0.5 and time.monotonic() - begin < 30.0


#: What runs for long, of objects that are made before.
LONG = {
    "simulate": "disc.simulate()",
    "one step": "disc.simulate(step=3000.0)",
    "steady": "punch.steady(cells=257)",
    "cycles": "punch.cycles(1e9, cells=257, tolerance=1e-6)",
    "plan": "brake.plan(stops, tolerance=1e-5)",
    "host": "host.run_schedule(own, {}, schedule, outputs=['dissipated_energy'], step=1e-3)",
}

INTERRUPTED = """
import os, signal, tempfile, threading, time, warnings
import numpy as np
from sliding_contact import Scene, SceneWarning, host
warnings.simplefilter("ignore", SceneWarning)
brake, punch = Scene.load("disc_brake"), Scene.load("reciprocating_punch")
disc = brake.copy().set({"solver.fidelity": "line", "solver.cells": 257, "nominal.duration": "3000 s"})
stops = {"time [s]": np.arange(0.0, 3000.0, 5.0), "sliding_velocity [m/s]": [10.0, 0.0] * 300, "normal_load [N]": 4000}
HOST
def late(*_):
    raise TimeoutError("late")
signal.signal(signal.SIGUSR1, late)
sent = []
def send():
    sent.append(time.monotonic())
    os.kill(os.getpid(), NUMBER)
threading.Timer(1.0, send).start()
try:
    CALL
    print("done")
except (KeyboardInterrupt, TimeoutError) as error:
    print(type(error).__name__, time.monotonic() - sent[0])
time.sleep(0.1)
assert all(thread.name != "sliding_contact" for thread in threading.enumerate())
"""

OPENED = """
own = host.Fmu(host.unpack("FMU", tempfile.mkdtemp() + "/fmu"))
schedule = host.Schedule(("sliding_velocity", "normal_load"), [0.0, 1e5], [[1.0, 4000.0], [1.0, 4000.0]])
"""


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
@pytest.mark.parametrize("signalled, raised", [("signal.SIGINT", "KeyboardInterrupt"), ("signal.SIGUSR1", "TimeoutError")])
@pytest.mark.parametrize("call", LONG.values(), ids=LONG)
def test_what_a_handler_of_a_signal_raises_ends_any_call_within_a_second(call, signalled, raised):
    opened = ""
    if "host" in call:
        opened = OPENED.replace("FMU", str(fmu("disc_brake")))
    code = INTERRUPTED.replace("HOST", opened).replace("NUMBER", signalled).replace("CALL", call)
    run = subprocess.run([os.sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stderr
    name, seconds = run.stdout.split()
    assert name == raised and float(seconds) < 1.5, run.stdout


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
def test_a_handler_that_raises_nothing_ends_nothing():
    import signal

    seen = []
    before = signal.signal(signal.SIGUSR1, lambda *_: seen.append(threading.current_thread()))
    try:
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGUSR1)).start()
        state = Scene.load("reciprocating_punch").steady(cells=97)
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert seen == [threading.main_thread()] and state.x.size == 97


def test_the_shipped_fmus_run_in_the_host(tmp_path):
    assert {"clutch", "disc_brake", "pin_on_disk"} <= set(scenes())
    schedule = host.Schedule(("sliding_velocity", "normal_load"), [0.0, 4.0], [[10.0, 4000.0], [0.0, 4000.0]], "linear")
    with host.Fmu(host.unpack(fmu("disc_brake"), tmp_path / "fmu")) as own:
        recorded = host.run_schedule(own, {}, schedule, outputs=["dissipated_energy"], step=0.004)
    inputs = {"time [s]": [0, 4], "sliding_velocity [m/s]": [10, 0], "normal_load [N]": 4000}
    native = Scene.load("disc_brake").simulate(inputs, step=0.004)["dissipated_energy"][-1]
    assert recorded[0, 0] == pytest.approx(native, rel=1e-12)
    with pytest.raises(host.Failure) as failure:
        host.Fmu(tmp_path / "nothing")
    assert failure.value.stage == "library"


OWN = 'name = "bench"\ndescription = "A pad of 60 mm"\n[experiment]\nstop = "2 s"\nstep = 0.01\n[punch]\nwidth = "60 mm"\n[solver]\nfidelity = "lumped"\n'


def test_an_fmu_of_ones_own_scene_is_that_of_the_command(tmp_path):
    """To the byte: description, slot, page, reference. And an importer runs it, with what the package itself computes."""
    fmpy = pytest.importorskip("fmpy")
    (tmp_path / "bench.toml").write_text(OWN)
    path = Scene.load(tmp_path / "bench.toml").package(tmp_path / "made" / "own.fmu")
    run = command(tmp_path, "package", "bench.toml", "-o", "commanded.fmu")
    assert run.returncode == 0, run.stderr
    assert path.read_bytes() == (tmp_path / "commanded.fmu").read_bytes()
    assert Scene.load("clutch").package(tmp_path / "clutch.fmu").read_bytes() == fmu("clutch").read_bytes()
    description = fmpy.read_model_description(path, validate=True)
    assert (description.modelName, description.description) == ("SlidingContact.bench", "A pad of 60 mm")
    changed = Scene.load(tmp_path / "bench.toml").set({"contact.friction_coefficient": 0.35}).package(path)
    assert fmpy.read_model_description(changed).guid != description.guid
    time, inputs = [0.0, 1.0], {"time [s]": [0, 1], "sliding_velocity [m/s]": 10, "normal_load [N]": 4000}
    signals = np.array([(t, 10.0, 4000.0) for t in time], dtype=[(name, float) for name in ("time", "sliding_velocity", "normal_load")])
    result = fmpy.simulate_fmu(str(changed), stop_time=1.0, step_size=0.01, output_interval=0.01, input=signals, output=["friction_force", "dissipated_energy"])
    own = Scene.load(tmp_path / "bench.toml").set({"contact.friction_coefficient": 0.35}).simulate(inputs, step=0.01)
    assert result["friction_force"][-1] == own["friction_force"][-1] == pytest.approx(2 * 0.35 * 4000)
    assert result["dissipated_energy"][-1] == pytest.approx(own["dissipated_energy"][-1], rel=1e-12)
    assert sorted(entry.name for entry in (tmp_path / "made").iterdir()) == ["own.fmu"]


def test_an_fmu_that_cannot_be_made_leaves_the_one_that_is_there(tmp_path, monkeypatch):
    path = tmp_path / "own.fmu"
    path.write_text("before")
    scene = Scene.load("disc_brake")
    (tmp_path / "folder.fmu").mkdir()
    for wrong, text in ((tmp_path / "own.zip", "must end in .fmu"), (tmp_path / "folder.fmu", "is no regular file")):
        with pytest.raises(Error, match=re.escape(text)):
            scene.package(wrong)
    with pytest.raises(Error, match=re.escape(f"writing {path / 'below.fmu'}: [Errno")):
        scene.package(path / "below.fmu")
    fmus = tmp_path / "fmus"
    fmus.mkdir()
    monkeypatch.setattr(sliding_contact.scene._native, "FMUS", fmus)
    with pytest.raises(Error, match="there is no FMU in"):
        scene.package(path)
    # One of another version, whose library has no slot.
    with zipfile.ZipFile(fmus / "other.fmu", "w") as archive:
        archive.writestr("binaries/linux64/SlidingContact.so", b"0" * 10_000)
    with pytest.raises(Error, match="the library has no scene slot"):
        scene.package(path)
    assert path.read_text() == "before" and sorted(own.name for own in tmp_path.iterdir()) == ["fmus", "folder.fmu", "own.fmu"]


def test_figures_are_drawn(tmp_path):
    pytest.importorskip("matplotlib")
    measured = {"time [s]": [0.5, 2.0], "contact_temperature [degC]": [90, 110]}
    line = Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 9}).simulate(STOP)
    for ending in ("svg", "pdf", "png"):
        line.plot(tmp_path / f"stop.{ending}", measured=measured)
    svg = (tmp_path / "stop.svg").read_text()
    assert "measured" in svg and "contact, highest" in svg and "over the contact, at the time" in svg
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


def test_an_archive_that_would_fill_the_disk_is_not_unpacked(tmp_path, monkeypatch):
    archive = tmp_path / "large.fmu"
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in ("modelDescription.xml", "resources/table"):
            packed.writestr(name, b"0" * 2**21)
    monkeypatch.setattr(host, "_MOST_BYTES", 2**22 - 1)
    with pytest.raises(Error, match=re.escape(f"{archive}: its files are 4 MB, and at most")):
        host.unpack(archive, tmp_path / "folder")
    assert list(tmp_path.iterdir()) == [archive]
    monkeypatch.setattr(host, "_MOST_BYTES", 2**22)
    assert (host.unpack(archive, tmp_path / "folder") / "resources" / "table").stat().st_size == 2**21


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


def test_a_record_that_is_no_table_is_refused_with_what_is_accepted(tmp_path):
    pytest.importorskip("matplotlib")
    result = Scene.load("disc_brake").set({"nominal.duration": "1 s"}).simulate()
    picture, sheet, latin = (tmp_path / name for name in ("record.png", "record.xlsx", "latin.csv"))
    result.plot(picture)
    sheet.write_bytes(b"PK\x03\x04\x14\x00\x06\x00")
    latin.write_bytes("time [s],contact_temperature [°C]\n0,20\n".encode("latin-1"))
    for record, told in ((picture, f"{picture} is no text; a CSV or Parquet"), (sheet, f"{sheet} is no text; a CSV or Parquet"), ([1, 2], "list is no table; accepted are CSV and Parquet")):
        for refused in (lambda: result.compare(record), lambda: result.plot(measured=record)):
            with pytest.raises(Error) as raised:
                refused()
            assert told in str(raised.value)
    assert result.compare(latin)["contact_temperature"].measured == pytest.approx([293.15])
    # A character of two bytes that the first block of a file cuts is text.
    long = tmp_path / "long.csv"
    long.write_bytes(b"#" * 4095 + "é\ntime [s],contact_temperature [degC]\n0,20\n".encode())
    assert result.compare(long)["contact_temperature"].measured == pytest.approx([293.15])


def test_what_a_frame_writes_is_read_again_and_gaps_are_no_points(tmp_path):
    pandas = pytest.importorskip("pandas")
    scene = Scene.load("disc_brake")
    result = scene.simulate(STOP)
    frame = result.frame("sliding_velocity [km/h]", "normal_load [kN]", "contact_temperature [degC]")
    frame.loc[1:3, "contact_temperature [degC]"] = np.nan
    frame.to_csv(tmp_path / "plain.csv")
    frame.to_csv(tmp_path / "comma.csv", sep=";", decimal=",", index=False)
    frame.rename(columns={"contact_temperature [degC]": "Temp. [°C]"}).to_csv(tmp_path / "latin.csv", encoding="latin-1")
    sources = [frame, tmp_path / "plain.csv", tmp_path / "comma.csv", tmp_path / "latin.csv"]
    if pytest.importorskip("pyarrow"):
        frame.to_parquet(tmp_path / "frame.parquet")
        sources.append(tmp_path / "frame.parquet")
    for table in sources:
        found = result.compare(table)["contact_temperature"]
        assert found.measured.size == len(frame) - 3 and found.root_mean_square < 1e-9, table
        again = scene.simulate(table, step=10.0)
        assert again["contact_temperature"][-1] == pytest.approx(result["contact_temperature"][-1], rel=1e-9)
    frame["Humidity [%]"] = 40.0
    with pytest.warns(SceneWarning, match='left out are "Humidity'):
        scene.simulate(frame)
    assert pandas is not None


def test_a_simulation_stays_in_its_process():
    with pytest.raises(TypeError, match="belongs to its process"):
        pickle.dumps(Scene.load("disc_brake").set({"nominal.duration": "1 s"}).simulate())
    again = pickle.loads(pickle.dumps(Scene.load("disc_brake").set({"punch.width": 0.08})))
    assert again["punch.width"] == 0.08


def test_the_version_is_that_of_the_sources():
    assert f'version = "{sliding_contact.__version__}"' in (ROOT / "Cargo.toml").read_text()


def test_records_of_wear_are_read_in_any_unit(tmp_path):
    si, other = tmp_path / "si.csv", tmp_path / "other.csv"
    si.write_text("load_N,speed_m_per_s,distance_m,volume_mm3\n10,0.1,1000,0.5\n20,0.2,2000,1.5\n")
    other.write_text("# bench\nvolume [m3],distance [km],load [kN],speed [mm/s]\n5e-10,1,0.01,100\n1.5e-9,2,0.02,200\n")
    first, second = fit.Records.read(si), fit.Records.read(other)
    for name in ("load", "speed", "distance", "volume"):
        assert getattr(first, name) == pytest.approx(getattr(second, name), rel=1e-14), name
    assert first.volume == pytest.approx([5e-10, 1.5e-9])
    for text, told in (
        ("load [N],speed [m/s],distance [m],volume [kg]\n1,1,1,1\n", 'line 1, column 4: "volume [kg]": "kg" is the wrong unit; accepted are m3'),
        ("load [N],speed [m/s],distance [m],volume\n1,1,1,1\n", "does not say its unit; accepted is volume [m3 or mm3 or cm3]"),
        ("load [N],speed [m/s],distance [m],volume [mm3]\n1,1,1\n", "line 2: 3 cells, and the header has 4"),
        ("load [N],speed [m/s],distance [m],volume [mm3]\n1,nan,1,1\n", 'line 2, column 2 (speed [m/s]): "nan"'),
        ("load [N],load_N,distance [m],volume [mm3]\n1,1,1,1\n", "load stands in column 1 already"),
        ("load [N],speed [m/s],distance [m],volume [mm3]\n", "has no row below its header"),
    ):
        si.write_text(text)
        with pytest.raises(Error, match=re.escape(told)):
            fit.Records.read(si)


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


def test_a_fit_runs_the_scene_as_it_is():
    parameters = {fit.COEFFICIENT: 1.2e-14, fit.PRESSURE_EXPONENT: 1.3}
    for settings in ({"solver.fidelity": "lumped"}, {"solver.fidelity": "line", "solver.cells": 5, "solver.tolerance": 1e-2}):
        scene = Scene.load("pin_on_disk").set(settings)
        model = fit.Model(scene, TESTS)
        own = scene.copy().set(parameters)
        for load, volume in zip(TESTS.load, model.predict(parameters)):
            run = own.simulate({"time [s]": [0, 1e4], "sliding_velocity [m/s]": 0.1, "normal_load [N]": load}, step=200.0)
            assert volume == run["wear_volume_punch"][-1], settings
        assert settings["solver.fidelity"] in str(model)
