"""The wheel in an empty environment: three lines to a figure of one's own scene, without a compiler."""

import os
import subprocess
import sys
import time
import venv
import zipfile
from pathlib import Path

from conftest import ROOT, needed

LINES = """\
from sliding_contact import Scene
scene = Scene.load("my_scene.toml").set({"punch.width": "80 mm", "solver.fidelity": "line"})
scene.simulate("stop.csv").plot("stop.pdf")
"""
SCENE = 'name = "my_scene"\n[punch]\nmaterial = "brake_lining"\nbody = "elastic"\n[strip]\nmaterial = "grey_cast_iron"\nbody = "elastic"\n'
STOP = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n0.3,36,8\n4,0,8\n5,0,0\n"
SECONDS = 60.0


def test_three_lines_to_a_figure_in_an_empty_environment(tmp_path):
    wheel = needed("SLIDING_CONTACT_WHEEL")
    folder = tmp_path / "environment"
    venv.create(folder, with_pip=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    # Nothing but the environment on the path: no compiler, no cargo.
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "SLIDING_CONTACT", "CARGO", "MPL"))}
    environment |= {"PATH": str(programs), "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(tmp_path / "matplotlib")}
    (tmp_path / "my_scene.toml").write_text(SCENE)
    (tmp_path / "stop.csv").write_text(STOP)
    (tmp_path / "three.py").write_text(LINES)
    begin = time.monotonic()
    for arguments in (["-m", "pip", "install", "--quiet", "--no-input", f"{wheel}[plot]"], ["-W", "ignore", "three.py"]):
        run = subprocess.run([str(programs / "python"), *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
    seconds = time.monotonic() - begin
    assert (tmp_path / "stop.pdf").read_bytes().startswith(b"%PDF")
    print(f"{seconds:.1f} s from pip install to the figure")
    assert seconds < SECONDS, seconds
    code = "import sliding_contact as s; print(len(s.scenes()), all(s.fmu(name).is_file() for name in s.scenes()))"
    run = subprocess.run([str(programs / "python"), "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.stdout.endswith(" True\n") and int(run.stdout.split()[0]) >= 5, run


def test_pip_installs_the_source_tree(tmp_path):
    """Its wheel is made by `cargo fmu wheel`, in the target folder that has been built by now; the user's settings are those of nobody."""
    needed("SLIDING_CONTACT_WHEEL")
    folder, home = tmp_path / "environment", tmp_path / "home"
    venv.create(folder, with_pip=True)
    home.mkdir()
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "SLIDING_CONTACT", "CARGO_MANIFEST", "MPL"))}
    tools = {name: os.environ.get(name, str(Path.home() / own)) for name, own in (("CARGO_HOME", ".cargo"), ("RUSTUP_HOME", ".rustup"))}
    environment |= {**tools, "HOME": str(home), "PIP_CACHE_DIR": str(home / "pip")}
    # Where the linker is found: with another path cargo compiles everything anew.
    environment["XDG_CACHE_HOME"] = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    begin = time.monotonic()
    install = [str(programs / "python"), "-m", "pip", "install", "--no-input", "."]
    run = subprocess.run(install, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    print(f"{time.monotonic() - begin:.1f} s for pip install .")
    code = "from sliding_contact import Scene, __file__; print(__file__, Scene.load('pin_on_disk').name)"
    run = subprocess.run([str(programs / "python"), "-c", code], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.returncode == 0 and run.stdout.startswith(str(folder)) and run.stdout.endswith("pin_on_disk\n"), run
    # Nothing is left in the tree.
    left = [path for path in (ROOT, ROOT / "python") for path in path.iterdir() if path.name in ("build", "dist") or path.suffix == ".egg-info"]
    assert not left, left


def test_the_wheel_is_whole_and_for_old_systems():
    import base64
    import hashlib

    wheel = needed("SLIDING_CONTACT_WHEEL")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        record = next(name for name in names if name.endswith(".dist-info/RECORD"))
        rows = [row.rsplit(",", 2) for row in archive.read(record).decode().splitlines()]
        assert {row[0] for row in rows} == names
        for name, digest, size in rows:
            if name != record:
                content = archive.read(name)
                code = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).decode().rstrip("=")
                assert (digest, int(size)) == (f"sha256={code}", len(content)), name
    assert any(name.endswith("licenses/LICENSE-MIT") for name in names) and "sliding_contact/py.typed" in names
    if sys.platform == "linux":
        assert "manylinux_2_17_" in os.path.basename(wheel)
