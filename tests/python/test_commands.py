"""The command `sliding-contact`: one table of commands, whose results and refusals are those of `Scene`."""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from conftest import STOP
from sliding_contact import Error, Scene, _commands, scenes

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def ran(folder, *arguments):
    return subprocess.run([sys.executable, "-m", "sliding_contact", *arguments], cwd=folder, capture_output=True, text=True)


def test_results_are_those_of_the_scene(tmp_path, stop_csv):
    run = ran(tmp_path, "simulate", "disc_brake", "-s", "punch.width=80 mm", "-i", "stop.csv", "--step", "20 ms", "-o", "out.csv")
    assert run.returncode == 0, run.stderr
    own = Scene.load("disc_brake").set({"punch.width": "80 mm"}).simulate(STOP, step="20 ms")
    with open(tmp_path / "out.csv", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["time [s]", *(f"{name} [{unit}]" for name, unit in own.units.items())]
    table = np.array(rows, dtype=float).T
    assert np.array_equal(table[0], own.time) and all(np.array_equal(column, own[name]) for column, name in zip(table[1:], own))
    printed, expected = ([line for line in text.splitlines() if not line.startswith(("cost", "inputs"))] for text in (run.stdout, str(own)))
    assert printed == expected
    # What it writes is a record, which the same run meets.
    run = ran(tmp_path, "simulate", "disc_brake", "-s", "punch.width=80 mm", "-i", "stop.csv", "--step", "20 ms", "-m", "out.csv")
    assert re.search("deviation of friction_force +root mean square 0 N ", run.stdout), run.stdout + run.stderr
    # One file of a rig, with names of its own, is inputs and record.
    (tmp_path / "rig.csv").write_text("t [s];v [m/s];Load [N];Temp. [°C];Note\n0;10;4000;20;a\n1;10;4000;90;\n2;0;4000;;b\n", encoding="latin-1")
    rig = ["simulate", "disc_brake", "-i", "rig.csv", "-m", "rig.csv", "--column", "v=sliding_velocity"]
    run = ran(tmp_path, *rig)
    assert "deviation of contact_temperature " in run.stdout and "; 2 points" in run.stdout and "deviation of normal_load" not in run.stdout, run.stdout + run.stderr
    told = run.stderr.splitlines()
    assert told[0].startswith('note: rig.csv: read are "t [s]" as time'), told
    assert told[1] == 'note: rig.csv: left out are "Note"; --column "HEADER=VARIABLE" names a quantity', told
    run = ran(tmp_path, *rig, "--strict")
    assert run.returncode == 1 and '"Note" is not a known quantity' in run.stderr
    punch = Scene.load("reciprocating_punch")
    for arguments, result in (
        (["steady", "reciprocating_punch", "--cells", "17", "--cold"], punch.steady(cells=17, cold=True)),
        (["cycles", "reciprocating_punch", "--cells", "9", "--cycles", "1000", "--cold"], punch.cycles(1000, cells=9, cold=True)),
        (["plan", "reciprocating_punch", "--tolerance", "0.1"], punch.plan(tolerance=0.1)),
    ):
        assert ran(tmp_path, *arguments).stdout.rstrip() == str(result), arguments
        assert json.loads(ran(tmp_path, *arguments, "--json").stdout) == result.record, arguments


def test_a_fit_is_that_of_the_scene(tmp_path):
    pytest.importorskip("scipy")
    tests = [(5, 1.0e-1), (5, 1.1e-1), (10, 2.1e-1), (10, 2.3e-1), (20, 4.3e-1), (20, 4.5e-1)]
    rows = "".join(f"{load},0.1,1000,{volume}\n" for load, volume in tests)
    (tmp_path / "tests.csv").write_text("load [N],speed [m/s],distance [m],volume [mm3]\n" + rows)
    arguments = ["tests.csv", "--set", "solver.fidelity=lumped", "--parameters", "punch.wear_coefficient"]
    run = ran(tmp_path, "fit", *arguments)
    assert run.returncode == 0, run.stderr
    own = Scene.load("pin_on_disk").set({"solver.fidelity": "lumped"}).fit(tmp_path / "tests.csv", ["punch.wear_coefficient"])
    assert run.stdout.rstrip() == str(own).rstrip() and "punch.wear_coefficient" in run.stdout
    run = ran(tmp_path, "fit", *arguments, "--confidence", "95")
    assert run.returncode == 1 and "confidence = 95" in run.stderr and "Traceback" not in run.stderr


def test_progress_is_a_line_a_minute_where_there_is_no_terminal(monkeypatch, capsys):
    now = [0.0]
    monkeypatch.setattr(_commands, "time", SimpleNamespace(monotonic=lambda: now[0]))
    with _commands.Progress() as progress:
        for now[0] in range(130):
            progress(now[0] / 130)
    assert capsys.readouterr().err == "1 %\n47 %\n93 %\n"


def test_an_fmu_in_one_line(tmp_path):
    pytest.importorskip("fmpy")
    run = ran(tmp_path, "package", "disc_brake", "--set", "punch.width=80 mm")
    assert run.returncode == 0, run.stderr
    assert run.stdout == "SlidingContact.disc_brake.fmu\n"
    made = Scene.load("disc_brake").set({"punch.width": "80 mm"}).package(tmp_path / "own.fmu")
    assert made.read_bytes() == (tmp_path / "SlidingContact.disc_brake.fmu").read_bytes()


@pytest.mark.parametrize(
    "arguments, text",
    [
        (["simulate", "disc_break"], "there is no scene"),
        (["simulate", "disc_brake", "--at=-1"], "at = -1 s is outside of the simulated time"),
        (["simulate", "disc_brake", "--step", "5 kN"], "step = '5 kN': \"5 kN\" has the wrong unit"),
        (["simulate", "disc_brake", "-o", "out.xlsx"], "output = 'out.xlsx' must end in .csv"),
        (["cycles", "reciprocating_punch", "--cycles", "ten"], "cycles = 'ten' must be a finite number"),
        (["cycles", "reciprocating_punch", "--tolerance", "7"], "tolerance = 7 must be from 1e-6 to 0.1"),
        (["steady", "disc_brake", "--cells", "9.5"], "cells = '9.5' must be a whole number"),
        (["steady", "reciprocating_punch", "--return-speed=-1"], "return_speed = -1 m/s must be above 0 m/s"),
        (["package", "disc_brake", "-o", "own.zip"], "must end in .fmu"),
    ],
)
def test_refusals_are_one_line_in_the_words_of_the_scene(tmp_path, arguments, text):
    run = ran(tmp_path, *arguments)
    assert (run.returncode, run.stdout) == (1, ""), run
    errors = [line for line in run.stderr.splitlines() if line.startswith("error: ")]
    assert len(errors) == 1 and text in errors[0] and " --" not in errors[0], run.stderr
    assert "Traceback" not in run.stderr and list(tmp_path.iterdir()) == []


def test_a_file_that_is_read_is_not_replaced(tmp_path, stop_csv):
    own = tmp_path / "own.csv"
    own.write_bytes(stop_csv.read_bytes())
    for option in ("--inputs", "--measured"):
        run = ran(tmp_path, "simulate", "disc_brake", option, "own.csv", "-o", "./own.csv")
        assert run.returncode == 1 and "output = './own.csv' would replace a file that is read" in run.stderr, run
        assert own.read_bytes() == stop_csv.read_bytes()


def test_a_plan_without_a_level_prints_what_was_measured(tmp_path, stop_csv):
    run = ran(tmp_path, "plan", "disc_brake", "--inputs", str(stop_csv), "--tolerance", "1e-6")
    assert run.returncode == 1 and "no level meets the tolerance 1e-6" in run.stderr and "129 cells" in run.stdout, run
    levels = Scene.load("disc_brake").plan(STOP, tolerance=1e-6)
    assert levels.level is None and len(levels.frame()) >= 5
    with pytest.raises(Error, match="no level meets"):
        levels.settings


def test_help_completion_and_manual_know_every_command_and_option(tmp_path):
    helped = ran(tmp_path, "--help").stdout
    page = ran(tmp_path, "man").stdout.replace("\\-", "-")
    scripts = {shell: _commands.completion(shell) for shell in _commands.SHELLS}
    for command in _commands.COMMANDS:
        assert re.search(rf"^    {command.name}\b", helped, re.MULTILINE)
        own = ran(tmp_path, command.name, "--help").stdout
        section = page.split(f"\n.SS {command.name}\n")[1].split("\n.SS ")[0]
        shown = {flag for flags in re.findall(r"\\fB(.*?)\\fR", section) for flag in flags.split(", ")}
        for flag in (flag for option in command.options for flag in option.flags):
            assert flag in own and flag in shown, (command.name, flag)
            if flag.startswith("--"):
                assert all((flag if shell != "fish" else f"-l {flag[2:]} ") in script for shell, script in scripts.items()), flag
    bash = shutil.which("bash")
    if bash is None:
        pytest.skip("bash is not there")

    def completed(*words):
        place = f"COMP_WORDS=(sliding-contact {' '.join(words)}); COMP_CWORD={len(words)}; _sliding_contact; echo ${{COMPREPLY[@]}}"
        return subprocess.run([bash, "-c", f"{scripts['bash']}\n{place}"], cwd=tmp_path, capture_output=True, text=True, env=os.environ).stdout.split()

    (tmp_path / "my_scene.toml").write_text("")
    assert completed("sim") == ["simulate"] and completed("simulate", "--in") == ["--inputs"]
    assert completed("plan", "reci") == ["reciprocating_punch"] and completed("package", "my") == ["my_scene.toml"]
    assert set(completed("steady", "''")) >= set(scenes()) and completed("completion", "z") == ["zsh"]


def test_a_reader_that_ends_ends_the_command(tmp_path):
    command = [sys.executable, "-m", "sliding_contact", "steady", "reciprocating_punch", "--cells", "9", "--cold", "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        run.stdout.close()
        assert (run.stderr.read(), run.wait()) == ("", _commands.NOT_READ)
