"""Picture of a fit: the tests beside the law, and how well the records determine its parameters."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator
from scipy import stats

from ._figure import COLOURS, WIDTH

BLUE, RED, GREEN, ORANGE = COLOURS[0], COLOURS[1], COLOURS[2], COLOURS[4]


def figure_of(found: Any) -> Figure:
    panels = 2 if len(found.names) > 1 else 1
    figure, axes = plt.subplots(1, panels, figsize=(WIDTH, 3.2), layout="constrained", squeeze=False)
    law(axes[0, 0], found.model, found)
    if panels > 1:
        region(axes[0, 1], found)
    return figure


def law(axis: Axes, model: Any, found: Any) -> None:
    """Worn volume over load, one line for every speed and distance of the records."""
    records = model.records
    groups = np.unique(np.column_stack([records.speed, records.distance]), axis=0)
    colours = (BLUE, RED, GREEN, ORANGE)
    for at, (speed, distance) in enumerate(groups):
        own = (records.speed == speed) & (records.distance == distance)
        colour = colours[at % len(colours)]
        axis.plot(records.load[own], 1e9 * records.volume[own], "o", ms=4, mfc="none", color=colour)
        load = np.geomspace(records.load.min() / 1.2, 1.2 * records.load.max(), 12)
        volume = 1e9 * model.at(load, speed, distance).volumes(found.parameters())
        axis.plot(load, volume, color=colour, linewidth=1.1, label=f"{distance:,.0f} m at {speed:g} m/s")
    axis.set_xscale("log")
    axis.set_yscale("log")
    loads = np.unique(records.load)
    axis.set_xticks(loads, [f"{load:g}" for load in loads])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_xlabel("load (N)")
    axis.set_ylabel("volume worn off the pin (mm³)")
    axis.set_title("tests (circles) and fitted law (lines)", fontsize=9)
    axis.legend(loc="upper left")


def region(axis: Axes, found: Any) -> None:
    """Joint confidence region of the coefficient and the first exponent, and their separate intervals."""
    centre = np.array([np.log(found.values[0]), found.values[1]])
    size = 2.0 * stats.f.ppf(found.confidence, 2, found.degrees_of_freedom)
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    outline = np.linalg.cholesky(found.covariance[:2, :2]) @ np.array([np.cos(angle), np.sin(angle)]) * np.sqrt(size)
    percent = f"{100 * found.confidence:g} %"
    # 1 mm3/(N.m) = 1e-9 m2/N; the power of ten stands in the label.
    power = int(np.floor(np.log10(1e9 * found.values[0])))
    unit = 1e9 / 10.0**power
    coefficient = unit * np.exp(centre[0] + outline[0])
    axis.fill(coefficient, centre[1] + outline[1], color=BLUE, alpha=0.25, label=f"joint {percent} region")
    low, high = found.intervals
    axis.errorbar(
        [unit * found.values[0]],
        [found.values[1]],
        xerr=[[unit * (found.values[0] - low[0])], [unit * (high[0] - found.values[0])]],
        yerr=[[found.values[1] - low[1]], [high[1] - found.values[1]]],
        fmt="o",
        ms=4,
        color=RED,
        capsize=3,
        label=f"fit, separate {percent} intervals",
    )
    kind = "pressure" if "pressure" in found.names[1] else "velocity"
    axis.set_xlabel(f"wear coefficient k ($10^{{{power}}}$ mm³/(N·m))")
    axis.set_ylabel(f"{kind} exponent")
    axis.set_title("what the records determine", fontsize=9)
    axis.margins(y=0.25)
    axis.legend(loc="upper right")
