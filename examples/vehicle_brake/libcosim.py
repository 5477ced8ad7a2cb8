"""libcosim in a Python environment of its own, made beside the one that runs this."""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from master import NANOSECONDS, Recording

FOLDER = Path(__file__).resolve().parent
REQUIREMENTS = FOLDER / "libcosim_requirements.txt"


class NotInstallable(Exception):
    """libcosimpy cannot be installed here; the message says why."""


def environment():
    """Python of the environment with libcosimpy; made where it is not there yet."""
    folder = Path(sys.prefix).parent / "libcosim"
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    stamp = folder / "installed.txt"
    wanted = REQUIREMENTS.read_text(encoding="utf-8")
    if python.exists() and stamp.is_file() and stamp.read_text(encoding="utf-8") == wanted:
        return python
    shutil.rmtree(folder, ignore_errors=True)
    commands = (
        [sys.executable, "-m", "venv", "--without-pip", str(folder)],
        [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-input", "--no-deps",
         "--only-binary", ":all:", "--requirement", str(REQUIREMENTS)],
        [str(python), "-c", "import libcosimpy.CosimExecution"],
    )
    for command in commands:
        result = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if result.returncode != 0:
            shutil.rmtree(folder, ignore_errors=True)
            raise NotInstallable((result.stderr.strip() or result.stdout.strip()).splitlines()[-1])
    stamp.write_text(wanted, encoding="utf-8")
    return python


def run(ssp, recorded, duration, step):
    """Runs a package and returns its recording, from the first communication point after the start on."""
    python = environment()
    ticks = round(step * NANOSECONDS)
    count = round(duration * NANOSECONDS / ticks)
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "rows"
        command = [str(python), str(FOLDER / "libcosim_master.py"), "--ssp", str(ssp), "--steps", str(count)]
        command += ["--output", str(target), *(f"{component}:{output}" for component, output in recorded)]
        result = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if result.returncode != 0:
            raise RuntimeError(f"libcosim did not finish: {(result.stderr + result.stdout).strip()[-800:]}")
        table = np.fromfile(target, dtype="<f8").reshape(count, len(recorded))
    seconds = json.loads(result.stdout.splitlines()[-1])["seconds"]
    time_points = np.arange(1, count + 1) * ticks / NANOSECONDS
    columns = {key: table[:, index] for index, key in enumerate(recorded)}
    return Recording(time_points, columns, {}, seconds, "libcosim")


def difference(reference, other):
    """Largest difference of two recordings over all outputs, relative to the range of each output in `reference`;
    the name of the worst output with it."""
    worst, name = 0.0, ""
    for key, values in other.columns.items():
        expected = reference.columns[key][-len(values) :]
        span = float(np.ptp(reference.columns[key]))
        error = float(np.abs(values - expected).max())
        relative = error / span if span > 0.0 else error
        if not relative <= worst:
            worst, name = relative, ":".join(key)
    return worst, name
