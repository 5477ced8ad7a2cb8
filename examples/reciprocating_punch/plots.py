"""Plots of the reciprocating punch."""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import direct  # noqa: E402  (the backend is chosen first)
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import report  # noqa: E402

# One curve through the values at the stations for the package and the examples.
sys.path.append(str(Path(__file__).resolve().parents[2] / "python" / "sliding_contact"))

from _curve import monotone_cubic  # noqa: E402

plt.rcParams.update(
    {
        "font.size": 9,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#e4e4e4",
        "grid.linewidth": 0.6,
        "axes.axisbelow": True,
        "lines.linewidth": 1.2,
        "legend.frameon": False,
        "legend.fontsize": 7.5,
        # Without date and random names, the same run gives the same bytes.
        "svg.fonttype": "none",
        "svg.hashsalt": "sliding contact",
    }
)
TITLES = {"translate": "punch only translates", "rotate": "punch also rotates about a pivot"}
OPEN = {"linestyle": "", "marker": "o", "markersize": 4, "markerfacecolor": "none", "markevery": 3}
BLUE, ORANGE, GREY = "#0072B2", "#D55E00", "#888888"


def shown(history, count=6):
    """Rows of forward half-strokes to show: the first and the last, the rest spread over the logarithm between."""
    forward = np.flatnonzero(history.half_strokes % 2 == 1)
    last = history.half_strokes[forward[-1]]
    wanted = [1, *np.geomspace(min(40, last), last, count - 1)]
    nearest = [forward[np.argmin(np.abs(np.log(history.half_strokes[forward] / w)))] for w in wanted]
    return list(dict.fromkeys(nearest))


def palette(rows):
    return plt.cm.viridis(np.linspace(0.0, 0.92, len(rows)))


def written(figure, path):
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    return path


def levels(axis):
    """The edges' steady pressures, and the mean."""
    for level, name in ((0, ""), (1, "$p_m$"), (2, "$2 p_m$")):
        axis.axhline(level, color=GREY, linewidth=0.8, zorder=1)
        axis.annotate(name, (1.0, level), (3, 0), xycoords=("axes fraction", "data"), textcoords="offset points",
                      va="center", color=GREY)  # fmt: skip


def pressures(histories, states, path):
    """Pressure of successive half-strokes, by holder and direction."""
    figure, axes = plt.subplots(len(histories), 2, figsize=(8.8, 6.6), sharex=True, sharey=True, layout="constrained")
    for row, (name, history) in zip(np.atleast_2d(axes), histories.items(), strict=True):
        rows = shown(history)
        for axis, sign in zip(row, (1, -1), strict=True):
            levels(axis)
            for record, colour in zip(rows, palette(rows), strict=True):
                record += sign < 0
                cycle = (history.half_strokes[record] + 1) // 2
                ratio = history.pressure[record] / history.mean
                axis.plot(*monotone_cubic(1e3 * history.x, ratio), color=colour, label=f"cycle {cycle}")
            exact = states[name].pressure[sign] / history.mean
            axis.plot(*monotone_cubic(1e3 * states[name].x, exact), "--", color="black", linewidth=1.0, label="direct steady state")
            axis.set_title(f"{TITLES[name]}, v {'>' if sign > 0 else '<'} 0", fontsize=9)
            axis.set_ylim(-0.1, 5.2)
            axis.legend(loc="upper left" if sign > 0 else "upper right")
        row[0].set_ylabel("contact pressure over mean $p/p_m$")
    for axis in np.atleast_2d(axes)[-1]:
        axis.set_xlabel("position on the punch x (mm)")
    mean = next(iter(histories.values())).mean
    figure.suptitle(f"Pressure in the middle of successive half-strokes, $p_m$ = {mean / 1e6:.2f} MPa", fontsize=10)
    return written(figure, path)


def edges(histories, path):
    """Pressure at both edges over the cycles."""
    figure, axes = plt.subplots(1, len(histories), figsize=(8.8, 3.6), sharey=True, layout="constrained")
    for axis, (name, history) in zip(np.atleast_1d(axes), histories.items(), strict=True):
        levels(axis)
        forward = history.half_strokes % 2 == 1
        for station, edge, colour in ((0, "x = -a", BLUE), (-1, "x = +a", ORANGE)):
            for mask, style, way in ((forward, {"linestyle": "-"}, "v > 0"), (~forward, OPEN, "v < 0")):
                ratio = history.pressure[mask, station] / history.mean
                axis.semilogx(np.ceil(history.cycles[mask]), ratio, color=colour, label=f"{edge}, {way}", **style)
        axis.set_xlabel("cycle")
        axis.set_title(TITLES[name], fontsize=9)
        axis.legend()
    np.atleast_1d(axes)[0].set_ylabel("edge pressure over mean $p/p_m$")
    figure.suptitle("Edge pressures go to 0 and to twice the mean (means over the edge intervals)", fontsize=10)
    return written(figure, path)


def shapes(histories, states, path):
    """Worn depth less its rigid motion, which reshapes nothing."""
    figure, axes = plt.subplots(1, len(histories), figsize=(8.8, 3.6), sharey=True, layout="constrained")
    for axis, (name, history) in zip(np.atleast_1d(axes), histories.items(), strict=True):
        rows = shown(history)
        x = 1e3 * history.x
        for row, colour in zip(rows, palette(rows), strict=True):
            worn = direct.without_rigid_motion(history.x, history.worn[row], name)
            axis.plot(*monotone_cubic(x, 1e6 * worn), color=colour, label=f"cycle {(history.half_strokes[row] + 1) // 2}")
        axis.plot(*monotone_cubic(x, 1e6 * states[name].shape), "k--", linewidth=1.0, label="direct steady state")
        axis.set_xlabel("position on the punch x (mm)")
        axis.set_title(TITLES[name], fontsize=9)
        axis.legend()
    np.atleast_1d(axes)[0].set_ylabel("worn depth less rigid motion (µm)")
    figure.suptitle("Worn shape of the punch", fontsize=10)
    return written(figure, path)


def relaxation(histories, accelerated, states, path):
    """Distance from the direct steady state over the cycles, with true and with accelerated wear."""
    figure, axis = plt.subplots(figsize=(6.6, 3.8), layout="constrained")
    for (name, history), colour in zip(histories.items(), (BLUE, ORANGE), strict=True):
        for run, style, label in (
            (history, "-", TITLES[name]),
            (accelerated[name], "o", f"the same, wear_acceleration = {accelerated[name].acceleration:g}"),
        ):
            distance = report.distances(run, states[name])[::2]
            axis.semilogy(run.cycles[::2], distance, style, color=colour, markersize=3, label=label)
    axis.set_xlabel("cycles times wear_acceleration")
    axis.set_ylabel("distance over mean pressure")
    axis.legend()
    axis.set_title("Pressure: root mean square distance from the direct steady state", fontsize=10)
    return written(figure, path)
