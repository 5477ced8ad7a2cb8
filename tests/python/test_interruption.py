"""Threads, progress, and signals that end what runs for long."""

import os
import signal
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest

from conftest import STOP
from sliding_contact import Interrupted, Scene, SceneWarning, fmu, host

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


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
    "fit": "line.fit(tests)",
    "batch": "disc.batch({'punch.width': [0.08, 0.09, 0.1]})",
    "host": "host.run_schedule(own, {}, schedule, outputs=['dissipated_energy'], step=1e-3)",
}

# Modules are loaded before: an import takes an OSError, which TimeoutError is, for a file that is not there.
INTERRUPTED = """
import os, signal, tempfile, threading, time, warnings
import numpy as np
from sliding_contact import Scene, SceneWarning, fit, host
warnings.simplefilter("ignore", SceneWarning)
brake, punch = Scene.load("disc_brake"), Scene.load("reciprocating_punch")
disc = brake.copy().set({"solver.fidelity": "line", "solver.cells": 257, "nominal.duration": "3000 s"})
stops = {"time [s]": np.arange(0.0, 3000.0, 5.0), "sliding_velocity [m/s]": [10.0, 0.0] * 300, "normal_load [N]": 4000}
line = Scene.load("pin_on_disk").set({"solver.fidelity": "line", "solver.cells": 129})
tests = {"load [N]": [5, 10, 20, 40], "speed [m/s]": 0.1, "distance [m]": 1e4, "volume [mm3]": [1, 2, 4, 8]}
HOST
class Late(Exception):
    pass
def late(*_):
    raise Late
signal.signal(signal.SIGUSR1, late)
sent = []
def send():
    sent.append(time.monotonic())
    os.kill(os.getpid(), NUMBER)
threading.Timer(1.0, send).start()
try:
    CALL
    print("done")
except (KeyboardInterrupt, Late) as error:
    print(KeyboardInterrupt.__name__ if isinstance(error, KeyboardInterrupt) else type(error).__name__, time.monotonic() - sent[0])
time.sleep(0.1)
assert all(thread.name != "sliding_contact" for thread in threading.enumerate())
"""

OPENED = """
own = host.Fmu(host.unpack("FMU", tempfile.mkdtemp() + "/fmu"))
schedule = host.Schedule(("sliding_velocity", "normal_load"), [0.0, 1e5], [[1.0, 4000.0], [1.0, 4000.0]])
"""


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
@pytest.mark.parametrize("signalled, raised", [("signal.SIGINT", "KeyboardInterrupt"), ("signal.SIGUSR1", "Late")])
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


def interrupted(work, seconds=None):
    """What Ctrl-C leaves of work, after `seconds` or when work itself sends it."""
    if seconds is not None:
        threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt) as stopped:
        work()
    assert isinstance(stopped.value, Interrupted)
    return stopped.value


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
def test_an_interrupted_run_is_kept_up_to_its_last_step():
    disc = Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 129, "nominal.duration": "3000 s"})
    sent = []

    def send(part):
        if part > 2e-4 and not sent:
            sent.append(os.kill(os.getpid(), signal.SIGINT))

    stopped = interrupted(lambda: disc.simulate(step=0.1, progress=send))
    run = stopped.result
    assert 2 < run.time.size < 30000 and str(stopped).startswith(f"interrupted at {run.time[-1]:g} s of 3000 s")
    # The same numbers as of a run that ends there.
    held = {"time [s]": [0.0, run.time[-1]], "sliding_velocity [m/s]": run["sliding_velocity"][0], "normal_load [N]": run["normal_load"][0]}
    whole = disc.simulate(held, step=0.1)
    assert all(values.size == run.time.size and np.allclose(values, whole[name], rtol=1e-9) for name, values in run.items())
    assert "friction heat" in str(run)


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
def test_interrupted_levels_and_cycles_are_kept():
    stops = {"time [s]": np.arange(0.0, 3000.0, 5.0), "sliding_velocity [m/s]": [10.0, 0.0] * 300, "normal_load [N]": 4000}
    stopped = interrupted(lambda: Scene.load("disc_brake").plan(stops, tolerance=1e-5), 8.0)
    levels = stopped.result
    assert levels.level is None and levels.record["levels"][0]["fidelity"] == "lumped" and levels.record["levels"][0]["steps"] > 0
    assert "Interrupted: " in str(levels) and "The cheapest" not in str(levels)
    with pytest.raises(ValueError, match="before it named a level"):
        levels.settings
    # A text, as the command gives it.
    stopped = interrupted(lambda: Scene.load("reciprocating_punch").cycles("1e9", cells=33, tolerance=1e-6), 8.0)
    course = stopped.result
    assert course.cycles.size > 1 and course.cycles[-1] < 1e9 and course.wear_profile_punch.max() > 0.0
    assert f"after {course.cycles[-1]:g} of 1e+09 cycles" in str(stopped)


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
def test_an_interrupted_command_writes_its_rows(tmp_path):
    command = [sys.executable, "-m", "sliding_contact", "simulate", "disc_brake", "-s", "solver.fidelity=line", "-s", "solver.cells=129"]
    with subprocess.Popen([*command, "-s", "nominal.duration=30000 s", "--step", "0.1", "-o", "out.csv"], cwd=tmp_path, stderr=subprocess.PIPE, text=True) as run:
        time.sleep(10.0)
        run.send_signal(signal.SIGINT)
        told = run.stderr.read()
    rows = (tmp_path / "out.csv").read_text().splitlines()
    assert run.returncode == 130 and f"interrupted at {float(rows[-1].split(',')[0]):g} s of 30000 s; the rows up to there are in out.csv" in told


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
def test_a_handler_that_raises_nothing_ends_nothing():
    seen = []
    before = signal.signal(signal.SIGUSR1, lambda *_: seen.append(threading.current_thread()))
    try:
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGUSR1)).start()
        state = Scene.load("reciprocating_punch").steady(cells=97)
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert seen == [threading.main_thread()] and state.x.size == 97
