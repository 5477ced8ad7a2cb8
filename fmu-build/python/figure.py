"""Draws the figure of `cargo fmu simulate`: panels over the time in two columns, panels over the contact in a row below.

    python figure.py FILE FORMAT < figure.json

The panels, with their labels and curves, come as JSON from fmu-build/lab/src/simulate/figure.rs; nothing is computed here.
"""

import json
import sys
import textwrap

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
from matplotlib.lines import Line2D  # noqa: E402

# Okabe and Ito's palette: told apart by every eye and in print.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLE = {
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
    "legend.fontsize": 7,
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


MARKER = {"linestyle": "none", "marker": "o", "markersize": 2.6, "markerfacecolor": "none", "markeredgewidth": 0.6}


def draw(axis, panel, wide=False):
    """Draws a panel; `wide`: the first of several curves below the others, to be seen where they coincide."""
    curves = [series for series in panel["series"] if not series["measured"]]
    for series in panel["series"]:
        colour = COLOURS[series["colour"] % len(COLOURS)]
        if series["measured"]:
            axis.plot(series["x"], series["y"], color=colour, **MARKER)
        else:
            width = 2.0 if wide and len(curves) > 1 and series is curves[0] else 1.1
            axis.plot(series["x"], series["y"], color=colour, label=series["name"] or None, linewidth=width)
    axis.set_xlabel(panel["x"])
    axis.set_ylabel(panel["y"])
    ends = [x for series in curves for x in (series["x"][0], series["x"][-1])]
    axis.set_xlim(min(ends), max(ends))
    values = [y for series in panel["series"] for y in series["y"]]
    low, high = min(values), max(values)
    if high - low <= 1e-3 * max(abs(low), abs(high)):
        # A constant is not drawn as if it varied.
        room = 0.1 * max(abs(low), abs(high)) or 1.0
        axis.set_ylim(low - room, high + room)
    elif 0.0 <= low < 0.2 * high:
        axis.set_ylim(bottom=0.0)


def legend(axis, panel):
    """Above the axes, where no curve is."""
    handles, labels = axis.get_legend_handles_labels()
    if any(series["measured"] for series in panel["series"]):
        handles.append(Line2D([], [], color="#444444", **MARKER))
        labels.append("measured")
    if handles:
        columns = 2 if len(handles) == 4 else 3
        axis.legend(handles, labels, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns)


def figure_of(content):
    courses, profiles = content["courses"], content["profiles"]
    rows = (len(courses) + 1) // 2
    per_row = 3 if len(profiles) == 3 else 2
    lines = -(-len(profiles) // per_row)
    height = ROW * (rows + 1.3 * lines) + 0.3
    figure = plt.figure(figsize=(WIDTH, height), layout="constrained")
    parts = figure.subfigures(2, 1, height_ratios=(rows, 1.3 * lines)) if profiles else (figure,)
    grid = parts[0].subplots(rows, 2, squeeze=False, sharex=True).T.flatten()
    for axis, panel in zip(grid, courses):
        draw(axis, panel, wide=True)
        legend(axis, panel)
    for axis in grid[len(courses):]:
        axis.set_visible(False)
    last = len(courses) - 1
    for index, axis in enumerate(grid):
        # One time axis a column.
        if index not in (rows - 1, last):
            axis.set_xlabel("")
        elif index == last and last % rows != rows - 1:
            axis.tick_params(labelbottom=True)
    for column in (grid[:rows], grid[rows:]):
        parts[0].align_ylabels(column)
    if profiles:
        axes = parts[1].subplots(lines, per_row, squeeze=False).flatten()
        for axis, panel in zip(axes, profiles):
            draw(axis, panel | {"y": textwrap.fill(panel["y"], 20)})
        for axis in axes[len(profiles):]:
            axis.set_visible(False)
        handles, labels = axes[0].get_legend_handles_labels()
        parts[1].legend(handles, labels, loc="outside upper center", ncols=min(len(labels), 6), title="over the contact, at the time")
    figure.suptitle(content["title"], fontsize=9)
    return figure


def main():
    path, kind = sys.argv[1:3]
    content = json.load(sys.stdin)
    with plt.rc_context(STYLE):
        figure = figure_of(content)
        # Without date, program and version the same run gives the same bytes.
        metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}, "png": {"Software": None}}[kind]
        figure.savefig(path, format=kind, dpi=200, metadata=metadata)


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{error}")
