"""The axes of the figure of a simulation."""

import pytest

pytest.importorskip("matplotlib")

from sliding_contact import _figure  # noqa: E402


def panel(*curves, measured=()):
    series = [{"x": [0.0, 0.5, 50.0, 100.0], "y": y, "name": str(y), "colour": 0, "measured": False} for y in curves]
    series += [{"x": [50.0], "y": [y], "name": "", "colour": 0, "measured": True} for y in measured]
    return {"x": "x (mm)", "y": "pressure (MPa)", "series": series}


def drawn(content, over_time):
    axis = _figure.plt.figure().subplots()
    _figure.draw(axis, content, over_time)
    top, texts = axis.get_ylim()[1], [text.get_text() for text in axis.texts]
    _figure.plt.close("all")
    return top, texts


def test_the_peak_of_the_start_leaves_the_axis_and_is_told():
    assert drawn(panel([567.0, 30.0, 3.0, 2.9]), True) == (6.0, ["peak 567"])
    # Over the contact one distribution is that of the start.
    assert drawn(panel([0.0, 1.0, 2.0, 57.0], [3.0, 3.0, 3.0, 3.0], [2.9, 3.0, 3.1, 3.0]), False) == (6.2, ["peak 57"])


def test_other_peaks_are_drawn():
    for content, over_time in (
        (panel([0.0, 1.0, 60.0, 2.0]), True),  # a peak of the load
        (panel([60.0, 50.0, 20.0, 2.0]), True),  # a decay over all of the time
        (panel([567.0, 30.0, 3.0, 2.9], measured=[300.0]), True),  # a record is drawn whole
        (panel([0.0, 1.0, 60.0, 57.0]), False),  # one distribution alone
        (panel([3.0, 30.0, 60.0, 57.0], [0.0, 0.0, 0.0, 0.0]), False),  # the others have no load
        (panel([567.0, 30.0, -3.0, -2.9]), True),
    ):
        top, texts = drawn(content, over_time)
        assert top > 59.0 and not texts, content


def test_hundreds_of_strokes_are_drawn_as_their_range():
    steps = 4000
    strokes = [(1.0 + 0.5 * step / steps) * (1.0, 0.0, -1.0, 0.0)[step % 4] for step in range(steps + 1)]
    assert _figure.turns(strokes) == steps // 2 - 1
    assert _figure.turns([1.0, 1.0 + 1e-6] * 1000) == 0 and _figure.turns([0.0] * 1000) == 0
    at, low, high = _figure.extremes([0.1 * step for step in range(steps + 1)], strokes)
    assert (at[0], at[-1], len(at)) == (0.0, 400.0, _figure.INTERVALS + 1)
    assert low[-1] < -1.49 and high[-1] == 1.5 and high[1] < 1.01 and low[1] > -1.01
    few = strokes[:200]
    for y, filled in ((strokes, 1), (few, 0)):
        series = {"x": [float(index) for index in range(len(y))], "y": y, "name": "velocity", "colour": 0, "measured": False}
        axis = _figure.plt.figure().subplots()
        _figure.draw(axis, {"x": "time (s)", "y": "velocity (mm/s)", "series": [series]}, True)
        assert (len(axis.collections), len(axis.lines)) == (filled, 1 - filled)
        assert axis.get_legend_handles_labels()[1] == ["velocity, range" if filled else "velocity"]
        _figure.plt.close("all")
