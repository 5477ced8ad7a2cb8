"""Picture of a fit: what was measured beside the fitted scene, and how well the records determine its parameters."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator
from scipy import stats

from ._figure import COLOURS, WIDTH
from ._records import VOLUME, Records, is_exponent

BLUE, RED, GREEN, ORANGE = COLOURS[0], COLOURS[1], COLOURS[2], COLOURS[4]

SHOWN = {"K": (1.0, -273.15, "°C"), "m": (1e6, 0.0, "µm"), "m3": (1e9, 0.0, "mm³"), "kg": (1e6, 0.0, "mg"), "1": (1.0, 0.0, "")}


def figure_of(found: Any) -> Figure:
    names = list(dict.fromkeys(own.name for own in found.model.series))
    is_law = names == [VOLUME] and all(own.relative for own in found.model.series)
    shown = [None] if is_law else names
    panels = len(shown) + (1 if len(found.names) > 1 else 0)
    columns = min(panels, 2)
    rows = -(-panels // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(WIDTH, 3.2 * rows), layout="constrained", squeeze=False)
    axes = list(grid.ravel())
    for unused in axes[panels:]:
        unused.remove()
    predicted = found.model.predict(found.parameters())
    for axis, name in zip(axes, shown):
        if name is None:
            law(axis, found)
        else:
            history(axis, found, name, predicted)
    if len(found.names) > 1:
        region(axes[panels - 1], found)
    return figure


def history(axis: Axes, found: Any, name: str, predicted: np.ndarray) -> None:
    """A measured output over time (circles) and the fitted scene (lines), one colour for every test."""
    model = found.model
    factor, offset, unit = SHOWN.get(model.units[name], (1.0, 0.0, model.units[name]))
    for series, own in zip(model.series, model.slices()):
        if series.name != name:
            continue
        colour = COLOURS[series.test % len(COLOURS)]
        axis.plot(series.times, factor * series.values + offset, "o", ms=2.5, mfc="none", mew=0.5, color=colour, rasterized=series.times.size > 2000)
        line = "-" if series.times.size > 1 else "+"
        axis.plot(series.times, factor * predicted[own] + offset, line, linewidth=1.1, color=colour, label=model.tests[series.test].name)
    axis.set_xlabel("time (s)")
    axis.set_ylabel(name.replace("_", " ") + (f" ({unit})" if unit else ""))
    axis.set_title("measured (circles) and fitted (lines)", fontsize=9)
    if len(model.tests) <= 4:
        axis.legend(loc="best")


def law(axis: Axes, found: Any) -> None:
    """Worn volume over load, one line for every speed and distance of the records."""
    model = found.model
    tests = [(*model.tests[own.test].constant, own.times[0], own.values[0]) for own in model.series]
    loads, speeds, times, volumes = np.array(tests).T
    distances = np.round(speeds * times, 9)
    groups = np.unique(np.column_stack([speeds, distances]), axis=0)
    colours = (BLUE, RED, GREEN, ORANGE)
    for at, (speed, distance) in enumerate(groups):
        own = (speeds == speed) & (distances == distance)
        colour = colours[at % len(colours)]
        axis.plot(loads[own], 1e9 * volumes[own], "o", ms=4, mfc="none", color=colour)
        load = np.geomspace(loads.min() / 1.2, 1.2 * loads.max(), 12)
        one = np.ones(load.size)
        volume = 1e9 * type(model)(model.scene, Records(load, speed * one, distance * one, one)).predict(found.parameters())
        axis.plot(load, volume, color=colour, linewidth=1.1, label=f"{distance:,.0f} m at {speed:g} m/s")
    axis.set_xscale("log")
    axis.set_yscale("log")
    ticks = np.unique(loads)
    axis.set_xticks(ticks, [f"{load:g}" for load in ticks])
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_xlabel("load (N)")
    axis.set_ylabel("volume worn off the pin (mm³)")
    axis.set_title("tests (circles) and fitted law (lines)", fontsize=9)
    axis.legend(loc="upper left")


def region(axis: Axes, found: Any) -> None:
    """Joint confidence region of the first two parameters, and their separate intervals."""
    size = 2.0 * stats.f.ppf(found.confidence, 2, found.degrees_of_freedom)
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    outline = np.linalg.cholesky(found.covariance[:2, :2]) @ np.array([np.cos(angle), np.sin(angle)]) * np.sqrt(size)
    percent = f"{100 * found.confidence:g} %"
    units, labels = np.ones(2), []
    for at, name in enumerate(found.names[:2]):
        unit = found.model.scene.unit(name)
        # 1 m2/N = 1e9 mm3/(N.m).
        factor, shown = (1e9, "mm³/(N·m)") if unit == "m2/N" else (1.0, "" if unit == "1" else unit)
        # The power of ten stands in the label, in a form that every font has.
        power = int(np.floor(np.log10(factor * found.values[at])))
        power = 0 if -2 <= power <= 2 else power
        units[at] = factor / 10.0**power
        scale = f"$10^{{{power}}}$ " if power else ""
        labels.append(name + (f" ({scale}{shown})" if scale or shown else ""))
    curve = [
        units[at] * (found.values[at] + outline[at] if is_exponent(name) else found.values[at] * np.exp(outline[at]))
        for at, name in enumerate(found.names[:2])
    ]
    axis.fill(*curve, color=BLUE, alpha=0.25, label=f"joint {percent} region")
    (low, high), values = found.intervals[:, :2] * units, found.values[:2] * units
    below, above = values - low, high - values
    axis.errorbar(
        values[:1], values[1:], xerr=[below[:1], above[:1]], yerr=[below[1:], above[1:]],
        fmt="o", ms=4, color=RED, capsize=3, label=f"fit, separate {percent} intervals",
    )  # fmt: skip
    axis.set_xlabel(labels[0])
    axis.set_ylabel(labels[1])
    axis.set_title("what the records determine", fontsize=9)
    axis.margins(y=0.25)
    axis.legend(loc="upper right")
