"""Batches: a row for every scene of a design or of a fit, wear life, percentiles, what fails and what is interrupted."""

import re

import numpy as np
import pytest

from conftest import STOP
from sliding_contact import Batch, Error, Interrupted, Scene, fit

pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def test_rows_are_the_scenes_of_the_design():
    scene = Scene.load("disc_brake")
    design = {"punch.width [mm]": [80, 100], "punch.wear_coefficient": ["1e-5 mm3/(N.m)", 2e-14], "solver.fidelity": ["lumped", "lumped"]}
    table = scene.batch(design, STOP)
    for row, (width, coefficient) in enumerate(((0.08, 1e-14), (0.1, 2e-14))):
        own = scene.copy().set({"punch.width": width, "punch.wear_coefficient": coefficient}).simulate(STOP)
        assert table["punch.width"][row] == width and table["punch.wear_coefficient"][row] == pytest.approx(coefficient)
        assert table["wear_depth_punch"][row] == own["wear_depth_punch"][-1]
        assert table["contact_temperature_max.peak [degC]"][row] == pytest.approx(own["contact_temperature_max [degC]"].max())
        # By the wear of a pass; of the disc, which wears less, the limit is later.
        assert table["life"][row] == pytest.approx(scene["punch.wear_limit"] / own["wear_depth_punch"][-1])
    assert table.percentiles("wear_depth_punch [um]", [0, 100]).tolist() == sorted(table["wear_depth_punch [um]"])
    pandas = pytest.importorskip("pandas")
    assert isinstance(table.frame(), pandas.DataFrame) and "life [1]" in table.frame()
    again = scene.batch(pandas.DataFrame(design), STOP)
    assert all(np.array_equal(again[name], table[name]) for name in table)


def test_a_fit_is_passed_on_as_a_joint_distribution():
    pytest.importorskip("scipy")
    pin = Scene.load("pin_on_disk").set({"solver.fidelity": "lumped", "punch.wear_limit": "1 mm", "nominal.duration": "100 s"})
    random = np.random.default_rng(1)
    load = np.repeat([5.0, 10.0, 20.0], 4)
    one = np.ones(load.size)
    found = pin.fit(fit.Records(load, 0.1 * one, 1000.0 * one, 1e-13 * load * np.exp(random.normal(0.0, 0.1, load.size))))
    table = pin.batch(found, count=400)
    low, middle, high = table.percentiles("wear_depth_punch", (2.5, 50.0, 97.5))
    # The law at the nominal load: log-linear in coefficient and exponent, so its quantiles are those of Student's t.
    from scipy import stats

    pressure = pin["nominal.load"] / (pin["punch.width"] * pin["depth"]) / 1e6
    direction = np.array([1.0, np.log(pressure)])
    width = stats.t.ppf(0.975, found.degrees_of_freedom) * np.sqrt(direction @ found.covariance @ direction)
    assert np.log(high / low) == pytest.approx(2.0 * width, rel=0.15)
    best = pin.copy().set(found.parameters()).simulate()["wear_depth_punch"][-1]
    assert middle == pytest.approx(best, rel=0.02)
    assert table.percentiles("life", (50.0,))[0] == pytest.approx(1e-3 / middle, rel=0.01)


def test_what_fails_is_a_row_with_its_reason_and_what_is_wrong_is_refused():
    scene = Scene.load("disc_brake")
    table = scene.batch({"punch.width": [0.08, -1.0]}, STOP)
    assert list(table.reasons) == [1] and "punch.width" in table.reasons[1]
    assert np.isnan(table["wear_depth_punch"][1]) and np.isnan(table["life"][1]) and table["wear_depth_punch"][0] > 0.0
    for wrong, text in (
        (lambda: scene.batch({"punch.width": [-1.0, -2.0]}, STOP), "every scene failed, the first for: setting punch.width=-1"),
        (lambda: scene.batch({"punch.widht": [1.0]}), "did you mean punch.width"),
        (lambda: scene["contact.frction"], "did you mean contact.friction_coefficient"),
        (lambda: scene["no such thing"], "no such thing is no variable of the scene; `variables` has the names"),
        (lambda: scene.batch({"punch.width": [0.08], "depth": [0.05, 0.06]}), "design: depth has 2 rows"),
        (lambda: scene.batch({"punch.width": 0.08}), "design: punch.width has 0 rows"),
        (lambda: scene.batch({}), "design: there is no column"),
        (lambda: scene.batch(3), "design: int is no table"),
        (lambda: table["nothing"], "there is no column 'nothing'; `units` has the names"),
        (lambda: table["wear_depht"], "there is no column 'wear_depht'; did you mean wear_depth"),
    ):
        with pytest.raises(Error, match=re.escape(text)):
            wrong()


def test_an_interrupted_batch_has_the_scenes_that_are_done():
    def stop(part):
        if part > 0.2:
            raise KeyboardInterrupt

    width = np.linspace(0.08, 0.1, 40)
    with pytest.raises(Interrupted, match="`result` has .* of 40 scenes") as stopped:
        Scene.load("disc_brake").batch({"punch.width": width}, STOP, progress=stop)
    table = stopped.value.result
    assert isinstance(table, Batch) and 8 < table.scenes.size < 40
    assert np.array_equal(table["punch.width"], width[table.scenes]) and np.all(table["wear_depth_punch"] > 0.0)
    # It goes on from there, to what it had been without a break.
    parts = []
    whole = Scene.load("disc_brake").batch({"punch.width": width}, STOP, done=table, progress=parts.append)
    assert parts[0] >= table.scenes.size / 40 and np.array_equal(whole.scenes, np.arange(40))
    own = Scene.load("disc_brake").batch({"punch.width": width}, STOP)
    assert all(np.array_equal(whole[name], own[name]) for name in own)
    for name, others in (("disc_brake", width + 1e-3), ("clutch", width)):
        with pytest.raises(Error, match="done: its scenes are others"):
            Scene.load(name).batch({"punch.width": others}, STOP, done=table)
