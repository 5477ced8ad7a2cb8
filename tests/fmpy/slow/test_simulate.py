"""`cargo fmu simulate` through the command: the same results as the FMU, the figure in every format."""

import csv
import json
import os
import subprocess

import pytest

from component import Component
from conftest import ROOT

INPUTS = "time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n0.2,36,4\n1,0,4\n"
MEASURED = "time [s],contact_temperature [degC]\n0.3,40\n0.9,70\n"


def simulate(folder, *arguments):
    command = os.environ.get("SLIDING_CONTACT_COMMAND")
    if command is None:
        pytest.skip("SLIDING_CONTACT_COMMAND is not set: `cargo fmu test --slow` sets it")
    environment = os.environ | {"CARGO_MANIFEST_DIR": str(ROOT / "fmu-build")}
    run = subprocess.run([command, "simulate", *arguments], cwd=folder, check=True, capture_output=True, env=environment)
    return run.stdout


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures")
    (folder / "in.csv").write_text(INPUTS)
    (folder / "bench.csv").write_text(MEASURED)
    line = ["--set", "solver.fidelity=line", "--set", "solver.cells=9", "--step", "0.05"]
    for kind in ("svg", "pdf", "png"):
        simulate(folder, "disc_brake", "--inputs", "in.csv", "--measured", "bench.csv", *line, "--plot", f"figure.{kind}")
    return folder


def test_results_are_those_of_the_fmu(fmus, tmp_path):
    """The inputs of the FMU are linear within a step by their derivatives, as those of the command."""
    (tmp_path / "in.csv").write_text(INPUTS)
    result = json.loads(simulate(tmp_path, "disc_brake", "--inputs", "in.csv", "--step", "0.05", "-o", "out.csv", "--json"))
    with open(tmp_path / "out.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == result["communication_steps"] + 1 == 21
    number = {name.split(" [")[0]: name for name in rows[0]}
    with Component(fmus("disc_brake")) as component:
        component.initialise(sliding_velocity=10.0, normal_load=0.0)
        for before, after in zip(rows, rows[1:]):
            begin, end = (float(row[number["time"]]) for row in (before, after))
            for name in ("sliding_velocity", "normal_load"):
                first, last = (float(row[number[name]]) for row in (before, after))
                component.set(**{name: first})
                component.set_input_derivative(name, (last - first) / (end - begin))
            component.step(end - begin)
            for name in ("wear_depth", "contact_temperature", "friction_force", "dissipated_energy", "contact_temperature_max"):
                assert component.get(name) == pytest.approx(float(after[number[name]]), rel=1e-11, abs=1e-20), name


def test_every_format_is_what_it_says(figures):
    assert (figures / "figure.pdf").read_bytes().startswith(b"%PDF")
    assert (figures / "figure.png").read_bytes().startswith(b"\x89PNG")
    assert "<svg" in (figures / "figure.svg").read_text(encoding="utf-8")


def test_axes_are_labelled_with_units_and_measured_points_are_marked(figures):
    text = (figures / "figure.svg").read_text(encoding="utf-8")
    for label in ("time (s)", "sliding velocity", "temperature (°C)", "pressure (MPa)", "friction heat", "measured",
                  "x, sliding direction (mm)", "disc_brake, level line, 9 cells", "0.1 s", "0.55 s", "1 s"):  # fmt: skip
        assert label in text, label
