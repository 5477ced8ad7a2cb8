"""One figure for every case: published solutions as lines, the model as points, or as a dashed line where it is a curve."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
from results import Result  # noqa: E402

# Okabe and Ito's palette: told apart by every eye and in print.
PUBLISHED = ("#0072B2", "#009E73", "#CC79A7")
MODEL = ("#D55E00", "#E69F00", "#000000")
STYLE = {
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "published",
}
MARKERS = ("s", "x", "^")  # of published points
MANY = 40  # a model's curve with more points is drawn as a dashed line


def draw(result: Result, path: Path) -> Path:
    with plt.rc_context(STYLE):
        figure, axis = plt.subplots(figsize=(130 / 25.4, 68 / 25.4), layout="constrained")
        seen = {True: 0, False: 0}
        labels, markers = set(), iter(MARKERS)
        alike = len({curve.label for curve in result.curves if not curve.published}) == 1
        for curve in result.curves:
            index = seen[curve.published]
            seen[curve.published] += 1
            colours = PUBLISHED if curve.published else MODEL
            colour = colours[0 if alike and not curve.published else index % len(colours)]
            if curve.published:
                style = dict(linestyle="none", marker=next(markers), markerfacecolor="none") if curve.points else {}
            elif curve.x.size <= MANY:
                style = dict(linestyle="none", marker="o", markersize=3.5)
            else:
                style = dict(linestyle=(0, (4, 3)))
            label = curve.label if curve.label not in labels else None
            labels.add(curve.label)
            axis.plot(curve.x, curve.y, color=colour, label=label, **style)
        axis.set_xlabel(result.x)
        axis.set_ylabel(result.y)
        if result.limits:
            axis.set_ylim(*result.limits)
        figure.legend(loc="outside right center")
        # Without the date, the same run gives the same bytes.
        metadata = {"Date": None} if path.suffix == ".svg" else None
        figure.savefig(path, metadata=metadata, dpi=150)
        plt.close(figure)
    return path
