"""FMUs: the shipped ones in the host, and those of scenes of one's own."""

import re
import zipfile

import numpy as np
import pytest

import sliding_contact
from conftest import command
from sliding_contact import Error, Scene, fmu, host, scenes

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def test_the_shipped_fmus_run_in_the_host(tmp_path):
    assert {"clutch", "disc_brake", "pin_on_disk"} <= set(scenes())
    schedule = host.Schedule(("sliding_velocity", "normal_load"), [0.0, 4.0], [[10.0, 4000.0], [0.0, 4000.0]], "linear")
    with host.Fmu(host.unpack(fmu("disc_brake"), tmp_path / "fmu")) as own:
        recorded = host.run_schedule(own, {}, schedule, outputs=["dissipated_energy"], step=0.004)
    inputs = {"time [s]": [0, 4], "sliding_velocity [m/s]": [10, 0], "normal_load [N]": 4000}
    native = Scene.load("disc_brake").simulate(inputs, step=0.004)["dissipated_energy"][-1]
    assert recorded[0, 0] == pytest.approx(native, rel=1e-12)
    with pytest.raises(host.Failure) as failure:
        host.Fmu(tmp_path / "nothing")
    assert failure.value.stage == "library"


def test_a_scene_whose_neighbour_has_no_temperature_is_packaged_and_run_with_it_at_ambient(tmp_path):
    scene = Scene.load("disc_brake").set({"strip.external_conductance": 3.5, "solver.fidelity": "lumped"})
    with zipfile.ZipFile(scene.package(tmp_path / "own.fmu")) as archive:
        (header, row, *_), = [archive.read(name).decode().splitlines() for name in archive.namelist() if name.endswith("_in.csv")]
    assert header == "time,sliding_velocity,normal_load,strip.external_temperature" and row.endswith(",293.15")
    assert scene.simulate()["strip.external_temperature [degC]"][0] == pytest.approx(20.0)
    inputs = {"time [s]": [0, 1], "sliding_velocity [m/s]": 10, "normal_load [N]": 4000}
    with pytest.raises(Error, match='give it in a column of the inputs, or set strip.external_temperature="20 degC"'):
        scene.simulate(inputs)
    scene.set({"strip.external_temperature": "20 degC"}).simulate(inputs)


OWN = 'name = "bench"\ndescription = "A pad of 60 mm"\n[experiment]\nstop = "2 s"\nstep = 0.01\n[punch]\nwidth = "60 mm"\n[solver]\nfidelity = "lumped"\n'


def test_an_fmu_of_ones_own_scene_is_that_of_the_command(tmp_path):
    """To the byte: description, slot, page, reference. And an importer runs it, with what the package itself computes."""
    fmpy = pytest.importorskip("fmpy")
    (tmp_path / "bench.toml").write_text(OWN)
    path = Scene.load(tmp_path / "bench.toml").package(tmp_path / "made" / "own.fmu")
    run = command(tmp_path, "package", "bench.toml", "-o", "commanded.fmu")
    assert run.returncode == 0, run.stderr
    assert path.read_bytes() == (tmp_path / "commanded.fmu").read_bytes()
    assert Scene.load("clutch").package(tmp_path / "clutch.fmu").read_bytes() == fmu("clutch").read_bytes()
    description = fmpy.read_model_description(path, validate=True)
    assert (description.modelName, description.description) == ("SlidingContact.bench", "A pad of 60 mm")
    changed = Scene.load(tmp_path / "bench.toml").set({"contact.friction_coefficient": 0.35}).package(path)
    assert fmpy.read_model_description(changed).guid != description.guid
    time, inputs = [0.0, 1.0], {"time [s]": [0, 1], "sliding_velocity [m/s]": 10, "normal_load [N]": 4000}
    signals = np.array([(t, 10.0, 4000.0) for t in time], dtype=[(name, float) for name in ("time", "sliding_velocity", "normal_load")])
    result = fmpy.simulate_fmu(str(changed), stop_time=1.0, step_size=0.01, output_interval=0.01, input=signals, output=["friction_force", "dissipated_energy"])
    own = Scene.load(tmp_path / "bench.toml").set({"contact.friction_coefficient": 0.35}).simulate(inputs, step=0.01)
    assert result["friction_force"][-1] == own["friction_force"][-1] == pytest.approx(2 * 0.35 * 4000)
    assert result["dissipated_energy"][-1] == pytest.approx(own["dissipated_energy"][-1], rel=1e-12)
    assert sorted(entry.name for entry in (tmp_path / "made").iterdir()) == ["own.fmu"]


def test_an_fmu_that_cannot_be_made_leaves_the_one_that_is_there(tmp_path, monkeypatch):
    path = tmp_path / "own.fmu"
    path.write_text("before")
    scene = Scene.load("disc_brake")
    (tmp_path / "folder.fmu").mkdir()
    for wrong, text in ((tmp_path / "own.zip", "must end in .fmu"), (tmp_path / "folder.fmu", "is no regular file")):
        with pytest.raises(Error, match=re.escape(text)):
            scene.package(wrong)
    with pytest.raises(Error, match=re.escape(f"writing {path / 'below.fmu'}: [Errno")):
        scene.package(path / "below.fmu")
    fmus = tmp_path / "fmus"
    fmus.mkdir()
    monkeypatch.setattr(sliding_contact.scene._native, "FMUS", fmus)
    with pytest.raises(Error, match="there is no FMU in"):
        scene.package(path)
    # One of another version, whose library has no slot.
    with zipfile.ZipFile(fmus / "other.fmu", "w") as archive:
        archive.writestr("binaries/linux64/SlidingContact.so", b"0" * 10_000)
    with pytest.raises(Error, match="the library has no scene slot"):
        scene.package(path)
    assert path.read_text() == "before" and sorted(own.name for own in tmp_path.iterdir()) == ["fmus", "folder.fmu", "own.fmu"]


def test_an_archive_that_would_fill_the_disk_is_not_unpacked(tmp_path, monkeypatch):
    archive = tmp_path / "large.fmu"
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in ("modelDescription.xml", "resources/table"):
            packed.writestr(name, b"0" * 2**21)
    monkeypatch.setattr(host, "_MOST_BYTES", 2**22 - 1)
    with pytest.raises(Error, match=re.escape(f"{archive}: its files are 4 MB, and at most")):
        host.unpack(archive, tmp_path / "folder")
    assert list(tmp_path.iterdir()) == [archive]
    monkeypatch.setattr(host, "_MOST_BYTES", 2**22)
    assert (host.unpack(archive, tmp_path / "folder") / "resources" / "table").stat().st_size == 2**21
