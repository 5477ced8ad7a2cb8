"""The axes of the figure of a simulation."""

import re

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


def content(courses, constants=()):
    """A figure of panels over the time with these names of curves each, and one panel over the contact."""
    time = [0.1 * step for step in range(101)]

    def course(names, measured):
        series = [{"x": time, "y": [index + 0.01 * t for t in time], "name": name, "colour": index, "measured": False} for index, name in enumerate(names)]
        points = [{"x": [1.0, 2.0], "y": [0.5, 0.6], "name": "", "colour": 0, "measured": True}] if measured else []
        return {"x": "time (s)", "y": "sliding velocity (mm/s)", "series": series + points, "strokes": []}

    return {"title": "a run", "constants": list(constants), "courses": [course(*own) for own in courses], "profiles": [panel([1.0, 2.0, 3.0, 2.0]) | {"strokes": []}]}


ENERGY = ["friction heat", "stored", "lost: air", "lost: punch top", "lost: strip base", "another one that is long"]


@pytest.mark.parametrize("count", [1, 2, 3, 6, 7])
def test_no_legend_is_cut_off_and_no_panel_shrinks(count):
    courses = [(["punch"], True), (ENERGY, True), ([""], False)] * 3
    with _figure.plt.rc_context(_figure.STYLE):
        figure = _figure.figure_of(content(courses[:count], ["normal load 10 kN"]))
        figure.canvas.draw()
    axes = [axis for axis in figure.get_axes() if axis.get_xlabel() != "x (mm)" and axis.lines]
    assert len(axes) == count
    renderer = figure.canvas.get_renderer()
    page = figure.bbox
    boxes = [axis.get_window_extent(renderer) for axis in axes]
    texts = [axis.yaxis.label.get_window_extent(renderer) for axis in axes] + [figure._suptitle.get_window_extent(renderer)]
    legends = [axis.get_legend().get_window_extent(renderer) for axis in axes if axis.get_legend()]
    for box in [*boxes, *texts, *legends]:
        assert page.x0 - 1 <= box.x0 and box.x1 <= page.x1 + 1 and page.y0 - 1 <= box.y0 and box.y1 <= page.y1 + 1
    for box in legends + texts:
        assert not any(box.overlaps(other) for other in boxes), box
    # Two columns, of which each has more than a third of the page.
    assert all(box.width > 0.35 * page.width for box in boxes)
    assert "normal load 10 kN" in figure._suptitle.get_text()
    _figure.plt.close("all")


def test_the_last_two_of_hundreds_of_strokes_are_drawn_beside_their_range():
    steps = 4000
    course = {"x": [float(step) for step in range(steps)], "y": [(1.0, 0.0, -1.0, 0.0)[step % 4] for step in range(steps)], "name": "", "colour": 0, "measured": False}
    last = {**course, "x": course["x"][-9:], "y": course["y"][-9:]}
    record = {**last, "measured": True}
    own = content([([""], False)] * 4)
    own["courses"][0] |= {"series": [course], "strokes": [last, record]}
    own["courses"][1] |= {"series": [course | {"name": name} for name in ENERGY], "strokes": [last]}
    with _figure.plt.rc_context(_figure.STYLE):
        figure = _figure.figure_of(own)
        figure.canvas.draw()
    texts = [(axis, text) for axis in figure.get_axes() for text in axis.texts]
    assert [text.get_text() for _, text in texts] == ["last two strokes: 8 s"]
    assert [list(line.get_ydata()) for line in texts[0][0].lines] == [last["y"], last["y"]]
    # It stands beside every legend of the column.
    legends = [axis.get_legend().get_window_extent() for axis in figure.get_axes() if axis.get_legend()]
    assert len(legends) > 1 and not any(box.overlaps(texts[0][1].get_window_extent()) for box in legends)
    _figure.plt.close("all")


def test_a_loop_has_room_on_both_sides():
    own = panel([0.0, 1.0, 2.0, 3.0])
    own["series"][0] |= {"x": [-1.0, 1.0, 1.0, -1.0]}
    axis = _figure.plt.figure().subplots()
    _figure.draw(axis, own)
    assert axis.get_xlim() == pytest.approx((-1.06, 1.06))
    _figure.plt.close("all")


def test_measured_points_at_the_ends_of_a_run_are_drawn_whole():
    own = panel([0.0, 1.0, 2.0, 3.0])
    own["series"].append(own["series"][0] | {"x": [0.0, 100.0, 200.0], "y": [0.1, 2.9, 9.0], "measured": True})
    axis = _figure.plt.figure().subplots()
    _figure.draw(axis, own, True)
    points = axis.lines[1]
    assert list(points.get_xdata()) == [0.0, 100.0] and not points.get_clip_on()
    _figure.plt.close("all")


def test_a_chart_draws_every_text_and_curve_and_interrupts_lines_at_gaps(tmp_path):
    points = [[1.0, 1.0], [2.0, None], [3.0, 0.0], [4.0, 4.0], [5.0, 5.0], [6.0, 1e3]]
    series = [{"name": name, "points": points, "mark": mark, "colour": None} for name, mark in (("computed", "line"), ("exact", "points"))]
    axes = {"x": {"label": "cells", "logarithmic": False, "range": [0.0, 6.0]}, "y": {"label": "error", "logarithmic": True, "range": None}}
    own = {"title": "Kernels", "header": ["nu = 0.3"], "columns": 2, "height": 1.5, "panels": [{"title": "Error", **axes, "series": series}] * 3}
    own["key"] = [series[0] | {"name": "of all panels", "points": [], "mark": mark} for mark in _figure.MARKS]
    paths = [tmp_path / name for name in ("chart.svg", "same.svg")]
    for path in paths:
        with _figure.plt.rc_context(_figure.STYLE):
            figure = _figure.panels(own)
            _figure.save(figure, str(path), "svg")
    svg, same = (path.read_text() for path in paths)
    assert svg == same
    axis = figure.get_axes()[0]
    assert (axis.get_xlim(), axis.get_xscale(), axis.get_yscale()) == ((0.0, 6.0), "linear", "log")
    assert 1e3 < axis.get_ylim()[1] < 2e3 and 0.5 < axis.get_ylim()[0] < 1.0
    for text, count in (("computed", 3), ("exact", 3), ("Error", 3), ("cells", 3), ("Kernels", 1), ("nu = 0.3", 1), ("of all panels", 7)):
        assert svg.count(f">{text}</text>") == count, text
    # Positive and finite are the points 1, 4, 5 and 6.
    line = re.search(r'<g id="line2d_\d+">\s*<path d="([^"]*)" clip-path[^>]*#0072b2', svg)
    assert [own.count("L") for own in line[1].split("M")[1:]] in ([0, 2], [2])
    boxes = [axis.get_window_extent() for axis in figure.get_axes()]
    legends = [axis.get_legend().get_window_extent() for axis in figure.get_axes() if axis.get_legend()]
    assert len(legends) == 3 and not any(box.overlaps(other) for box in legends for other in boxes)
    _figure.plt.close("all")
