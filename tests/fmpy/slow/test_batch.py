"""Batches: the native host against fmpy, state after a failed scene, runs that are killed and resumed."""

import csv
import itertools
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from conftest import ROOT, file_of
from component import Component

BATCH = ROOT / "examples" / "batch"
sys.path.insert(0, str(BATCH))

# `cargo fmu test --slow` puts the Python package on the path.
pytest.importorskip("sliding_contact")

import design as designs  # noqa: E402
import schedules  # noqa: E402
from sliding_contact import Scene, host  # noqa: E402

INPUTS = ("sliding_velocity", "normal_load")
OUTPUTS = ("wear_depth", "contact_temperature", "friction_force", "dissipated_energy", "limit_reached")


def needed(variable):
    path = os.environ.get(variable)
    if path is None:
        pytest.skip(f"{variable} is not set: `cargo fmu test --slow` sets it")
    return path


@pytest.fixture(scope="module")
def brake(fmus):
    with host.Fmu(fmus("disc_brake").folder) as fmu:
        yield fmu


@pytest.fixture(scope="module")
def cycle():
    """The first 240 s of the UDDS, a row per second."""
    schedule, *_ = schedules.of_name("udds", Scene.load("disc_brake"))
    return host.Schedule(INPUTS, schedule.times[:241], schedule.values[:241])


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


# Runs of whole batches, in processes of their own.


def sweep(folder, *more):
    command = [needed("SLIDING_CONTACT_BATCH_PYTHON"), str(BATCH / "sweep.py")]
    command += ["--fmu", str(file_of("disc_brake"))]
    command += ["--output", str(folder), "--workers", "2", "--no-plots", "--json", *more]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True, env=clean_environment()
    )


def clean_environment():
    return {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}


def finish(process):
    out, error = process.communicate(timeout=120)
    assert process.returncode == 0, error
    return json.loads(out)


def rows_of(folder):
    """All rows of a batch, as its own environment reads them."""
    code = "import json, sys, parts; print(json.dumps(parts.read_all(sys.argv[1])[0].to_dict(orient='records')))"
    command = [needed("SLIDING_CONTACT_BATCH_PYTHON"), "-c", code, str(folder / "parts")]
    return json.loads(subprocess.run(command, cwd=BATCH, env=clean_environment(), check=True, capture_output=True).stdout)


def parts_of(folder):
    return {path.name: path.stat() for path in (folder / "parts").glob("part-*.parquet")}


def wait_for(condition, process):
    end = time.monotonic() + 60.0
    while not condition():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end, "nothing happened for a minute"
        time.sleep(0.01)


def workers_of(parent):
    """Process numbers of the run's Dask workers: spawned by the nannies within its own process."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            status = (folder / "stat").read_text()
            command = (folder / "cmdline").read_text()
        except OSError:
            continue
        if int(status.rsplit(")", 1)[1].split()[1]) == parent and "spawn_main" in command:
            found.append(int(folder.name))
    return found


def test_a_batch_that_is_killed_loses_nothing_and_repeats_nothing(brake, tmp_path):
    if not sys.platform.startswith("linux"):
        pytest.skip("worker processes are found in /proc")
    table = tmp_path / "design.csv"
    # A quarter of the scenes sets a negative friction coefficient.
    name = "contact.friction_coefficient"
    table.write_text(f"name,distribution,low,high\n{name},uniform,-0.1,0.3\nnormal_load.factor,uniform,0.5,1.5\n")
    more = ("--design", str(table), "--scenes", "64", "--block", "4", "--schedule", "stops", "--step", "0.01", "--every", "10")
    broken = tmp_path / "broken"
    process = sweep(broken, *more)
    try:
        wait_for(lambda: len(parts_of(broken)) >= 2, process)
        os.kill(workers_of(process.pid)[0], signal.SIGKILL)
        wait_for(lambda: len(parts_of(broken)) >= 6, process)
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
    before = parts_of(broken)
    assert 6 <= len(before) < 16, "it was killed in the middle"
    summary = finish(sweep(broken, *more))
    assert summary["ran_now"] == 64 - 4 * len(before)
    after = parts_of(broken)
    assert all(after[name].st_ino == stat.st_ino and after[name].st_mtime_ns == stat.st_mtime_ns for name, stat in before.items())
    rows = rows_of(broken)
    assert [row["scene"] for row in rows] == list(range(64))
    assert summary["failed"] == sum(row["status"] != "ok" for row in rows) == sum(row[name] < 0 for row in rows) == 16
    # Every row, from whichever process it came, is what the scene gives by itself.
    stops, *_ = schedules.of_name("stops", Scene.load("disc_brake"))
    for row, (friction, factor) in zip(rows, designs.Design.read(table, 64, 1).rows()):
        assert (row[name], row["normal_load.factor"]) == (friction, factor)
        if friction < 0:
            assert row["status"] == "initialisation" and name in row["reason"] and np.isnan(row["wear_depth_punch"])
            continue
        points = np.append(np.arange(0.0, stops.times[-1], 10.0), stops.times[-1])
        outputs = ["wear_depth_punch", "contact_temperature_max"]
        expected = host.run_schedule(
            brake, {name: friction}, stops, factors={"normal_load": factor}, outputs=outputs, step=0.01, points=points
        )
        assert row["wear_depth_punch"] == expected[-1, 0]
        assert row["contact_temperature_max.peak"] == expected[:, 1].max()
    # Once more: all is there.
    assert finish(sweep(broken, *more))["ran_now"] == 0
    # Another batch must not be mixed in; the message says what is another.
    wide = str(tmp_path / "wide.csv")
    Path(wide).write_text(table.read_text().replace("1.5", "1.6"))
    for change, told in (
        (("--seed", "2"), "seed = 1 instead of 2"),
        (("--step", "0.02"), "step = 0.01 instead of 0.02"),
        (("--interpolation", "linear"), "interpolation = hold instead of linear"),
        (("--schedule", "udds"), "instead of 1370 rows to 1369 s, sha256"),
        (("--design", wide), "design of normal_load.factor = uniform, low 0.5, high 1.5 instead of uniform, low 0.5, high 1.6"),
        (("--fmu", str(file_of(None))), "FMU = sha256 "),
    ):
        _, error = sweep(broken, *more, *change).communicate(timeout=60)
        assert f"error: {broken} holds another batch: " in error and told in error and "name another --output" in error, error
        assert error.count(" instead of ") == 1 or change[0] == "--fmu", error


def test_a_batch_is_widened_and_says_what_failed(tmp_path):
    table, folder = tmp_path / "design.csv", tmp_path / "wide"
    table.write_text("name,distribution,low,high\npunch.width,uniform,80 mm,110 mm\n")
    more = ("--design", str(table), "--schedule", "stops", "--step", "0.1", "--every", "100")
    assert finish(sweep(folder, *more, "--scenes", "10", "--block", "4"))["ran_now"] == 10
    before = parts_of(folder)
    first = rows_of(folder)
    # Another block size too: nothing is done again, and the scenes stay what they were.
    assert finish(sweep(folder, *more, "--scenes", "23", "--block", "5"))["ran_now"] == 13
    after = parts_of(folder)
    assert all(after[name].st_ino == stat.st_ino and after[name].st_mtime_ns == stat.st_mtime_ns for name, stat in before.items())
    rows = rows_of(folder)
    assert [row["scene"] for row in rows] == list(range(23)) and rows[:10] == first
    # And narrowed again.
    assert finish(sweep(folder, *more, "--scenes", "7"))["scenes"] == 7
    # Where every scene fails, the status says so and the reason stands on the screen.
    table.write_text("name,distribution,low,high\npunch.width,uniform,-0.2,-0.1\n")
    for arguments in ((), ("--json",)):
        process = sweep(tmp_path / "failed", *more, "--scenes", "6", *arguments)
        out, error = process.communicate(timeout=120)
        assert process.returncode != 0 and "every one of the 6 scenes failed" in error and "punch.width" in out + error
    out, error = sweep(tmp_path / "one", *more, "--scenes", "1").communicate(timeout=120)
    assert "the one scene failed" in error


def test_inputs_of_a_file_take_the_steps_of_simulate_and_every_scene_shows(tmp_path):
    table, inputs = tmp_path / "design.csv", tmp_path / "inputs.csv"
    table.write_text("name,distribution,low,high\nnormal_load.factor,uniform,0.5,1.5\n")
    inputs.write_text("time [s],sliding_velocity [mm/s],normal_load [N]\n0,100,10\n0.7,100,20\n1000,100,10\n")
    _, step, _ = schedules.of_name(str(inputs), Scene.load("pin_on_disk"))
    assert step == pytest.approx(0.07, rel=1e-3), "the load doubles within 0.7 s"
    inputs.write_text("time [s],sliding_velocity [mm/s],normal_load [N]\n0,100,10\n1000,100,10\n")
    assert schedules.of_name(str(inputs), Scene.load("pin_on_disk"))[1] == 1.0, "a thousandth"
    more = ("--scene", "pin_on_disk", "--design", str(table), "--schedule", str(inputs), "--scenes", "3")
    assert finish(sweep(tmp_path / "pins", *more))["failed"] == 0
    assert len(parts_of(tmp_path / "pins")) == 3, "a task for every scene where they are few"


def test_a_sweep_of_any_scene_is_what_its_own_fmu_gives(fmus, tmp_path):
    """The FMU of another scene runs it, with the values of the scene as parameters."""
    table, scene = tmp_path / "design.csv", tmp_path / "mine.toml"
    name = "contact.friction_coefficient"
    table.write_text(f"name,distribution,mean,standard_deviation,low,high\n{name},normal,0.5,0.02,,\npunch.width,uniform,,,5 mm,6 mm\n")
    shipped = (ROOT / "examples" / "pin_on_disk" / "scene.toml").read_text()
    scene.write_text(shipped.replace('name = "pin_on_disk"', 'name = "mine"'))
    assert "mine" in scene.read_text()
    own = Scene.load("pin_on_disk")
    schedule, step, _ = schedules.of_name("nominal", own)
    with host.Fmu(fmus("pin_on_disk").folder) as pin:
        for given in ("pin_on_disk", str(scene)):
            folder = tmp_path / Path(given).stem
            more = ("--scene", given, "--design", str(table), "--scenes", "3")
            assert finish(sweep(folder, *more))["failed"] == 0
            rows = rows_of(folder)
            for row, (friction, width) in zip(rows, designs.Design.read(table, 3, 1).rows(), strict=True):
                assert (row[name], row["punch.width"]) == (friction, width) and 0.005 <= width <= 0.006
                outputs = ["wear_depth_punch", "dissipated_energy"]
                expected = host.run_schedule(pin, {name: friction, "punch.width": width}, schedule, outputs=outputs, step=step)
                assert [row[output] for output in outputs] == expected[-1].tolist()
    # The scene of an FMU that is given alone, whose own step is not that of the scene file.
    command = [needed("SLIDING_CONTACT_BATCH_PYTHON"), str(BATCH / "sweep.py"), "--fmu", str(file_of("pin_on_disk")), "--workers", "1"]
    command += ["--design", str(table), "--scenes", "3", "--no-plots", "--json", "--output", str(tmp_path / "alone"), "--step", repr(step)]
    subprocess.run(command, check=True, capture_output=True, env=clean_environment())
    assert [row["wear_depth_punch"] for row in rows_of(tmp_path / "alone")] == [row["wear_depth_punch"] for row in rows]


@pytest.mark.parametrize(
    "text, more, parts",
    [
        ("punch.widht,uniform,0.1,0.2", (), ["design.csv", "punch.widht", "did you mean punch.width?"]),
        ("wear_depth,uniform,0.1,0.2", (), ["design.csv", "wear_depth is no parameter of the scene disc_brake"]),
        ("normal_laod.factor,uniform,1,2", (), ["design.csv", "normal_laod.factor", "accepted are sliding_velocity.factor, normal_load.factor"]),
        ("punch.width,uniform,80 kN,2", (), ["design.csv, line 2", "80 kN", "accepted are m, mm"]),
        ("punch.width,uniform,0.1,0.2", ("--scene", "disc_break"), ["disc_break", "pin_on_disk"]),
        ("punch.width,uniform,0.1,0.2", ("--schedule", "none.csv"), ["none.csv", "nominal, udds, hwfet, stops"]),
        ("punch.width,uniform,0.1,0.2", ("--scene", "pin_on_disk", "--schedule", "udds"), ["contact.faces = 2"]),
        ("punch.width,uniform,0.1,0.2", ("--schedule", "design.csv"), ["design.csv, line 1", "time [s"]),
        ("punch.width,uniform,0.1,0.2", ("--step", "0"), ["--step 0 must be above 0 s"]),
        ("punch.width,uniform,0.1,0.2", ("--scenes", "-5"), ["--scenes -5 must be at least 1"]),
        ("punch.width,uniform,0.1,0.2", ("--fmu", "design.csv"), ["design.csv is no FMU"]),
        ("punch.width,uniform,0.1,0.2", ("--design", "none.csv"), ["none.csv"]),
    ],
)
def test_a_sweep_refuses_what_is_wrong_and_leaves_nothing(tmp_path, text, more, parts):
    (tmp_path / "design.csv").write_text(f"name,distribution,low,high\n{text}\n")
    command = [needed("SLIDING_CONTACT_BATCH_PYTHON"), str(BATCH / "sweep.py"), "--fmu", str(file_of("disc_brake")), "--scene", "disc_brake"]
    command += ["--design", "design.csv", "--schedule", "stops", "--output", "out", "--scenes", "4", "--no-plots", *more]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=clean_environment(), timeout=60)
    assert done.returncode != 0 and "Traceback" not in done.stderr, done.stderr
    assert all(part in done.stderr for part in parts), done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["design.csv"]


def test_the_job_file_runs_a_sweep(tmp_path):
    """Under a stand-in for Slurm's `srun`, which starts the one task here."""
    if os.name == "nt":
        pytest.skip("a job file of a shell")
    python = Path(needed("SLIDING_CONTACT_BATCH_PYTHON"))
    stub = tmp_path / "srun"
    stub.write_text('#!/bin/sh\nexec "$@"\n')
    stub.chmod(0o755)
    table = tmp_path / "design.csv"
    table.write_text("name,distribution,low,high\npunch.width,uniform,80 mm,110 mm\n")
    environment = clean_environment() | {
        "PATH": f"{tmp_path}:{os.environ['PATH']}",
        "ENVIRONMENT": str(python.parents[1]),
        "OUTPUT": str(tmp_path / "sweep"),
        "SCRIPT": str(BATCH / "sweep.py"),
        "SLURM_JOB_ID": "7",
    }
    arguments = ["--fmu", str(file_of("disc_brake")), "--design", str(table), "--scenes", "6", "--block", "3"]
    arguments += ["--schedule", "stops", "--every", "100", "--no-plots", "--json"]
    job = ["sh", str(BATCH / "sweep.slurm"), *arguments]
    run = subprocess.run(job, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
    assert run.returncode == 0, run.stdout
    # The summary is the end of the job's log.
    summary = run.stdout[run.stdout.index("{\n") :]
    assert json.loads(summary)["ran_now"] == 6
    assert not list((tmp_path / "sweep").glob("scheduler*"))
    failed = subprocess.run([*job, "--step", "0"], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120)
    assert failed.returncode != 0 and "--step 0 must be above 0 s" in failed.stderr.splitlines()[-1], failed.stderr


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


def test_the_command_tells_a_wrong_name_before_any_scene_runs(tmp_path):
    inputs, table, output = tmp_path / "inputs.csv", tmp_path / "design.csv", tmp_path / "out.csv"
    inputs.write_text("time,sliding_velocity [m/s],normal_load [N]\n0,1,100\n1,1,100\n")
    table.write_text("punch.widht\n0.1\n")
    command = [needed("SLIDING_CONTACT_COMMAND"), "batch", str(table), "--fmu", str(file_of("disc_brake"))]
    done = subprocess.run([*command, "--inputs", str(inputs), "-o", str(output)], capture_output=True, text=True)
    assert done.returncode != 0 and "did you mean punch.width?" in done.stderr
    assert list(tmp_path.glob("out.csv*")) == []


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
    # Speed falling from 10 m/s, load rising to 5 kN on two faces, friction coefficient .4: held rows would carry no load.
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
