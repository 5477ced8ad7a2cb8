"""The figure of `cargo fmu simulate` in every format, through the command."""

import os
import subprocess

import pytest

from conftest import ROOT

INPUTS = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n0.2,36,4\n1,0,4\n"
MEASURED = "time [s],contact_temperature [degC]\n0.3,40\n0.9,70\n"


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    command = os.environ.get("SLIDING_CONTACT_COMMAND")
    if command is None:
        pytest.skip("SLIDING_CONTACT_COMMAND is not set: `cargo fmu test` sets it")
    folder = tmp_path_factory.mktemp("figures")
    (folder / "in.csv").write_text(INPUTS)
    (folder / "bench.csv").write_text(MEASURED)
    line = ["--set", "solver.fidelity=line", "--set", "solver.cells=9"]
    for kind in ("svg", "pdf", "png"):
        arguments = ["disc_brake", "--inputs", "in.csv", "--measured", "bench.csv", *line, "--plot", f"figure.{kind}"]
        subprocess.run([command, "simulate", *arguments], cwd=folder, check=True, capture_output=True,
                       env=os.environ | {"CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")})  # fmt: skip
    return folder


def test_every_format_is_what_it_says(figures):
    assert (figures / "figure.pdf").read_bytes().startswith(b"%PDF")
    assert (figures / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (figures / "figure.svg").read_text(encoding="utf-8")


def test_axes_are_labelled_with_units_and_measured_points_are_marked(figures):
    text = (figures / "figure.svg").read_text(encoding="utf-8")
    for label in ("time (s)", "sliding velocity (m/s)", "temperature (°C)", "pressure (MPa)", "friction heat", "measured",
                  "x, along the sliding direction (mm)", "disc_brake, level line, 9 cells", "0 s", "0.5 s", "1 s"):  # fmt: skip
        assert label in text, label
