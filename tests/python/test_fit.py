"""Fits of parameters: what they find, what they name as not determined, what their intervals assume."""

import json
import warnings

import numpy as np
import pytest

pytest.importorskip("scipy")

from sliding_contact import Error, Interrupted, Scene, SceneWarning, fit  # noqa: E402  (skipped without scipy)

import intervals  # noqa: E402
from conftest import ROOT  # noqa: E402

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def pin(**values):
    return Scene.load("pin_on_disk").set({"solver.fidelity": "lumped", **values})


def archard(noise=0.0, loads=(5.0, 10.0, 20.0, 40.0), speed=0.1):
    """Volumes k F s p0 (p/p0)^b / p of a pin without heat: exact at the lumped level."""
    scene = pin()
    load = np.repeat(loads, 3)
    one = np.ones(load.size)
    area = scene["punch.width"] * scene["depth"]
    volume = 1.2e-14 * 1e6 * (load / area / 1e6) ** 1.3 * area * 1000.0
    return fit.Records(load, speed * one, 1000.0 * one, volume * np.exp(np.random.default_rng(5).normal(0.0, 1.0, load.size) * noise))


def test_a_power_law_is_found_and_its_interval_is_that_of_a_straight_line():
    records = archard(0.1)
    found = pin().fit(records)
    assert found.names == (fit.COEFFICIENT, fit.PRESSURE_EXPONENT) and found.undetermined == {}
    # ln V over ln F is a straight line: least squares and Student's t of the textbook.
    line = np.polyfit(np.log(records.load), np.log(records.volume), 1)
    apart = np.log(records.volume) - np.polyval(line, np.log(records.load))
    deviation = np.sqrt(np.sum(apart**2) / (apart.size - 2))
    error = deviation / np.sqrt(np.sum((np.log(records.load) - np.log(records.load).mean()) ** 2))
    assert found.values[1] == pytest.approx(line[0], abs=1e-2 * error)
    assert found.scatter == pytest.approx(deviation, rel=1e-3)
    assert found.intervals[1, 1] - found.values[1] == pytest.approx(2.228 * error, rel=1e-2)  # t of 10 degrees of freedom
    # From a coefficient that is a hundred times too large too: the exponent must not end at the bound of its range.
    far = pin().fit(fit.Records(records.load, records.speed, records.distance, 1e-2 * records.volume))
    assert far.values == pytest.approx(found.values * [1e-2, 1.0], rel=1e-3)
    exact = pin().fit(archard())
    assert exact.values == pytest.approx([1.2e-14, 1.3], rel=1e-3)


def test_a_value_that_ran_to_where_it_has_no_effect_is_not_determined():
    # Convection of a pin that friction hardly warms: with this noise the best value is 0, or as large as the scene takes.
    time = np.arange(0.0, 300.1, 3.0)
    drive = {"time [s]": time, "sliding_velocity [m/s]": np.where(time < 220.0, 0.1, 0.2), "normal_load [N]": np.where(time < 150.0, 10.0, 20.0)}
    own = {"punch.top_thermal": "convecting"}
    truth = pin(**own, **{"punch.convection": 60.0}).simulate(drive)
    force, rise = (np.interp(time, truth["time"], truth[name]) for name in ("friction_force", "contact_temperature [degC]"))
    names = ["contact.friction_coefficient", "punch.convection"]
    for seed in range(1003, 1011):
        random = np.random.default_rng(seed)
        record = {**drive, "friction_force [N]": force + random.normal(0.0, 0.2, time.size), "contact_temperature [degC]": rise + random.normal(0.0, 3.0, time.size)}
        found = pin(**own).fit(record, names)
        assert "contact.friction_coefficient" in found.names and np.all(np.isfinite(found.intervals)), seed
        assert set(found.undetermined) | set(found.names) == set(names)


def test_what_the_records_do_not_determine_is_named_and_kept():
    names = [fit.COEFFICIENT, fit.PRESSURE_EXPONENT, fit.VELOCITY_EXPONENT, "punch.conductivity"]
    found = pin().fit(archard(0.1), names)
    assert found.names == tuple(names[:2]), found.undetermined
    assert found.undetermined[fit.VELOCITY_EXPONENT].startswith(f"changes the records as {fit.COEFFICIENT}; 1 is kept")
    assert found.undetermined["punch.conductivity"].startswith("does not change the records")
    assert "not determined: does not change" in str(found)
    # The order says which of two is fitted.
    assert pin().fit(archard(0.1), names[2::-1]).names == (fit.VELOCITY_EXPONENT, fit.PRESSURE_EXPONENT)
    # One load: the exponent cannot be told.
    assert fit.PRESSURE_EXPONENT in pin().fit(archard(0.1, loads=(10.0,))).undetermined
    with pytest.raises(Error, match="the records determine none of the parameters: punch.conductivity: does not change"):
        pin().fit(archard(0.1), "punch.conductivity")


def drag(name="friction_force", count=40, error=0.0):
    """A brake that drags: the friction force is 2 mu F, whatever the rest."""
    times = np.linspace(1.0, 30.0, count)
    inputs = {"time [s]": [0.0, 31.0], "sliding_velocity [m/s]": 1.0, "normal_load [N]": 1000.0}
    result = brake().simulate(inputs)
    return fit.Test(inputs, {name: (times, np.interp(times, result.time, result[name]) + error)})


def brake():
    return Scene.load("disc_brake").set({"solver.fidelity": "lumped"})


def test_histories_of_several_quantities_and_tests_at_once():
    scene, tests, truth = intervals.CASES["lumped, below, histories"]()
    clean = fit.Model(scene, tests(None, None)).predict(truth)
    told = []
    model = fit.Model(scene, tests(clean, np.random.default_rng(1)))
    found = fit.fit(model, tuple(truth), progress=told.append)
    assert found.names == tuple(truth)
    for value, low, high, exact in zip(found.values, *found.intervals, truth.values()):
        assert low < exact < high and high < 1.5 * low, (value, exact)
    for own in found.scatters:
        assert own.estimated and own.deviation == pytest.approx(intervals.NOISE[own.name], rel=0.35), own
    assert len(told) > 2 and "runs, sum of squares" in told[0]
    record = json.loads(json.dumps(found.record()))
    assert record["scales"]["strip.convection"] == "logarithm" and np.shape(record["covariance"]) == (3, 3)


def test_correlated_residuals_count_as_fewer_and_widen_the_interval():
    random = np.random.default_rng(3)
    white = random.normal(0.0, 20.0, 400)
    slow = np.zeros(400)
    for at in range(1, 400):
        slow[at] = 0.9 * slow[at - 1] + np.sqrt(1.0 - 0.9**2) * white[at]
    widths = []
    for error in (white, slow):
        found = fit.fit(fit.Model(brake(), drag(count=400, error=error)), "contact.friction_coefficient", companion=False)
        widths.append(np.log(found.intervals[1, 0] / found.intervals[0, 0]))
    assert found.scatters[0].independent == pytest.approx(400 * 0.1 / 1.9, rel=0.5)
    assert widths[1] / widths[0] == pytest.approx(np.sqrt(1.9 / 0.1), rel=0.35)
    # A known standard deviation is not estimated.
    found = fit.fit(fit.Model(brake(), drag(count=400, error=white)), "contact.friction_coefficient", scatter={"friction_force": 40.0}, companion=False)
    assert not found.scatters[0].estimated and np.log(found.intervals[1, 0] / found.intervals[0, 0]) == pytest.approx(2.0 * widths[0], rel=0.1)


def test_files_of_a_rig_with_gaps_and_end_values_are_fitted_together(tmp_path):
    scene = brake().set("contact.friction_coefficient", 0.33)
    inputs = {"time [s]": np.linspace(0.0, 60.0, 61), "sliding_velocity [m/s]": 2.0, "normal_load [N]": 2000.0}
    run = scene.simulate(inputs)
    at = np.searchsorted(run.time, inputs["time [s]"])
    rows = ["Time [s];Speed [m/s];Load [N];Friction force [N];Disc temp [°C];Room"]
    for row, index in enumerate(at):
        force = f"{run['friction_force'][index]:.2f}" if row % 3 else ""
        rows.append(f"{row};2,0;2000;{force};{run['strip.mean_temperature [degC]'][index]:.3f};5".replace(".", ","))
    history, ends = tmp_path / "drag.csv", tmp_path / "ends.csv"
    history.write_bytes("\n".join(rows).encode("latin-1"))
    worn = [scene.simulate({"time [s]": [0.0, 500.0 / speed], "sliding_velocity [m/s]": speed, "normal_load [N]": 1000.0})["wear_volume_punch"][-1] for speed in (1.0, 2.0)]
    ends.write_text("load [N],speed [m/s],distance [m],volume [mm3],Room\n" + "".join(f"1000,{speed},500,{1e9 * own},5\n" for speed, own in zip((1, 2), worn)))
    start = scene.copy().set({"contact.friction_coefficient": 0.4, "punch.wear_coefficient": 2.0 * scene["punch.wear_coefficient"]})
    with pytest.warns(SceneWarning, match='left out are "Room"'):
        found = start.fit([history, ends], ["contact.friction_coefficient", "punch.wear_coefficient"])
    assert found.values == pytest.approx([0.33, scene["punch.wear_coefficient"]], rel=2e-3)
    assert [own.values for own in found.scatters] == [40, 61, 2]


def test_draws_have_the_joint_distribution():
    found = pin().fit(archard(0.1))
    drawn = found.draw(4000, seed=2)
    points = np.array([np.log(drawn[fit.COEFFICIENT] / found.values[0]), drawn[fit.PRESSURE_EXPONENT] - found.values[1]])
    freedom = found.degrees_of_freedom
    # The covariance of Student's t is that of its shape times n/(n - 2).
    assert np.cov(points) == pytest.approx(found.covariance * freedom / (freedom - 2.0), rel=0.15)
    low, high = np.percentile(drawn[fit.PRESSURE_EXPONENT], [2.5, 97.5])
    assert [low, high] == pytest.approx(found.intervals[:, 1], abs=0.1 * (high - low))
    assert np.array_equal(found.draw(10)[fit.COEFFICIENT], found.draw(10)[fit.COEFFICIENT])


def test_a_wrong_fit_is_refused():
    records = archard(0.1)
    for wrong, text in (
        (lambda: pin().fit(3), "records: int is no file, no table"),
        (lambda: pin().fit(records, 3), "parameters = 3: accepted are the name of a variable and lists of them"),
        (lambda: pin().fit(records, []), "at least one, and each once"),
        (lambda: pin().fit(records, (fit.COEFFICIENT, fit.COEFFICIENT)), "each once"),
        (lambda: pin().fit(records, "punch.wear_coeficient"), "did you mean punch.wear_coefficient"),
        (lambda: pin().fit(records, "punch.body"), "punch.body is no single number"),
        (lambda: pin().fit(records, "normal_load"), "normal_load is an input, which the records give"),
        (lambda: pin().fit(records, "contact.friction_fade.factor"), "contact.friction_fade.factor[1]"),
        (lambda: pin(**{"punch.wear_coefficient": 0.0, "strip.wear_coefficient": 1e-14}).fit(records), "punch.wear_coefficient is 0 in the scene"),
        (lambda: pin().fit(records, confidence=95), "confidence = 95 must be above 0 and below 1"),
        (lambda: pin().fit(records, scatter={"wear_depth": 1.0}), "scatter: wear_depth = 1.0 must be above 0 and of a measured output: wear_volume_punch"),
        (lambda: pin().fit(fit.Records([1.0, 2.0], [0.1, 0.1], [1.0, 1.0], [1e-12, 2e-12])), "2 values do not determine 2 parameters"),
        (lambda: fit.Records([1.0, 2.0], [1.0], [1.0, 1.0], [1.0, 1.0]), "records: speed has 1 values, load 2"),
        (lambda: fit.Records([1.0, 2.0], [1.0, 1.0], [1.0, 1.0], [1.0, -1.0]), "records: volume[1] = -1 must be a finite number above 0"),
        (lambda: pin().fit({"time [s]": [0, 1], "sliding_velocity [m/s]": 1.0}), "no measured value of an output"),
        (lambda: pin().fit({"load [N]": [5, 9, 12], "speed [m/s]": 0.1, "distance [m]": 1e3, "wear_volume_strip [mm3]": 1}), "gives no wear_volume_strip where some"),
        (lambda: pin().fit("nothing.csv"), "nothing.csv"),
    ):
        with pytest.raises(Error) as raised:
            wrong()
        assert text in str(raised.value), (text, str(raised.value))


# `python intervals.py` has all cases and 100 sets of each.
@pytest.mark.parametrize("case, sets", [("lumped, below, end values", 100), ("lumped, above, end values", 20), ("lumped, below, histories", 20), ("line, above, end values", 20)])
def test_intervals_hold_the_truth(case, sets):
    # Fewer than 16 of 20 intervals of 95 %, or than 90 of 100, hold with a probability of 0.003 and 0.01.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert np.all(intervals.inside(case, sets, first=1000) >= (90 if sets == 100 else 16))


def test_the_fit_of_the_records_of_the_examples_finds_their_truth(monkeypatch):
    folder = ROOT / "examples" / "batch" / "records"
    monkeypatch.syspath_prepend(str(folder))
    import make_records

    records = fit.Records.read(folder / "pin_on_disk.csv")
    model = fit.Model(make_records.scene(), records)
    found = fit.fit(model)
    for name, value, low, high in zip(found.names, found.values, *found.intervals):
        assert low < make_records.TRUTH[name] < high and (high - low) / value < 0.15, name
    assert found.scatter == pytest.approx(make_records.SCATTER, rel=0.3)
    # The committed records equal those of the script.
    made = model.predict(make_records.TRUTH) * np.exp(make_records.noise(make_records.SEED))
    assert records.volume == pytest.approx(made, rel=1e-3)


def test_a_picture_of_a_law_and_of_histories(tmp_path):
    pytest.importorskip("matplotlib")
    pin().fit(archard(0.1)).plot(tmp_path / "law.svg")
    fit.fit(fit.Model(brake(), drag(error=np.arange(40.0))), "contact.friction_coefficient", companion=False).plot(tmp_path / "history.svg")
    assert (tmp_path / "law.svg").stat().st_size > 5000 and (tmp_path / "history.svg").stat().st_size > 5000
    names = ["friction_force", "contact_temperature", "strip.mean_temperature", "wear_depth_punch"]
    series = {name: own for each in names for name, own in drag(each).measured.items()}
    drawn = fit.fit(fit.Model(brake(), fit.Test(drag().inputs, series)), "contact.friction_coefficient", companion=False).plot()
    assert [axis.get_ylabel().split(" (")[0].replace(" ", "_") for axis in drawn.axes] == names


def test_a_fit_runs_the_scene_as_it_is():
    parameters = {fit.COEFFICIENT: 1.2e-14, fit.PRESSURE_EXPONENT: 1.3}
    records = archard(loads=(5.0, 40.0))
    for settings in ({"solver.fidelity": "lumped"}, {"solver.fidelity": "line", "solver.cells": 5, "solver.tolerance": 1e-2}):
        scene = Scene.load("pin_on_disk").set(settings)
        model = fit.Model(scene, records)
        own = scene.copy().set(parameters)
        for load, volume in zip(records.load, model.predict(parameters)):
            run = own.simulate({"time [s]": [0, 1e4], "sliding_velocity [m/s]": 0.1, "normal_load [N]": load}, step=200.0)
            assert volume == run["wear_volume_punch"][-1], settings
        assert settings["solver.fidelity"] in str(model)


def test_the_hottest_temperature_of_a_fit_stands_beside_that_on_half_the_cells():
    scene = Scene.load("disc_brake").set({"solver.fidelity": "line", "solver.cells": 9, "solver.tolerance": 1e-2})
    inputs = {"time [s]": [0.0, 20.0], "sliding_velocity [m/s]": 12.0, "normal_load [kN]": 4.0}
    found = scene.fit({**inputs, "friction_force [N]": 3000.0}, "contact.friction_coefficient")
    scene.set(dict(zip(found.names, found.values)))
    highest = [scene.set("solver.cells", cells).simulate(inputs)["contact_temperature_max [degC]"].max() for cells in (9, 5)]
    assert highest[1] != pytest.approx(highest[0], abs=1.0)
    said = f"highest contact temperature, degC: {highest[0]:.0f} (5 cells: {highest[1]:.0f}"
    assert said in str(found), (said, str(found))


def test_an_interrupted_fit_has_what_it_found_and_goes_on_from_there():
    lines = []

    def stop(line):
        lines.append(line)
        if len(lines) == 3:
            raise KeyboardInterrupt

    records = archard(0.1)
    far = pin(**{fit.COEFFICIENT: 2e-13})
    with pytest.raises(Interrupted, match=f"after .* runs; so far {fit.COEFFICIENT} = .*: set these and fit again to go on") as stopped:
        far.fit(records, progress=stop)
    found = stopped.value.result
    assert set(found) == {fit.COEFFICIENT, fit.PRESSURE_EXPONENT} and found[fit.COEFFICIENT] < 1e-13
    assert far.set(found).fit(records).values == pytest.approx(pin().fit(records).values, rel=1e-3)


def test_columns_of_other_names_are_fitted(tmp_path):
    path = tmp_path / "ends.csv"
    path.write_text("Kraft [N],speed [m/s],distance [m],Abtrag [mm3]\n" + "".join(f"{load},0.1,1000,{0.02 * load}\n" for load in (5, 10, 20, 40)))
    columns = {"Kraft": "load", "Abtrag": "volume"}
    assert pin().fit(path, columns=columns).values[1] == pytest.approx(1.0, abs=1e-3)
    history = {"t [s]": np.linspace(0.0, 30.0, 40), "v [m/s]": 1.0, "normal_load [N]": 1000.0, "Reibung [N]": 700.0}
    found = brake().fit(history, "contact.friction_coefficient", columns={"v": "sliding_velocity", "Reibung": "friction_force"})
    assert found.values == pytest.approx([0.35], rel=1e-3)
