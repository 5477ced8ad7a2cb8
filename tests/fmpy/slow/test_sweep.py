"""Sweeps of the example `batch`: processes that are killed and resumed, widened tables, refusals."""

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
from batches import BATCH, Scene, brake, clean_environment, host, needed, schedules, wait_for  # noqa: F401

import design as designs


def sweep(folder, *more):
    command = [needed("SLIDING_CONTACT_BATCH_PYTHON"), str(BATCH / "sweep.py")]
    command += ["--fmu", str(file_of("disc_brake"))]
    command += ["--output", str(folder), "--workers", "2", "--no-plots", "--json", *more]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True, env=clean_environment()
    )


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


def test_ctrl_c_ends_a_sweep_within_a_second_while_it_starts_and_in_a_block(tmp_path):
    table = tmp_path / "design.csv"
    table.write_text("name,distribution,low,high\npunch.width,uniform,80 mm,110 mm\n")
    more = ("--design", str(table), "--schedule", "stops", "--step", "0.0005", "--every", "10", "--scenes", "24", "--block", "4")
    # A shell that runs the tests in the background has them ignore Ctrl-C.
    own_way = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        for name, begun in (("starts", lambda folder: (folder / "batch.json").exists()), ("runs", parts_of)):
            folder = tmp_path / name
            process = sweep(folder, *more)
            wait_for(lambda: begun(folder), process)
            time.sleep(0.5)
            begin = time.monotonic()
            os.killpg(process.pid, signal.SIGINT)
            _, error = process.communicate(timeout=60)
            assert process.returncode == 130 and "the same command continues" in error, error
            assert time.monotonic() - begin < 1.5 and "Traceback" not in error, error
    finally:
        signal.signal(signal.SIGINT, own_way)
    done = 4 * len(parts_of(folder))
    assert 0 < done < 24 and finish(sweep(folder, *more))["ran_now"] == 24 - done


def test_a_local_cluster_starts_where_signals_have_no_mask(tmp_path):
    """As on Windows."""
    code = """
import signal, sys
del signal.pthread_sigmask
from multiprocessing import resource_tracker
resource_tracker.ensure_running = None
sys.path.insert(0, sys.argv[1])
import pool
if __name__ == "__main__":
    with pool.client(None, 1, sys.argv[2]) as own:
        print(own.submit(sum, [1, 2]).result())
"""
    command = [needed("SLIDING_CONTACT_BATCH_PYTHON"), "-c", code]
    run = subprocess.run([*command, str(BATCH), str(tmp_path)], env=clean_environment(), capture_output=True, text=True, timeout=120)
    assert run.stdout == "3\n", run.stderr


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
