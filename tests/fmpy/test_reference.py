"""The reference in every FMU: what it answers when it is packaged, for whoever wants to check an installation."""

import csv
import io
import zipfile

import pytest
from conftest import ROOT, file_of

SCENES = [None, *sorted(path.parent.name for path in (ROOT / "examples").glob("*/scene.toml"))]
STEPS = 200


def table(package, name):
    text = package.read(f"extra/reference/SlidingContact_{name}").decode()
    rows = list(csv.reader(io.StringIO(text)))
    return rows[0], [dict(zip(rows[0], map(float, row), strict=True)) for row in rows[1:]]


@pytest.mark.parametrize("scene", SCENES)
def test_every_reference_slides_heats_wears_and_keeps_its_books(fmus, scene):
    fmu = fmus(scene)
    with zipfile.ZipFile(file_of(scene)) as package:
        given, inputs = table(package, "in.csv")
        _, outputs = table(package, "ref.csv")
        options = package.read("extra/reference/SlidingContact_ref.opt").decode().splitlines()
    assert given == ["time", "sliding_velocity", "normal_load"]
    assert len(inputs) == len(outputs) == STEPS + 1
    step = float(dict(line.split(",") for line in options)["StepSize"])
    end = outputs[-1]
    assert end["wear_volume_punch"] > 0.0 and end["dissipated_energy"] > 0.0
    # The inputs are held over a step, so the distance is their sum to the digits written, less what a bristle gives way
    # before it slides.
    faces, bristle = fmu.start("contact.faces"), 0.0
    if fmu.start("contact.stick_stiffness") > 0.0:
        limit = fmu.start("contact.friction_coefficient") * fmu.start("contact.static_friction_ratio")
        bristle = limit * fmu.start("nominal.load") * faces / fmu.start("contact.stick_stiffness")
    distance = step * sum(abs(row["sliding_velocity"]) for row in inputs[:-1])
    assert abs(end["sliding_distance"] - distance) < bristle + 1e-6 * distance
    # Archard's volume where nothing fades: exponents are 1 and mu is at its reference.
    work = step * sum(abs(row["sliding_velocity"]) * row["normal_load"] for row in inputs[:-1])
    ratio = end["wear_volume_punch"] / (work * fmu.start("punch.wear_coefficient") * faces)
    assert 0.95 <= ratio < 1.5
