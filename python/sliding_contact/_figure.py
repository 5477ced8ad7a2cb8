"""Draws the figures of simulations, steady states and cycles, for the package and for `cargo fmu`, and the charts of the latter.

Of a simulation: panels over the time in two columns, panels over the contact in a row below. They come with their labels and curves from
crates/analyses/src/simulation/figure.rs; nothing is computed here but the range of curves with hundreds of strokes.
"""

from __future__ import annotations

import textwrap
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator

from ._curve import monotone_cubic

# Okabe and Ito's palette: told apart by every eye and in print.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLE: Any = {
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 7.0,
    "legend.handlelength": 1.4,
    "legend.columnspacing": 1.0,
    "legend.borderaxespad": 0.2,
    # Text stays text, to be found and edited; PDF with fonts that journals accept.
    "svg.fonttype": "none",
    "svg.hashsalt": "sliding contact",
    "pdf.fonttype": 42,
}
WIDTH = 180 / 25.4  # inches: the width of a page of most journals
ROW = 1.55
PANEL = 2.8  # inches: width of the axes of a panel over the time, at least
LEGEND = 7.0  # points
MARKS: dict[str, dict[str, Any]] = {
    "line": {},
    "thin": {"linewidth": 0.6},
    "dashes": {"linestyle": "--"},
    "points": {"linestyle": "none", "marker": "o"},
    "line_and_points": {"marker": "o"},
    "dashes_and_squares": {"linestyle": "--", "marker": "s"},
    "crosses": {"linestyle": "none", "marker": "x", "markersize": 4.0},
}
MARKER: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 2.6, "markerfacecolor": "none", "markeredgewidth": 0.6}


FEW = 160  # measured points up to which each is seen
STROKES = 150  # turning points of a curve over the time beyond which its lines would fill the area between its extremes
INTERVALS = 100  # in which the extremes of such a curve are drawn
START = 0.01  # of the time: a peak within it belongs to the start
TALL = 5.0  # times what follows it: a peak that leaves the axis


def beyond(panel: dict[str, Any], over_time: bool) -> tuple[float, float] | None:
    """The upper end of the axis, and the value that leaves it, where one peak would flatten all the rest: that of the start over
    the time, that of one of the curves over the contact. The pressure of a contact that is not run in yet is such a peak."""
    series = panel["series"]
    if over_time:
        end = min(own["x"][0] + START * (own["x"][-1] - own["x"][0]) for own in series)
        early = [y for own in series for x, y in zip(own["x"], own["y"]) if x <= end and not own["measured"]]
        rest = [y for own in series for x, y in zip(own["x"], own["y"]) if x > end or own["measured"]]
    else:
        tallest = max(series, key=lambda own: max(own["y"]))
        early = tallest["y"]
        rest = [y for own in series if own is not tallest for y in own["y"]]
    if not early or not rest or min(early + rest) < 0.0 or not max(early) > TALL * max(rest) > 0.0:
        return None
    return 2.0 * max(rest), max(early)


def turns(y: list[float]) -> int:
    """Number of turning points of a curve that are more than a hundredth of its range apart, and more than rounding."""
    least = max(0.01 * (max(y) - min(y)), 1e-3 * max(abs(value) for value in y))
    count, side, extreme = 0, 0, y[0]
    for value in y:
        if side * (value - extreme) >= 0.0 and side:
            extreme = value
        elif abs(value - extreme) > least:
            count += side != 0
            side, extreme = (1 if value > extreme else -1), value
    return count


def extremes(x: list[float], y: list[float]) -> tuple[list[float], list[float], list[float]]:
    """Ends of `INTERVALS` equal intervals, and the least and the largest value up to each."""
    at, low, high = [], [], []
    step = (x[-1] - x[0]) / INTERVALS
    first = 0
    for interval in range(1, INTERVALS + 1):
        end = x[0] + interval * step if interval < INTERVALS else x[-1]
        last = first
        while last + 1 < len(x) and x[last + 1] <= end:
            last += 1
        values = y[first : last + 1]
        at.append(end)
        low.append(min(values))
        high.append(max(values))
        first = last
    return [x[0], *at], [low[0], *low], [high[0], *high]


def draw(axis: Axes, panel: dict[str, Any], over_time: bool = False) -> None:
    """Draws a panel. Where curves coincide, those below are wider, to be seen: the first one over the time, all but the last over
    the contact."""
    curves = [series for series in panel["series"] if not series["measured"]]
    ends = [x for series in curves for x in (min(series["x"]), max(series["x"]))]
    measured = []
    for series in panel["series"]:
        colour = COLOURS[series["colour"] % len(COLOURS)]
        if series["measured"]:
            # A cloud of many points shows where they are dense.
            many = len(series["x"]) > FEW
            within = [(x, y) for x, y in zip(series["x"], series["y"]) if min(ends) <= x <= max(ends)]
            measured += axis.plot(*zip(*within), color=colour, **(MARKER | {"markersize": 1.4, "alpha": 0.5} if many else MARKER))
        elif over_time and turns(series["y"]) > STROKES:
            name = f"{series['name']}, range" if series["name"] else "range"
            axis.fill_between(*extremes(series["x"], series["y"]), color=colour, alpha=0.35, linewidth=0.4, label=name)
        else:
            above = len(curves) - 1 - next(index for index, own in enumerate(curves) if own is series)
            wide = min(0.6 * above, 1.8) if not over_time else 0.9 if above and series is curves[0] else 0.0
            width = 1.1 + wide
            axis.plot(series["x"], series["y"], color=colour, label=series["name"] or None, linewidth=width)
    axis.set_xlabel(panel["x"])
    axis.set_ylabel(panel["y"])
    # A loop is seen whole.
    loop = any(after < before for series in curves for before, after in zip(series["x"], series["x"][1:]))
    room = 0.03 * (max(ends) - min(ends)) if loop else 0.0
    axis.set_xlim(min(ends) - room, max(ends) + room)
    values = [y for series in panel["series"] for y in series["y"]]
    low, high = min(values), max(values)
    if high - low <= 1e-3 * max(abs(low), abs(high)):
        # A constant is not drawn as if it varied.
        room = 0.1 * max(abs(low), abs(high)) or 1.0
        axis.set_ylim(low - room, high + room)
    elif peak := beyond(panel, over_time):
        axis.set_ylim(0.0, peak[0])
        # On the half where the curve does not leave the axis.
        own = next(series for series in panel["series"] if peak[1] in series["y"])
        x, colour = own["x"][own["y"].index(peak[1])], COLOURS[own["colour"] % len(COLOURS)]
        place, side = (0.97, "right") if x < (min(ends) + max(ends)) / 2 else (0.03, "left")
        axis.text(place, 0.96, f"peak {peak[1]:.3g}", transform=axis.transAxes, ha=side, va="top", fontsize=7, color=colour)
    elif 0.0 <= low < 0.2 * high:
        axis.set_ylim(bottom=0.0)
    for points in measured:
        # Those at the ends of the run are seen whole.
        highest = np.fmax.reduce(np.asarray(points.get_ydata(), dtype=float), initial=0.0)
        points.set_clip_on(bool(highest > axis.get_ylim()[1]))


def legend(axis: Axes, handles: list[Any], labels: list[str], width: float, title: str = "") -> None:
    """Above the axes, where no curve is, in as many columns as have room in their `width` (inches). A blank title keeps its height free, below
    the axes' own `title`; the legend itself must not change the layout."""
    columns = legend_columns(labels, width)
    blank = "\n" * (-(-len(labels) // columns) - 1) + " " * bool(labels)
    text = "\n".join(filter(None, (title, blank)))
    if text:
        axis.set_title(text, fontsize=LEGEND, fontweight="bold" if title else None, linespacing=1.55, pad=3.0)
    if handles:
        axis.legend(handles, labels, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns).set_in_layout(False)


def legend_columns(labels: list[str], width: float) -> int:
    return max((own for own in range(2, 1 + min(len(labels), 4)) if legend_width(labels, own) <= width), default=1)


def legend_width(labels: list[str], columns: int) -> float:
    """Width of a legend in inches: its entries fill columns from top to bottom, the first ones longer by one; a letter is half as wide as high."""
    letters = [max(map(len, part)) for part in np.array_split(labels, columns)]
    return sum(0.55 * own + 3.3 for own in letters) * LEGEND / 72.0


def legend_over_time(axis: Axes, panel: dict[str, Any], width: float) -> None:
    handles, labels = axis.get_legend_handles_labels()
    if any(series["measured"] for series in panel["series"]):
        handles.append(Line2D([], [], color="#444444", **MARKER))
        labels.append("measured")
    legend(axis, handles, labels, width)


def over_time(part: Any, courses: list[dict[str, Any]]) -> None:
    """Panels over the time in two columns, one time axis a column, an odd one over both; of hundreds of strokes with the last two beside the
    whole course."""
    rows = len(courses) // 2
    # Three parts a column: two for the course and one for its strokes, or all for the course.
    grid = part.add_gridspec((len(courses) + 1) // 2, 6)
    for panels, top, left, right in ((courses[:rows], 0, 0, 3), (courses[rows : 2 * rows], 0, 3, 6), (courses[2 * rows :], rows, 0, 6)):
        axes: list[Axes] = []
        labelled = False
        for row, panel in enumerate(panels, top):
            many = any(not series["measured"] and turns(series["y"]) > STROKES for series in panel["series"])
            beside = (right - left) // 3 if many and panel["strokes"] else 0
            axis = part.add_subplot(grid[row, left : right - beside], sharex=axes[0] if axes else None)
            axes.append(axis)
            draw(axis, panel | {"y": textwrap.fill(panel["y"], 20)}, over_time=True)
            # The last strokes of a column are labelled once, beside the legend.
            legend_over_time(axis, panel, PANEL * 2 / 3 if beside and not labelled else PANEL)
            if row + 1 < top + len(panels):
                axis.set_xlabel("")
                axis.tick_params(labelbottom=False)
            if beside:
                # The ticks are those of all panels of the column, of which this one is narrower.
                axis.locator_params(axis="x", nbins=5)
                strokes(part.add_subplot(grid[row, right - beside : right], sharey=axis), panel, not labelled)
                labelled = True
        if axes:
            part.align_ylabels(axes)


def strokes(axis: Axes, panel: dict[str, Any], labelled: bool) -> None:
    """The last two strokes in full, `labelled` with their duration."""
    for series in panel["strokes"]:
        look: Any = MARKER | {"markersize": 1.6} if series["measured"] else {"linewidth": 0.9}
        axis.plot(series["x"], series["y"], color=COLOURS[series["colour"] % len(COLOURS)], **look)
    first = panel["strokes"][0]["x"]
    axis.set_xlim(first[0], first[-1])
    axis.tick_params(labelleft=False, labelbottom=False)
    axis.grid(axis="x", visible=False)
    if labelled:
        text = f"last two strokes: {first[-1] - first[0]:.3g} s"
        axis.text(1.0, 1.02, text, transform=axis.transAxes, ha="right", va="bottom", fontsize=6).set_in_layout(False)


def figure_of(content: dict[str, Any]) -> Figure:
    courses, rig, profiles = content["courses"], content.get("rig", []), content["profiles"]
    rows = (len(courses) + 1) // 2
    per_row = 3 if len(profiles) == 3 else 2
    lines = -(-len(profiles) // per_row)
    title, told = content["title"], textwrap.wrap(", ".join(content["constants"]), 110)
    ratios = [rows, *([1.3] if rig else []), *([1.3 * lines] if profiles else [])]
    height = ROW * sum(ratios) + 0.3 + 0.15 * len(told)
    figure = plt.figure(figsize=(WIDTH, height), layout="constrained")
    spread(figure)
    parts: Any = figure.subfigures(len(ratios), 1, height_ratios=ratios) if len(ratios) > 1 else (figure,)
    over_time(parts[0], courses)
    if rig:
        for axis, panel in zip(parts[1].subplots(1, len(rig), squeeze=False).flatten(), rig):
            draw(axis, panel)
            legend_over_time(axis, panel, WIDTH / len(rig) - 0.7)
    if profiles:
        part = parts[-1]
        axes = part.subplots(lines, per_row, squeeze=False).flatten()
        for axis, panel in zip(axes, profiles):
            draw(axis, panel | {"y": textwrap.fill(panel["y"], 20)})
        for axis in axes[len(profiles):]:
            axis.set_visible(False)
        handles, labels = axes[0].get_legend_handles_labels()
        part.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), 6), title="over the contact, at the time")
    figure.suptitle("\n".join([title, *told]), fontsize=9 if not told else 8)
    return figure


def spread(figure: Figure) -> None:
    """Room between panels: no label touches the next axes."""
    engine: Any = figure.get_layout_engine()
    engine.set(w_pad=0.05, h_pad=0.05, wspace=0.04)


def steady(state: Any) -> Figure:
    """Pressure and shape of a steady state, without and with heat, and the temperatures of the surfaces."""
    heat = state.heat
    count = 3 if heat else 2
    figure, axes = plt.subplots(1, count, figsize=(WIDTH, 2.9), layout="constrained", squeeze=False)
    spread(figure)
    x = 1e3 * state.x
    pressure, shape = axes[0, 0], axes[0, 1]
    for index, stroke in enumerate(state.strokes):
        name = "forward" if stroke.direction == "forward" else "backward"
        line = "-" if index == 0 else "--"
        pressure.plot(*monotone_cubic(x, 1e-6 * stroke.pressure), label=name, color=COLOURS[index], linestyle=line)
        if heat:
            own = 1e-6 * heat["strokes"][index]["pressure"]
            pressure.plot(x[::3], own[::3], **{**MARKER, "color": COLOURS[index]})
    pressure.axhline(1e-6 * state.mean_pressure, color="black", linewidth=0.6, label="mean")
    shape.plot(*monotone_cubic(x, 1e6 * state.shape), color=COLOURS[0], label="punch")
    if heat:
        shape.plot(*monotone_cubic(x, 1e6 * heat["shape"]), color=COLOURS[1], linestyle="--", label="punch, with heat")
    if state.groove.any():
        shape.plot(*monotone_cubic(x, 1e6 * state.groove), color=COLOURS[2], label="groove of the strip")
    # Contact without wear of the punch is singular at its edges.
    highest = max(float(stroke.pressure.max()) for stroke in state.strokes)
    pressure.set_ylim(-0.04e-6 * min(highest, 4.0 * state.mean_pressure), 1.06e-6 * min(highest, 4.0 * state.mean_pressure))
    pressure.set_ylabel("pressure (MPa)")
    shape.set_ylabel("unloaded surface (µm)")
    if heat:
        temperature = axes[0, 2]
        for index, stroke in enumerate(heat["strokes"]):
            for side, body in enumerate(("punch", "strip")):
                name = body if len(heat["strokes"]) == 1 else f"{body}, {stroke['direction']}"
                line = "-" if index == 0 else "--"
                values = stroke[f"temperature_{body}"] - 273.15
                temperature.plot(*monotone_cubic(x, values), color=COLOURS[side], linestyle=line, label=name)
        temperature.set_ylabel("surface temperature (°C)")
    for axis in axes[0]:
        axis.set_xlabel("x (mm)")
        axis.set_xlim(x[0], x[-1])
        handles, labels = axis.get_legend_handles_labels()
        if axis is pressure and heat:
            handles.append(Line2D([], [], **{**MARKER, "color": "#444444"}))
            labels.append("with heat")
        legend(axis, handles, labels, WIDTH / count - 0.7)
    figure.suptitle(f"{state.scene}: {state.kind}", fontsize=9)
    return figure


def cycles(course: Any) -> Figure:
    """Pressure, wear and temperature over the cycles."""
    warm = bool((course.contact_temperature == course.contact_temperature).any())
    figure, axes = plt.subplots(1, 3 if warm else 2, figsize=(WIDTH, 2.4), layout="constrained", squeeze=False)
    spread(figure)
    axes[0, 0].plot(course.cycles, 1e-6 * course.pressure_max, color=COLOURS[0])
    axes[0, 0].set_ylabel("highest mean pressure,\nforward (MPa)")
    worn = [(name, depth) for name, depth in (("punch", course.wear_depth_punch), ("strip", course.wear_depth_strip)) if depth.any()]
    for colour, (name, depth) in zip(COLOURS, worn):
        axes[0, 1].plot(course.cycles, 1e6 * depth, color=colour, label=name)
    axes[0, 1].set_yscale("log")
    axes[0, 1].set_ylabel("mean worn depth (µm)" if len(worn) > 1 else f"mean worn depth\nof the {worn[0][0]} (µm)" if worn else "")
    if len(worn) > 1:
        axes[0, 1].legend(loc="upper left")
    if warm:
        axes[0, 2].plot(course.cycles, course.contact_temperature - 273.15, color=COLOURS[0])
        axes[0, 2].set_ylabel("mean contact\ntemperature (°C)")
    for axis in axes[0]:
        axis.set_xscale("log")
        axis.set_xlabel("cycles")
    figure.suptitle(f"{course.scene} over its cycles", fontsize=9)
    return figure


def panels(content: dict[str, Any]) -> Figure:
    """A chart of `fmu-build/src/plot.rs`: title, texts, key, and panels with their legends."""
    own, columns = content["panels"], content["columns"]
    page = WIDTH * max(columns, 2) / 2
    told = [line for text in content["header"] for line in textwrap.wrap(text, round(21 * page))]
    key = [sample(series, index) for index, series in enumerate(content["key"])]
    names = [textwrap.fill(series["name"], 66) for series in content["key"]]  # half of the page
    width = page / columns - 0.7
    legends = [[series["name"] for series in panel["series"] if series["name"]] for panel in own]
    lines = [-(-len(names) // legend_columns(names, width)) for names in legends]
    rows = [max(lines[first : first + columns]) for first in range(0, len(own), columns)]
    height = (content["height"] + 0.7) * len(rows) + 0.15 * (sum(rows) + -(-len(key) // 2) + len(told)) + 0.3
    figure = plt.figure(figsize=(page, height), layout="constrained")
    spread(figure)
    # A text and a key above panels have room each in a part of their own.
    part: Any = figure.subfigures(1, 1)
    if told:
        part.suptitle("\n".join(told), fontsize=6.5)
        part = part.subfigures(1, 1)
    if key:
        part.legend(key, names, loc="outside upper center", ncols=2)
    axes = part.subplots(len(rows), columns, squeeze=False).flatten()
    for axis, panel, labels in zip(axes, own, legends):
        handles = []
        for index, series in enumerate(panel["series"]):
            line = axis.add_line(sample(series, index))
            # A gap interrupts the line.
            line.set_data(np.array(series["points"], dtype=float).reshape(-1, 2).T)
            handles += [line] if series["name"] else []
        axis.relim()
        axis.margins(0.03, 0.06)
        for name in "xy":
            given = panel[name]
            axis.set(**{f"{name}label": textwrap.fill(given["label"], 38 if name == "y" else 60)})
            if given["logarithmic"]:
                getattr(axis, f"set_{name}scale")("log", nonpositive="mask")
            if given["range"]:
                axis.set(**{f"{name}lim": given["range"]})
        axis.autoscale_view()
        for line in axis.lines:
            # Points at the ends of a range are seen whole.
            points, view = line.get_xydata(), axis.viewLim
            line.set_clip_on(bool(((points < view.min) | (points > view.max)).any()))
        for line, (low, high) in ((axis.xaxis, axis.get_xlim()), (axis.yaxis, axis.get_ylim())):
            # Less than three powers of ten: 1, 2 and 5 times each.
            if line.get_scale() == "log" and np.floor(np.log10(high)) - np.ceil(np.log10(low)) < 2.0:
                line.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
                line.set_major_formatter("{x:g}")
            line.set_minor_locator(NullLocator())
        legend(axis, handles, labels, width, panel["title"])
    for axis in axes[len(own):]:
        axis.set_visible(False)
    figure.suptitle(content["title"], fontsize=9)
    return figure


def sample(series: dict[str, Any], index: int) -> Line2D:
    """A line without points in the look of a series, at this place of its panel or key."""
    colour = COLOURS[(index if series["colour"] is None else series["colour"]) % len(COLOURS)]
    return Line2D([], [], **{"color": colour, "markersize": 3.0, "label": series["name"]} | MARKS[series["mark"]])


def save(figure: Figure, path: str, kind: str) -> None:
    """Writes a figure without date, program and version: the same run gives the same bytes."""
    metadata: dict[str, Any] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}[kind]
    with plt.rc_context(STYLE):
        figure.savefig(path, format=kind, dpi=200, metadata=metadata)
