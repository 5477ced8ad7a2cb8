"""Tables of inputs, records and tests: dictionaries, frames, and files as rigs write them."""

import re
import time
import warnings

import numpy as np
import pytest

from conftest import STOP
from sliding_contact import Error, Scene, SceneNote, SceneWarning, fit

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def test_inputs_are_the_same_as_dictionary_frame_and_file(stop_csv):
    pandas = pytest.importorskip("pandas")
    scene = Scene.load("disc_brake")
    ways = [STOP, {**STOP, "normal_load [kN]": np.array(STOP["normal_load [kN]"])}, pandas.DataFrame(STOP), stop_csv, str(stop_csv)]
    first, *others = [scene.simulate(inputs)["contact_temperature"] for inputs in ways]
    assert all(np.array_equal(first, other) for other in others)
    again = scene.simulate(scene.simulate(STOP).frame("sliding_velocity [m/s]", "normal_load [N]"))
    assert again["dissipated_energy"][-1] == pytest.approx(scene.simulate(STOP)["dissipated_energy"][-1], rel=1e-3)


def test_the_table_of_a_run_is_read_again(tmp_path):
    pandas = pytest.importorskip("pandas")
    scene = Scene.load("disc_brake")
    result = scene.simulate(STOP)
    for index in (True, False):
        path = tmp_path / f"run-{index}.csv"
        result.frame().to_csv(path, index=index)
        for table in (path, pandas.read_csv(path)):
            deviations = result.compare(table)
            assert set(deviations) == set(result)
            assert all(abs(own.largest) <= 1e-12 * max(own.range, np.abs(own.measured).max()) for own in deviations.values())
            again = scene.simulate(table)
            assert again.time[-1] == result.time[-1]
            assert again["dissipated_energy"][-1] == pytest.approx(result["dissipated_energy"][-1], rel=1e-6)
    frame = result.frame("sliding_velocity [km/h]", "normal_load [kN]", "contact_temperature [degC]")
    frame.iloc[::3].to_csv(path)
    assert set(result.compare(path)) == {"contact_temperature", "normal_load", "sliding_velocity"}
    result.frame("time [min]", "contact_temperature", "friction_coefficient").to_csv(path)
    assert set(result.compare(path)) == {"contact_temperature", "friction_coefficient"}
    # With gaps, as rigs write it.
    frame.loc[1:3, "contact_temperature [degC]"] = np.nan
    frame.to_csv(tmp_path / "plain.csv")
    frame.to_csv(tmp_path / "comma.csv", sep=";", decimal=",", index=False)
    frame.rename(columns={"contact_temperature [degC]": "Temp. [°C]"}).to_csv(tmp_path / "latin.csv", encoding="latin-1")
    sources = [frame, tmp_path / "plain.csv", tmp_path / "comma.csv", tmp_path / "latin.csv"]
    if pytest.importorskip("pyarrow"):
        frame.to_parquet(tmp_path / "frame.parquet")
        sources.append(tmp_path / "frame.parquet")
    for table in sources:
        found = result.compare(table)["contact_temperature"]
        assert found.measured.size == len(frame) - 3 and found.root_mean_square < 1e-9, table
        again = scene.simulate(table, step=10.0)
        assert again["contact_temperature"][-1] == pytest.approx(result["contact_temperature"][-1], rel=1e-9)


def test_columns_of_other_names_are_named_or_left_out_or_refused(tmp_path):
    scene = Scene.load("disc_brake")
    rig = {"time [s]": [0, 1, 2], "v [m/s]": 10, "Kraft [kN]": 4, "COF": [0.4, 0.4, 0.4], "Humidity [%]": 40}
    columns = {"v": "sliding_velocity", "Kraft": "normal_load"}
    with pytest.warns(SceneWarning, match=re.escape('left out are "Humidity [%]"; columns={"HEADER": "VARIABLE"} names a quantity')):
        result = scene.simulate(rig, columns=columns)
    assert result["normal_load"][-1] == 4000.0 and result["sliding_velocity"][-1] == 10.0
    assert np.array_equal(scene.trajectory(rig, columns=columns).values[-1], [10.0, 4000.0])
    # Of a file that is both every note is told once.
    file = tmp_path / "rig.csv"
    file.write_text("Time [s],v [m/s],Load [kN],Humidity [%],COF\n0,10,4,40,0.4\n2,10,4,41,0.4\n")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        scene.simulate(file, measured=file)
    assert len(told) == 2, [str(note.message) for note in told]
    with pytest.warns(SceneNote, match="left out"):
        assert list(result.compare(rig, columns={**columns, "COF": "friction_coefficient"})) == ["friction_coefficient"]
    with pytest.warns(SceneWarning, match='columns: there is no column "Krafft"'):
        scene.simulate({**STOP, "Humidity [%]": 40}, columns={"Krafft": "normal_load", "Humidity": ""})
    for wrong, text in (
        (lambda: scene.simulate(rig, columns=columns, strict=True), '"Humidity [%]" is not a known quantity'),
        (lambda: result.compare(rig, columns=columns, strict=True), '"Humidity [%]" is not a known quantity'),
        (lambda: scene.plan(rig, columns={**columns, "v": "velocitty"}), "is not a known quantity"),
        (lambda: scene.simulate(rig, columns=["Kraft"]), "columns = ['Kraft']: accepted is a dictionary"),
    ):
        with pytest.raises(Error, match=re.escape(text)):
            wrong()


def test_a_record_without_an_output_is_refused_with_what_is_left_out():
    rig = {"time [s]": [0, 1, 2], "sliding_velocity [m/s]": 10, "normal_load [kN]": 4, "Friction [kgf]": 160}
    scene = Scene.load("disc_brake")
    for refused in (lambda: scene.simulate(rig, measured=rig), lambda: scene.simulate(STOP).compare({"time [s]": [0, 1], "Friction [kgf]": 160})):
        with pytest.raises(Error, match=re.escape('left out are "Friction [kgf]" ("kgf" is no known unit of friction_force [N')):
            refused()


def test_a_record_that_is_no_table_is_refused_with_what_is_accepted(tmp_path):
    pytest.importorskip("matplotlib")
    result = Scene.load("disc_brake").set({"nominal.duration": "1 s"}).simulate()
    picture, sheet, latin = (tmp_path / name for name in ("record.png", "record.xlsx", "latin.csv"))
    result.plot(picture)
    sheet.write_bytes(b"PK\x03\x04\x14\x00\x06\x00")
    latin.write_bytes("time [s],contact_temperature [°C]\n0,20\n".encode("latin-1"))
    for record, told in ((picture, f"{picture} is no text; a CSV or Parquet"), (sheet, f"{sheet} is no text; a CSV or Parquet"), ([1, 2], "list is no table; accepted are CSV and Parquet")):
        for refused in (lambda: result.compare(record), lambda: result.plot(measured=record)):
            with pytest.raises(Error) as raised:
                refused()
            assert told in str(raised.value)
    assert result.compare(latin)["contact_temperature"].measured == pytest.approx([293.15])
    # A character of two bytes that the first block of a file cuts is text.
    long = tmp_path / "long.csv"
    long.write_bytes(b"#" * 4095 + "é\ntime [s],contact_temperature [degC]\n0,20\n".encode())
    assert result.compare(long)["contact_temperature"].measured == pytest.approx([293.15])


def test_the_default_step_shows_peaks_and_a_record_of_the_model_itself():
    """A stop of a minute in a day: its peak, and a record by steps of its own, are those of fine steps."""
    day = {
        "time [s]": [0, 40_000, 40_001, 40_060, 40_061, 86_400],
        "sliding_velocity [m/s]": [12, 12, 12, 0, 0, 0],
        "normal_load [N]": [0, 0, 2000, 2000, 0, 0],
    }
    times = np.linspace(39_990, 40_200, 4201)
    fine_day = {name: np.interp(times, day["time [s]"], column) for name, column in day.items()}
    for changes in ({}, {"solver.fidelity": "line", "solver.cells": 9}):
        scene = Scene.load("disc_brake").set(changes)
        result, fine = scene.simulate(day), scene.simulate(fine_day)
        assert result.time.size < 3000
        for name in ("contact_temperature_max", "contact_temperature", "pressure_max", "friction_force"):
            rise = fine[name].max() - fine[name][0]
            assert result.record["variables"][name]["maximum"] == pytest.approx(fine[name].max(), abs=5e-3 * rise), name
        record = {"time [s]": fine.time, "contact_temperature [K]": fine["contact_temperature"]}
        deviation = result.compare(record)["contact_temperature"]
        assert abs(deviation.largest) < 2e-2 * deviation.range, deviation


def test_records_of_wear_are_read_in_any_unit(tmp_path):
    si, other = tmp_path / "si.csv", tmp_path / "other.csv"
    si.write_text("load_N,speed_m_per_s,distance_m,volume_mm3\n10,0.1,1000,0.5\n20,0.2,2000,1.5\n")
    other.write_text("# bench\nvolume [m3],distance [km],load [kN],speed [mm/s]\n5e-10,1,0.01,100\n1.5e-9,2,0.02,200\n")
    first, second = fit.Records.read(si), fit.Records.read(other)
    for name in ("load", "speed", "distance", "volume"):
        assert getattr(first, name) == pytest.approx(getattr(second, name), rel=1e-14), name
    assert first.volume == pytest.approx([5e-10, 1.5e-9])
    for text, told in (
        ("load [N],speed [m/s],distance [m],volume [kg]\n1,1,1,1\n", 'line 1, column 4: "volume [kg]": "kg" is the wrong unit; accepted are m3'),
        ("load [N],speed [m/s],distance [m],volume\n1,1,1,1\n", "does not say its unit; accepted is volume [m3 or mm3 or cm3]"),
        ("load [N],speed [m/s],distance [m],volume [mm3]\n1,1,1\n", "line 2: 3 cells, and the header has 4"),
        ("load [N],speed [m/s],distance [m],volume [mm3]\n1,nan,1,1\n", 'line 2, column 2 (speed [m/s]): "nan"'),
        ("load [N],load_N,distance [m],volume [mm3]\n1,1,1,1\n", "load stands in column 1 already"),
        ("load [N],speed [m/s],distance [m],volume [mm3]\n", "has no row below its header"),
    ):
        si.write_text(text)
        with pytest.raises(Error, match=re.escape(told)):
            fit.Records.read(si)
