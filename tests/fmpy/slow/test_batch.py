"""The native host against fmpy, state after a failed scene, and the command `batch`: killed, resumed, refused."""

import csv
import itertools
import json
import os
import signal
import subprocess

import numpy as np
import pytest

from conftest import ROOT, file_of
from component import Component
from batches import INPUTS, brake, clean_environment, cycle, host, needed, wait_for  # noqa: F401

OUTPUTS = ("wear_depth", "contact_temperature", "friction_force", "dissipated_energy", "limit_reached")


def run(fmu, cycle, parameters=None, **more):
    return host.run_schedule(fmu, parameters or {}, cycle, outputs=OUTPUTS, step=0.1, **more)


@pytest.mark.parametrize("interpolation", host.INTERPOLATIONS)
def test_the_host_gives_the_trajectory_of_fmpy(fmus, brake, cycle, interpolation):
    parameters = {"punch.width": 0.09, "contact.faces": 1, "contact.shear_coupling": 0}
    points = np.arange(0.0, 240.5, 2.0)
    # Away from 0, where a rounding of the inputs would decide on which side a step ends.
    cycle = host.Schedule(INPUTS, cycle.times, cycle.values + np.array([1.0, 50.0]))
    own = host.Schedule(INPUTS, cycle.times, cycle.values, interpolation)
    found = run(brake, own, parameters, points=points, factors={"normal_load": 1.25})
    step = 0.1
    at = np.arange(2401) / 10.0
    held = np.searchsorted(cycle.times, at + 1e-9, side="right") - 1
    load = np.array([1.0, 1.25])
    given = load * cycle.values[held]
    if interpolation != "hold":
        given = load * np.column_stack([np.interp(at, cycle.times, column) for column in cycle.values.T])
    with Component(fmus("disc_brake")) as component:
        component.initialise(parameters, stop=240.0, **dict(zip(INPUTS, given[0])))
        expected = [component.get(*OUTPUTS[:4])]
        for index in range(2400):
            component.set(dict(zip(INPUTS, given[index])))
            slopes = (given[index + 1] - given[index]) / step
            if interpolation == "linear" and np.any(slopes):
                for name, slope in zip(INPUTS, slopes):
                    component.set_input_derivative(name, slope)
            component.step(step)
            if (index + 1) % 20 == 0:
                expected.append(component.get(*OUTPUTS[:4]))
    spread = np.ptp(expected, axis=0)
    assert np.all(spread > 0.0)
    # Parts of the range, and a few roundings of the value itself.
    assert np.all(np.abs(found[:, :4] - expected) <= 1e-12 * spread + 1e-14 * np.abs(expected))


@pytest.mark.parametrize(
    "stage, change",
    [
        ("request", {"parameters": {"punch.widht": 0.1}}),
        ("request", {"parameters": {"punch.width": float("nan")}}),
        ("request", {"points": [0.05]}),
        ("initialisation", {"parameters": {"punch.width": -0.1}}),
        ("initialisation", {"parameters": {"punch.conductivity": 0.0, "strip.conductivity": 0.0, "strip.property_table.points": 0.0}}),
        ("stepping", {"factors": {"sliding_velocity": 1e308}}),
    ],
)
def test_a_scene_that_fails_says_why_and_leaves_no_trace(brake, cycle, stage, change):
    before = run(brake, cycle)
    with pytest.raises(host.Failure) as failure:
        run(brake, cycle, **change)
    assert failure.value.stage == stage
    named = {"punch.widht": "did you mean punch.width", "points": "0.05 s", "factors": "sliding_velocity", "strip.property_table.points": ""}
    for name in (*change, *change.get("parameters", {})):
        assert named.get(name, "" if name == "parameters" else name) in failure.value.reason
    assert np.array_equal(run(brake, cycle), before)


def test_a_wrong_guid_is_refused_when_opening(fmus, tmp_path):
    folder = host.unpack(file_of("disc_brake"), tmp_path / "fmu")
    description = folder / "modelDescription.xml"
    guid = fmus("disc_brake").description.guid
    description.write_text(description.read_text().replace(guid, "{00000000-0000-0000-0000-000000000000}"))
    with pytest.raises(host.Failure, match="GUID"):
        host.Fmu(folder)


def test_a_table_is_widened_and_written_as_parquet(tmp_path, cycle):
    command = needed("SLIDING_CONTACT_COMMAND")
    inputs, table, output = tmp_path / "inputs.csv", tmp_path / "design.csv", tmp_path / "out.parquet"
    inputs.write_text("time,sliding_velocity [m/s],normal_load [N]\n0,8,2000\n2,0,2000\n")
    arguments = [command, "batch", str(table), "--fmu", str(file_of("disc_brake")), "--inputs", str(inputs), "-o", str(output)]
    environment = {**clean_environment(), "CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")}

    def run(widths, *more):
        table.write_text("punch.width\n" + "".join(f"{width}\n" for width in widths))
        done = subprocess.run([*arguments, "--jobs", "1", *more], capture_output=True, text=True, env=environment)
        return done.returncode, done.stdout + done.stderr

    status, printed = run([0.08, 0.09, -1])
    assert status == 0 and "3 run now" in printed and "1 x" in printed and "line 4, column 1 (punch.width): -1 m" in printed
    with open(tmp_path / "out.csv", newline="") as file:
        first = list(csv.DictReader(file))
    status, printed = run([0.08, 0.09, -1, 0.1, 0.11])
    assert status == 0 and "5 scenes, 1 failed; 2 run now" in printed
    with open(tmp_path / "out.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows[:3] == first and len(rows) == 5
    assert parquet(output) == rows
    # A row that has changed is run again, but not without being told.
    status, printed = run([0.08, 0.095, -1, 0.1, 0.11])
    assert status != 0 and "the first of scene 1" in printed and "--replace" in printed
    assert "1 run now" in run([0.08, 0.095, -1, 0.1, 0.11], "--replace")[1]
    status, printed = run([-1, -2], "--replace")
    assert status != 0 and "1 x" in printed
    assert [row["status"] for row in parquet(output)] == ["request"] * 2


def parquet(path):
    """Rows of a Parquet file as another reader has them, with its values as they stand in the CSV."""
    code = "import json, sys, pyarrow.parquet as p; print(json.dumps(p.read_table(sys.argv[1]).to_pylist()))"
    read = subprocess.run([needed("SLIDING_CONTACT_BATCH_PYTHON"), "-c", code, str(path)], check=True, capture_output=True)
    texts = [row for row in csv.DictReader(open(path.with_suffix(".csv"), newline=""))]
    rows = json.loads(read.stdout)
    for row, text in zip(rows, texts, strict=True):
        for name, value in row.items():
            written = text[name]
            own = "" if value is None else written if not isinstance(value, str) and float(written) == value else value
            assert own == written, (name, value, written)
    return texts


def test_the_command_continues_where_it_was_killed(tmp_path, brake, cycle):
    command = needed("SLIDING_CONTACT_COMMAND")
    inputs, table, output = tmp_path / "inputs.csv", tmp_path / "design.csv", tmp_path / "out.csv"
    with open(inputs, "w", newline="") as file:
        writer = csv.writer(file)
        units = {"sliding_velocity": "m/s", "normal_load": "N"}
        writer.writerow(["time [s]", *(f"{name} [{units[name]}]" for name in cycle.inputs)])
        writer.writerows([time, *values] for time, values in zip(cycle.times.tolist(), cycle.values.tolist()))
    widths = np.linspace(0.08, 0.11, 1000)
    widths[7] = -1.0
    table.write_text("punch.width,contact.geometry,normal_load.factor\n" + "".join(f"{width!r},line,1.25\n" for width in widths.tolist()))
    arguments = [command, "batch", str(table), "--fmu", str(file_of("disc_brake")), "--inputs", str(inputs), "-o", str(output)]
    arguments += ["--jobs", "2", "--step", "0.02", "--interpolation", "hold", "--record", ",".join(OUTPUTS), "--every", "1", "--json"]
    partial = tmp_path / "out.csv.partial"
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    wait_for(lambda: partial.is_file() and partial.read_bytes().count(b"\n") > 20, process)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    there = partial.read_bytes().count(b"\n") - 1
    assert 20 <= there < 1000 and not output.exists()
    summary = json.loads(subprocess.run(arguments, check=True, capture_output=True, text=True).stdout)
    assert (summary["scenes"], summary["failed"], summary["ran_now"]) == (1000, 1, 1000 - there)
    assert not partial.exists()
    with open(output, newline="") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["scene"]) for row in rows] == list(range(1000))
    assert rows[7]["status"] == "request" and "line 9, column 1 (punch.width): -1 m" in rows[7]["reason"] and rows[7]["wear_depth [m]"] == ""
    for scene, points in itertools.product((0, 999), (np.arange(0.0, 240.5, 1.0),)):
        expected = host.run_schedule(
            brake,
            {"punch.width": widths[scene]},
            cycle,
            factors={"normal_load": 1.25},
            outputs=[*OUTPUTS, "contact_temperature_max"],
            step=0.02,
            points=points,
        )
        headers = ["wear_depth [m]", "contact_temperature [K]", "friction_force [N]", "dissipated_energy [J]", "limit_reached"]
        assert [float(rows[scene][name]) for name in headers] == expected[-1, :-1].tolist()
        assert float(rows[scene]["contact_temperature_max.peak [K]"]) == expected[:, -1].max()


def batch(tmp_path, inputs, design):
    """A batch of the disc brake from texts: the finished process, and its rows where there are any. Without inputs: nominal ones."""
    for name, text in (("inputs.csv", inputs), ("design.csv", design)):
        if text:
            (tmp_path / name).write_text(text)
    output = tmp_path / "out.csv"
    command = [needed("SLIDING_CONTACT_COMMAND"), "batch", str(tmp_path / "design.csv"), "--fmu", str(file_of("disc_brake"))]
    command += [*(["--inputs", str(tmp_path / "inputs.csv")] if inputs else []), "-o", str(output), "--jobs", "1", "--json", "--replace"]
    done = subprocess.run(command, capture_output=True, text=True)
    if not output.is_file():
        return done, []
    with open(output, newline="") as file:
        return done, list(csv.DictReader(file))


def test_a_batch_in_which_every_scene_fails_fails(tmp_path):
    inputs = "time,sliding_velocity [m/s],normal_load [N]\n0,1,100\n1,1,100\n"
    done, rows = batch(tmp_path, inputs, "punch.width\n-1\n-2\n")
    assert done.returncode != 0 and "every one of the 2 scenes failed" in done.stderr
    assert json.loads(done.stdout)["failed"] == 2 and len(rows) == 2
    done, rows = batch(tmp_path, inputs, "punch.width\n-1\n0.1\n")
    assert done.returncode == 0 and [row["status"] for row in rows] == ["request", "ok"]
    assert "design.csv, line 2, column 1 (punch.width): -1 m is outside the allowed range: from " in rows[0]["reason"]


def test_inputs_are_linear_between_their_rows_as_in_simulate(tmp_path):
    # Speed falling from 10 m/s, load rising to 5 kN on two faces, friction coefficient 0.4: held rows would carry no
    # load.
    done, rows = batch(tmp_path, "time [s],sliding_velocity [m/s],normal_load [N]\n0,10,0\n1,0,5000\n", "punch.width [mm]\n95\n")
    assert done.returncode == 0
    assert float(rows[0]["dissipated_energy [J]"]) == pytest.approx(2 * 0.4 * 5e4 / 6, rel=0.01)


def test_without_inputs_every_scene_runs_at_its_own_nominal_conditions(tmp_path):
    design = "nominal.duration [s],nominal.load [kN],normal_load.factor\n60,1,1\n60,2,1\n30,1,2\n60,1,-1\n60,1,50 %\n"
    done, rows = batch(tmp_path, None, design)
    assert done.returncode == 0, done.stderr
    work = [float(row["dissipated_energy [J]"] or 0) for row in rows]
    assert work[0] > 0.0
    assert work[1] == pytest.approx(2 * work[0], rel=0.02) and work[2] == pytest.approx(work[0], rel=0.02)
    assert rows[3]["status"] == "request" and "(normal_load.factor): -1 must be 0 or above" in rows[3]["reason"]
    assert work[4] == pytest.approx(0.5 * work[0], rel=0.02)


def test_results_of_another_batch_stay(tmp_path):
    inputs, table, output = tmp_path / "inputs.csv", tmp_path / "design.csv", tmp_path / "out.csv"
    inputs.write_text("time,sliding_velocity [m/s],normal_load [N]\n0,1,100\n1,1,100\n")
    table.write_text("punch.width\n0.1\n")
    command = [needed("SLIDING_CONTACT_COMMAND"), "batch", str(table), "--fmu", str(file_of("disc_brake")), "-o", str(output)]
    run = lambda *more: subprocess.run([*command, *more], capture_output=True, text=True)  # noqa: E731
    assert run("--inputs", str(inputs)).returncode == 0
    there = output.read_bytes()
    for more, differs in ((["--inputs", str(inputs), "--record", "wear_depth"], "outputs"), ([], "inputs")):
        refused = run(*more)
        assert refused.returncode != 0 and f"{differs} differ" in refused.stderr and "--replace" in refused.stderr, refused.stderr
        assert output.read_bytes() == there
    # The same command finds its rows, and another one replaces them where it is told to.
    assert "0 run now" in run("--inputs", str(inputs)).stdout
    assert run("--inputs", str(inputs), "--record", "wear_depth", "--replace").returncode == 0
    assert output.read_bytes() != there
    # Results of rows that are gone or have other cells stay too.
    table.write_text("punch.width\n0.1\n0.11\n")
    assert run("--inputs", str(inputs), "--record", "wear_depth").returncode == 0
    there = output.read_bytes()
    for text in ("punch.width\n0.1\n", "punch.width\n0.1\n0.12\n"):
        table.write_text(text)
        refused = run("--inputs", str(inputs), "--record", "wear_depth")
        assert refused.returncode != 0 and "the first of scene 1" in refused.stderr and "--replace" in refused.stderr, refused.stderr
        assert output.read_bytes() == there
    assert "1 run now" in run("--inputs", str(inputs), "--record", "wear_depth", "--replace").stdout
    (tmp_path / "out.csv.batch").unlink()
    assert "no result of a batch" in run("--inputs", str(inputs)).stderr


def test_inputs_are_read_by_name_and_converted(tmp_path):
    design = "punch.width\n0.1\n"
    si, rows = batch(tmp_path, "time,sliding_velocity [m/s],normal_load [N]\n0,2,1000\n60,2,1000\n", design)
    converted, same = batch(tmp_path, "normal_load [kN],sliding_velocity_km_per_h,time [min]\n1,7.2,0\n1,7.2,1\n", design)
    assert si.returncode == converted.returncode == 0 and si.stderr == ""
    assert rows == same and float(rows[0]["dissipated_energy [J]"]) > 0.0
    for header in ("time,sliding_velocity [mph],normal_load", "time,speed,normal_load", "number,sliding_velocity,normal_load"):
        done, _ = batch(tmp_path, f"{header}\n0,2,1000\n60,2,1000\n", design)
        assert done.returncode != 0 and "inputs.csv, line 1" in done.stderr, done.stderr
    bare, _ = batch(tmp_path, "time,sliding_velocity [m/s],normal_load\n0,2,1000\n60,2,1000\n", design)
    assert "\"normal_load\" does not say its unit; accepted is normal_load [N" in bare.stderr
    lifted, _ = batch(tmp_path, "time,sliding_velocity [m/s],normal_load [N]\n0,2,1000\n60,2,-1000\n", design)
    assert "normal_load = -1000 N at 60 s is below 0 N and counts as 0" in lifted.stderr
    fast, _ = batch(tmp_path, "time,sliding_velocity [m/s],normal_load [N]\n0,97,1000\n1,97,1000\n", design)
    assert "sliding_velocity goes to 97 m/s, more than 10 times nominal.velocity = 3.8" in fast.stderr
    driven, _ = batch(tmp_path, "time,sliding_velocity [m/s],normal_load [N]\n0,2,1000\n1,2,1000\n", "nominal.load\n100\n")
    assert "nominal.load changes how levels are chosen" in driven.stderr and "normal_load.factor multiplies" in driven.stderr
