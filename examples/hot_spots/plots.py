"""Plots of the rings."""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import numpy as np  # noqa: E402
import report  # noqa: E402
from matplotlib.ticker import MaxNLocator  # noqa: E402

# One curve through the values at the stations for the package and the examples.
sys.path.append(str(Path(__file__).resolve().parents[2] / "python" / "sliding_contact"))

from _curve import monotone_cubic  # noqa: E402

plt.rcParams.update({"font.size": 9, "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.6,
                     "axes.axisbelow": True, "legend.frameon": False, "legend.fontsize": 7.5,
                     # Without date and random names, the same run gives the same bytes.
                     "svg.hashsalt": "sliding contact", "svg.fonttype": "none"})  # fmt: skip
ROWS = 100  # of the maps over time, and points of each: more cannot be seen
LEVELS = 13  # of the colours of the maps


def written(figure, path):
    metadata = {"Date": None} if path.suffix == ".svg" else None
    figure.savefig(path, metadata=metadata)
    plt.close(figure)
    return path


def title(run, critical):
    return f"V = {run.speed:.3g} m/s = {run.speed / critical:.2g} $V_{{cr}}$"


def maps(runs, critical, level, path):
    """Pressure over its mean, around the ring and over time, as filled contours: a drawing without pixels."""
    figure, axes = plt.subplots(1, len(runs), figsize=(8.8, 4.4), sharey=True, layout="constrained")
    for axis, run in zip(np.atleast_1d(axes), runs, strict=True):
        rows = np.unique(np.linspace(0, len(run.time) - 1, min(ROWS, len(run.time))).round().astype(int))
        ratio = run.pressure[rows] / run.pressure[rows, :-1].mean(axis=1, keepdims=True)
        highest = max(1.2, np.percentile(ratio, 99.5))
        curves = [monotone_cubic(1e3 * run.x, row, ROWS) for row in ratio]
        # Above 0, which is no part of the lowest level.
        filled = axis.contourf(curves[0][0], run.time[rows], np.clip([values for _, values in curves], 1e-9, highest),
                               levels=np.linspace(0.0, highest, LEVELS), cmap="inferno")  # fmt: skip
        axis.set_title(title(run, critical), fontsize=9)
        axis.set_xlabel("position around the steel ring x (mm)")
        axis.grid(False)
        bar = figure.colorbar(filled, ax=axis, label="pressure over mean $p/p_m$")
        bar.locator = MaxNLocator(6)
        bar.update_ticks()
    np.atleast_1d(axes)[0].set_ylabel("time (s)")
    figure.suptitle(f"Contact pressure, in the frame of the steel ring; {level}", fontsize=10)
    return written(figure, path)


def growth(runs, rings, critical, level, path):
    """Amplitudes of the waves over time, with the growth of theory."""
    figure, axes = plt.subplots(1, len(runs), figsize=(8.8, 4.2), sharey=True, layout="constrained")
    colours = plt.cm.viridis(np.linspace(0.0, 0.92, report.WAVES))
    for axis, run in zip(np.atleast_1d(axes), runs, strict=True):
        amplitudes = run.waves(report.WAVES)
        whole = run.scalars["contact_fraction"] > 0.999
        last = len(whole) - 1 if whole.all() else max(int(np.argmin(whole)) - 1, 1)
        for index, colour in enumerate(colours):
            axis.semilogy(run.time, amplitudes[:, index], color=colour, linewidth=1.1, label="1 wave" if index == 0 else f"{index + 1} waves")
            rate = rings.growth(index + 1, run.speed)
            middle = last // 2
            if amplitudes[middle, index] > 0.0 and rate > 0.0:
                line = amplitudes[middle, index] * np.exp(rate * (run.time[: last + 1] - run.time[middle]))
                axis.semilogy(run.time[: last + 1], line, "--", color=colour, linewidth=0.9)
        if not whole.all():
            axis.axvline(run.time[last], color="#888888", linewidth=0.8)
            axis.annotate("the rings part", (run.time[last], 2.6e-3), (3, 0), textcoords="offset points", color="#666666")
        axis.set_ylim(2e-3, 20.0)
        axis.set_xlabel("time (s)")
        axis.set_title(title(run, critical), fontsize=9)
    handles, labels = np.atleast_1d(axes)[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    np.atleast_1d(axes)[0].set_ylabel("amplitude of the pressure wave over mean pressure")
    figure.suptitle(f"Waves around the ring, {level};\ndashed: growth of theory for two half-planes, through the middle", fontsize=10)
    return written(figure, path)


def ends(runs, critical, level, path):
    """Pressure and temperature around the ring at the end."""
    figure, axes = plt.subplots(2, 1, figsize=(7.0, 5.2), sharex=True, layout="constrained")
    for run, colour in zip(runs, ("#0072B2", "#D55E00"), strict=True):
        x = 1e3 * run.x
        axes[0].plot(*monotone_cubic(x, run.pressure[-1] / 1e6), color=colour, label=title(run, critical))
        axes[1].plot(*monotone_cubic(x, run.temperature[-1] - 273.15), color=colour, label=title(run, critical))
    axes[0].set_ylabel("contact pressure (MPa)")
    axes[1].set_ylabel("temperature, mean of both surfaces (°C)")
    axes[1].set_xlabel("position around the steel ring x (mm)")
    axes[0].legend()
    figure.suptitle(f"After {runs[0].time[-1]:g} s; {level}", fontsize=10)
    return written(figure, path)
