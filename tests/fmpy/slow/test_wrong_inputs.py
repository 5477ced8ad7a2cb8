"""Wrong inputs of every command of `cargo fmu` (wrong_inputs.toml).

Each is refused before anything is done: with a message that names file, line or variable, value and what is accepted, a status other
than 0, and no file written, replaced or left half-written.
"""

import os
import shlex
import subprocess
from pathlib import Path

import pytest

from conftest import ROOT, file_of

try:
    import tomllib
except ModuleNotFoundError:
    import tomli as tomllib

SECONDS = 60.0
TABLE = tomllib.loads(Path(__file__).with_name("wrong_inputs.toml").read_text(encoding="utf-8"))
# What no TOML file holds.
BINARY = b"\xff\xfe\x00\x01\n\x80"
CASES = {
    **{f"{command} {scene}": parts for command in TABLE["with_scenes"] for scene, parts in TABLE["scenes"].items()},
    **{f"{command} {setting}": parts for command in TABLE["with_settings"] for setting, parts in TABLE["settings"].items()},
    **TABLE["lines"],
}


def needed(variable):
    value = os.environ.get(variable)
    if value is None:
        pytest.fail(f"{variable} is not set: `cargo fmu test --slow` sets it")
    return value


def contents(folder):
    """Every path below a folder, with the bytes and the time of change of a file."""
    kept = {}
    for path in sorted(folder.rglob("*")):
        kept[str(path.relative_to(folder))] = (path.read_bytes(), path.stat().st_mtime_ns) if path.is_file() else None
    return kept


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("wrong")
    for name, content in TABLE["files"].items():
        (made / name).write_bytes(content.encode())
    (made / "binary.csv").write_bytes(BINARY)
    (made / "folder.fmu").mkdir()
    return made


@pytest.fixture(scope="module")
def environment():
    """As a user starts it, but for the program of the commands that compute: cargo takes a while to find that it is up to date."""
    own = {**os.environ, "CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")}
    lab = Path(needed("SLIDING_CONTACT_COMMAND")).with_name("fmu-lab")
    return own | ({"SLIDING_CONTACT_LAB": str(lab)} if lab.is_file() else {})


@pytest.mark.parametrize("line", CASES)
def test_it_is_refused_with_what_is_accepted_and_nothing_is_touched(folder, environment, line):
    arguments = [str(file_of("disc_brake")) if word == "FMU" else word for word in shlex.split(line)]
    before = contents(folder)
    command = [needed("SLIDING_CONTACT_COMMAND"), *arguments]
    run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=SECONDS)
    told = run.stdout + run.stderr
    assert run.returncode not in (0, 101) and run.returncode > 0, told
    assert run.stderr.count("error: ") >= 1 or "Usage:" in told, told
    missing = [part for part in CASES[line] if part not in run.stderr]
    assert not missing, f"{missing} in: {told}"
    assert "panicked" not in told and "backtrace" not in told.lower() and "Traceback" not in told, told
    assert contents(folder) == before, sorted(set(contents(folder)) ^ set(before))
