"""Designs of the batch examples: distributions, units, continuation, sensitivities; in the environment of these examples."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from conftest import ROOT

BATCH = ROOT / "examples" / "batch"
sys.path.insert(0, str(BATCH))

import design as designs  # noqa: E402  (the path is set first)
import schedules  # noqa: E402
import sensitivity  # noqa: E402
import sweep  # noqa: E402
from sliding_contact import Scene  # noqa: E402


def uniform(name, low, high):
    return designs.Variable(name, "uniform", (("low", low), ("high", high)))


def test_a_larger_design_continues_a_smaller_one():
    small, large, larger = (designs.Design.read(BATCH / "brake_design.csv", scenes, 3) for scenes in (100, 128, 300))
    rows = large.rows()
    assert np.array_equal(small.rows(), rows[:100]) and np.array_equal(rows, larger.rows()[:128])
    for variable, column in zip(large.variables, rows.T):
        low, middle, high = variable.frozen().ppf([0.0, 0.5, 1.0])
        assert low <= column.min() and column.max() <= high
        # Sobol's sequence: each half of the range holds half of the scenes, exactly.
        assert np.count_nonzero(column < middle) == 64
    other = designs.Design.read(BATCH / "brake_design.csv", 100, 4)
    assert small.identity() == large.identity() != other.identity()


def test_sensitivities_of_a_function_with_known_ones():
    # Ishigami and Homma: y = sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 on (-pi, pi)^3.
    variables = tuple(uniform(name, -np.pi, np.pi) for name in ("x1", "x2", "x3"))
    x = designs.Design(variables, 8192, 1).rows()
    y = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    part = 0.1 * np.pi**4
    whole = 49.0 / 8.0 + part / 5.0 + part**2 / 18.0 + 0.5
    exact = np.array([0.5 * (1.0 + part / 5.0) ** 2, 49.0 / 8.0, 0.0]) / whole
    found = sensitivity.analyse(x, y, resamplings=50)
    assert found.first_order == pytest.approx(exact, abs=0.015)
    # The correction for chance exceeds the bias of a design that is spread more evenly than a random one.
    excess = 49.0 / (8192 - 50)
    assert np.all(found.interval[0] <= exact) and np.all(exact <= found.interval[1] + excess)
    assert found.rank_correlation[0] > 0.3 and abs(found.rank_correlation[1]) < 0.05


def test_total_order_indices_of_a_function_with_known_ones():
    # Ishigami and Homma's function as above: x3 matters through its interaction with x1 alone.
    variables = tuple(uniform(name, -np.pi, np.pi) for name in ("x1", "x2", "x3"))
    design, smaller = (designs.TotalOrderDesign(variables, scenes, 1) for scenes in (20_000, 9_000))
    assert (design.groups, smaller.groups) == (2048, 1024)
    x = design.rows()
    assert np.array_equal(smaller.rows(), x[: 5 * smaller.groups])
    y = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    part = 0.1 * np.pi**4
    whole = 49.0 / 8.0 + part / 5.0 + part**2 / 18.0 + 0.5
    interaction = 8.0 * part**2 / 225.0
    first = np.array([0.5 * (1.0 + part / 5.0) ** 2, 49.0 / 8.0, 0.0]) / whole
    total = first + np.array([interaction, 0.0, interaction]) / whole
    # A failed scene takes its group of five with it.
    y[7] = np.nan
    found = sensitivity.analyse_total_order(design, x, y)
    assert found.first_order == pytest.approx(first, abs=0.02) and found.total_order == pytest.approx(total, abs=0.02)
    assert np.all(found.total_interval[0] <= total) and np.all(total <= found.total_interval[1])
    with pytest.raises(ValueError, match="at least 10 scenes"):
        designs.TotalOrderDesign(variables, 9, 1).rows()


TABLE = """\
# A brake in the field.
name,distribution,low,mode,high,mean,standard_deviation,median,s,loc,scale,a,b,c
punch.width [mm],uniform,80,,0.11 m,,,,,,,,,
strip.height,uniform,,,,,,,,10 mm,2 mm,,,
nominal.velocity,triangular,10 km/h,5,36 km/h,,,,,,,,,
nominal.load,triang,,,,,,,,1 kN,4 kN,,,0.25
normal_load.factor,normal,,,,100 %,0.1,,,,,,,
ambient_temperature,norm,,,,,,,,20 degC,5 K,,,
contact.conductance,loguniform,5e3,,1e5,,,,,,,,,
strip.conductivity,reciprocal,,,,,,,,,,42,56,
punch.wear_coefficient,lognormal,,,,,,2e-14,0.5,,,,,
strip.wear_coefficient,lognorm,,,,,,,0.5,,1e-15,,,
"""


def read(folder, text):
    path = folder / "design.csv"
    path.write_text(text)
    return designs.Design.read(path, 1024, 1)


def test_distributions_are_those_of_scipy_in_any_unit(tmp_path):
    design = read(tmp_path, TABLE)
    expected = {
        "punch.width": stats.uniform(0.08, 0.03),
        "strip.height": stats.uniform(0.01, 0.002),
        "nominal.velocity": stats.triang((5 - 10 / 3.6) / (26 / 3.6), 10 / 3.6, 26 / 3.6),
        "nominal.load": stats.triang(0.25, 1e3, 4e3),
        "normal_load.factor": stats.norm(1.0, 0.1),
        "ambient_temperature": stats.norm(293.15, 5.0),
        "contact.conductance": stats.loguniform(5e3, 1e5),
        "strip.conductivity": stats.loguniform(42, 56),
        "punch.wear_coefficient": stats.lognorm(0.5, scale=2e-14),
        "strip.wear_coefficient": stats.lognorm(0.5, scale=1e-15),
    }
    assert design.names == list(expected)
    for column, distribution in zip(design.rows().T, expected.values()):
        assert np.all(np.isfinite(column))
        # Sobol's sequence: the empirical distribution is within a few in a thousand of the distribution.
        assert stats.kstest(column, distribution.cdf).statistic < 4e-3
    # The first half of the sequence may begin at 0, where a normal distribution is infinite.
    assert np.all(np.isfinite(design.variables[4].spread(np.array([0.0, 1.0]))))


@pytest.mark.parametrize(
    "row, parts",
    [
        ("punch.width,uniform,80 kN,0.11,,", ["line 3", "punch.width, low", "80 kN", "accepted are m, mm"]),
        ("punch.width,uniform,wide,0.11,,", ["line 3", "punch.width, low", "wide"]),
        ("punch.width,uniform,0.11,0.08,,", ["line 3", "low = 0.11 must be below high = 0.08"]),
        ("punch.width,uniform,0.08,,,", ["line 3", "is given by low", "low, high or loc, scale"]),
        ("punch.width,uniform,0.08,0.11,0.1,", ["line 3", "low, high, loc", "low, high or loc, scale"]),
        ("punch.width,gamma,0.08,0.11,,", ["line 3", "'gamma'", "uniform, loguniform, triangular, normal, lognormal"]),
        ("punch.width,loguniform,0,0.11,,", ["line 3", "low = 0", "above 0"]),
        ("punch.width,normal,,,0.1,0", ["line 3", "scale = 0 must be above 0"]),
        ("ambient_temperature,normal,,,20 degC,5 degC", ["line 3", "scale", "degC", "accepted are K"]),
        ("normal_load.factor,uniform,heavy,2,,", ["line 3", "normal_load.factor, low", "'heavy' is no number", "as 0.5 or 50 %"]),
        ("normal_load.factor [kN],uniform,1,2,,", ["line 3", "normal_load.factor, low", "'1 kN' is no number"]),
        ("punch.widht,uniform,0.08,0.11,,", ["line 3", "punch.widht", "did you mean punch.width?"]),
        (",uniform,0.08,0.11,,", ["line 3", "name is empty"]),
        ("punch.width,uniform,0.08", ["line 3", "6 cells"]),
        ("punch.width,uniform,1 m,2 m,,\npunch.width,uniform,1 m,2 m,,", ["punch.width stands in two rows"]),
    ],
)
def test_what_is_wrong_in_a_design_is_told_with_its_line(tmp_path, row, parts):
    with pytest.raises(ValueError) as raised:
        read(tmp_path, f"# note\nname,distribution,low,high,loc,scale\n{row}\n")
    assert all(part in str(raised.value) for part in ["design.csv", *parts]), raised.value


def test_wrong_headers_of_a_design_are_told(tmp_path):
    for text, part in (
        ("name,low,high\nx,1,2\n", "no column distribution"),
        ("name,distribution,low,hihg\nx,uniform,1,2\n", "a column 'hihg'"),
        ("", "no column name, distribution"),
        ("name,distribution,low,high\n", "no row"),
    ):
        with pytest.raises(ValueError, match=part):
            read(tmp_path, text)


def test_the_printed_summary_of_a_sweep(capsys):
    indices = {"wear of the punch": {"punch.width": 0.99, "punch.density": -0.02}}
    summary = {"scenes": 1, "failed": 0, "ran_now": 1, "reasons": {}, "results": {}, "files": [], "sensitivities": indices}
    sweep.report(SimpleNamespace(json=False, output=Path("out")), summary)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "1 scene, 0 failed, 1 run now" and lines[-1].endswith("parts")
    assert lines[-3:-1] == [
        "  wear of the punch: punch.width 99 %, punch.density -2 %",
        "  An index near or below 0 % is zero within its interval: noise of the estimator.",
    ]


def test_scenes_that_a_design_leaves_out_are_told():
    variables = tuple(uniform(name, 0.0, 1.0) for name in "abcd")
    told = sweep.left_out(200, designs.TotalOrderDesign(variables, 200, 1))
    assert told.startswith("--scenes 200: ") and told.endswith("192 scenes now, 384 next")
    assert sweep.left_out(192, designs.TotalOrderDesign(variables, 192, 1)) == "" == sweep.left_out(200, designs.Design(variables, 200, 1))


def test_reasons_that_differ_in_numbers_are_one():
    low = "fmi2SetReal: punch.width: {} m is below the minimum 1e-6 m"
    reasons = ["worn through at 3 s", low.format(-0.05), low.format("-2.5e-05"), low.format(-1)]
    assert list(sweep.kinds_of(reasons).items()) == [(low.format(-0.05), 3), ("worn through at 3 s", 1)]


def test_what_tells_two_batches_apart_is_named():
    found = {"seed": 1, "step": 0.1, "variables": "a, b"}
    assert sweep.difference(found, {**found, "step": 0.2}) == "step = 0.1 instead of 0.2"
    assert sweep.difference(found, {"variables": "b, a", "seed": 2, "every": 1.0}) == (
        "seed = 1 instead of 2; step = 0.1 instead of none; every = none instead of 1.0; variables = a, b instead of b, a"
    )
    many = {str(number): number for number in range(6)}
    assert sweep.difference(many, {}).endswith("3 = 3 instead of none; and 2 more")
    assert "another version" in sweep.difference(None, found)


def test_schedules_of_any_scene(tmp_path):
    pin, punch = Scene.load("pin_on_disk"), Scene.load("reciprocating_punch")
    schedule, step, distance = schedules.of_name("nominal", pin)
    assert distance is None and (schedule.times[-1] / step) == pytest.approx(round(schedule.times[-1] / step))
    assert np.all(schedule.values[:, schedule.inputs.index("normal_load")] == pin["nominal.load"])
    schedule, step, _ = schedules.of_name("nominal", punch)
    assert schedule.interpolation == "linear" and np.min(schedule.values) < 0.0 and schedule.times.size > 60
    (tmp_path / "in.csv").write_text("time [min],sliding_velocity [km/h],normal_load [kN]\n1,36,1\n2,18,2\n")
    schedule, step, _ = schedules.of_name(str(tmp_path / "in.csv"), pin)
    assert schedule.times.tolist() == [0.0, 60.0] and schedule.values.tolist() == [[10.0, 1000.0], [5.0, 2000.0]]
    with pytest.raises(ValueError, match="contact.faces = 2.*pin_on_disk has 1"):
        schedules.of_name("udds", pin)
    with pytest.raises(ValueError, match="neither a file nor one of nominal, udds"):
        schedules.of_name("none.csv", pin)
