"""The car with four contact FMUs: examples/vehicle_brake."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import file_of
from example_modules import EXAMPLES, load
from fmpy import read_model_description
from fmpy.ssp.ssd import read_ssd

example = load("vehicle_brake", "drive", "libcosim", "manoeuvres", "master", "report", "ssp", "system", "vehicle_fmu")
GRAVITY = 9.80665


@pytest.fixture(scope="module")
def brake():
    return file_of("disc_brake")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("vehicle")


def run(manoeuvre, brake, folder, step=0.010, **options):
    vehicle = example.vehicle_fmu.pack(folder / "Vehicle.fmu", manoeuvre)
    return example.master.run(
        {"vehicle": vehicle, **{name: brake for name in example.system.BRAKES}},
        example.system.connections(),
        example.system.parameters(manoeuvre, example.drive.start_values(brake)),
        example.system.recorded(),
        manoeuvre.duration,
        step,
        **options,
    )


@pytest.fixture(scope="module")
def cold(brake, folder):
    return run(example.manoeuvres.cold_stop(), brake, folder)


def test_the_vehicle_is_a_valid_fmu(folder):
    path = example.vehicle_fmu.pack(folder / "Vehicle.fmu", example.manoeuvres.hill())
    description = read_model_description(str(path), validate=True)
    starts = {variable.name: variable.start for variable in description.modelVariables}
    assert float(starts["mass"]) == 1500.0
    assert [variable.valueReference for variable in description.modelVariables] == list(range(len(starts)))


def test_what_the_car_loses_its_brakes_turn_into_heat(cold, brake, folder):
    begin = example.manoeuvres.cold_stop().parameters["stop_time"]
    rows = cold.time >= begin
    position, speed = cold["vehicle", "position"][rows], cold["vehicle", "speed"][rows]
    resistance = 0.012 * 1500.0 * GRAVITY + 0.5 * 1.2 * 0.66 * speed**2
    kinetic = 0.5 * (1500.0 + 45.0) * speed[0] ** 2
    # The driver lets go of the throttle within tenths of a second.
    driven = np.trapezoid(cold["vehicle", "drive_force"][rows], position)
    work = np.diff(cold["vehicle", "brake_work"][rows]).sum() + np.trapezoid(resistance, position) - driven
    assert work == pytest.approx(kinetic, rel=2e-3)
    # A contact receives the speed of the last communication point: the error is proportional to the step.
    error = example.report.coupling_error(cold)
    assert 0.0 < error < 0.02
    finer = example.report.coupling_error(run(example.manoeuvres.cold_stop(), brake, folder, 0.005))
    assert error / finer == pytest.approx(2.0, rel=0.05)
    assert example.report.balance_error(cold) < 1e-9


def test_extrapolated_inputs_make_the_coupling_error_one_of_second_order(cold, brake, folder):
    manoeuvre = example.manoeuvres.cold_stop()
    coarse, fine = (
        abs(example.report.coupling_error(run(manoeuvre, brake, folder, step, extrapolate=True))) for step in (0.02, 0.01)
    )
    assert fine < 0.05 * example.report.coupling_error(cold)
    assert coarse / fine > 3.0


def test_load_moves_to_the_front_axle_in_braking(cold):
    steady = (cold["vehicle", "speed"] > 2.0) & (cold["vehicle", "speed"] < 10.0)
    front = cold["vehicle", "front_axle_load"][steady]
    expected = 1500.0 * (GRAVITY * 1.54 - cold["vehicle", "acceleration"][steady] * 0.55) / 2.65
    assert front == pytest.approx(expected, rel=5e-3)
    total = front + cold["vehicle", "rear_axle_load"][steady]
    assert total == pytest.approx(1500.0 * GRAVITY, rel=1e-12)
    # Weaker linings at the front right pull to the left.
    assert np.all(cold["vehicle", "side_difference"][steady] > 0.0)


def test_brakes_that_come_hot_from_a_descent_stop_later(cold, brake, folder):
    manoeuvre = example.manoeuvres.descent()
    hot = run(manoeuvre, brake, folder, 0.020)
    before = example.report.stop_figures(cold, example.manoeuvres.cold_stop().parameters["stop_time"])
    after = example.report.stop_figures(hot, manoeuvre.parameters["stop_time"])
    assert before["distance_m"] == pytest.approx(33.3, abs=0.5)
    assert after["speed_km_per_h"] == pytest.approx(80.0, abs=0.2)
    # Distance and friction go together: distances as the inverse of the mean deceleration.
    friction = 0.5 * (after["front_friction_lowest"] + after["rear_friction_lowest"]) / 0.4
    assert 1.2 < after["distance_m"] / before["distance_m"] < 1.0 / friction
    assert after["front_disc_before_degC"] > 350.0


def test_the_driver_follows_the_cycle(brake, folder):
    manoeuvre = example.manoeuvres.cycle(EXAMPLES / "data" / "udds.csv", duration=150.0)
    recording = run(manoeuvre, brake, folder)
    figures = example.report.cycle_figures(recording)
    assert figures["speed_error_rms_km_per_h"] < 0.5
    assert figures["distance_km"] == pytest.approx(np.trapezoid(recording["vehicle", "reference_speed"], recording.time) / 1e3, rel=5e-3)
    # It stands at traffic lights, and there the brakes make no heat.
    stands = recording.time > 135.0
    assert np.all(recording["vehicle", "is_locked"][stands] == 1.0)
    assert np.ptp(recording["front_left", "dissipated_energy"][stands]) == 0.0


@pytest.mark.parametrize("grade", [-0.10, 0.10])
def test_it_stands_on_a_ten_percent_grade_for_a_minute(brake, folder, grade):
    recording = run(example.manoeuvres.hill(grade), brake, folder)
    figures = example.report.hill_figures(recording)
    assert figures["seconds"] == 60.0
    assert figures["drift_mm"] < 1.0


def test_it_rolls_where_the_driver_presses_too_little(brake, folder):
    manoeuvre = example.manoeuvres.hill(seconds=20.0)
    manoeuvre = replace(manoeuvre, parameters=manoeuvre.parameters | {"hold_reserve": 0.5})
    recording = run(manoeuvre, brake, folder)
    # It comes to rest, and does not remain at rest.
    assert example.report.hill_figures(recording, seconds=10.0)["drift_mm"] > 100.0


def test_a_scene_that_is_no_brake_is_refused():
    starts = example.drive.start_values(file_of("pin_on_disk"))
    with pytest.raises(ValueError, match="no front brake"):
        example.system.parameters(example.manoeuvres.hill(), starts)


def test_libcosim_runs_the_ssp_package_to_the_same_trajectory(cold, brake, folder):
    manoeuvre = example.manoeuvres.cold_stop()
    package = folder / "vehicle_brake.ssp"
    parameters = example.system.parameters(manoeuvre, example.drive.start_values(brake))
    example.ssp.pack(package, brake, example.system.connections(), parameters, manoeuvre, 0.010)
    # Checked against the schemas of SSP 1.0.
    components = {component.name for component in read_ssd(str(package)).system.elements}
    assert components == {"vehicle", *example.system.BRAKES}
    try:
        other = example.libcosim.run(package, example.system.recorded(), manoeuvre.duration, 0.010)
    except example.libcosim.NotInstallable as reason:
        pytest.skip(f"libcosimpy cannot be installed here: {reason}")
    error, where = example.libcosim.difference(cold, other)
    assert error <= 1e-12, where
