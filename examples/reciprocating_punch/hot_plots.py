"""Plots of the reciprocating punch with the heat of friction."""

import direct
import matplotlib.pyplot as plt
import numpy as np
from plots import BLUE, GREY, OPEN, ORANGE, TITLES, levels, monotone_cubic, palette, shown, written

ZERO_CELSIUS = 273.15


def half_strokes(hot, path):
    """Pressure and temperature of successive half-strokes, by holder: v > 0 solid, the following v < 0 dotted."""
    figure, axes = plt.subplots(2, len(hot), figsize=(8.8, 6.6), sharex=True, sharey="row", layout="constrained")
    for column, (name, history) in zip(axes.T, hot.items(), strict=True):
        rows, x = shown(history), 1e3 * history.x
        levels(column[0])
        for row, colour in zip(rows, palette(rows), strict=True):
            cycle = (history.half_strokes[row] + 1) // 2
            for record, style, label in ((row, "-", f"cycle {cycle}"), (row + 1, ":", None)):
                column[0].plot(*monotone_cubic(x, history.pressure[record] / history.mean), style, color=colour, label=label)
                column[1].plot(*monotone_cubic(x, history.temperature[record] - ZERO_CELSIUS), style, color=colour, label=label)
        column[0].set_title(TITLES[name], fontsize=9)
        column[0].set_ylim(-0.1, 5.6)
        column[0].legend(ncols=2, loc="upper center")
        column[1].set_xlabel("position on the punch x (mm)")
    axes[0, 0].set_ylabel("contact pressure over mean $p/p_m$")
    axes[1, 0].set_ylabel("temperature, mean of both surfaces (°C)")
    mean = next(iter(hot.values())).mean / 1e6
    figure.suptitle(
        f"With heat, level line: middle of successive half-strokes, v > 0 solid, v < 0 dotted, $p_m$ = {mean:.2f} MPa", fontsize=10
    )
    return written(figure, path)


def shapes(cold, hot, path):
    """Worn depth less its rigid motion without and with heat, side by side, by holder."""
    figure, axes = plt.subplots(len(hot), 2, figsize=(8.8, 6.4), sharex=True, sharey=True, layout="constrained")
    for pair, name in zip(axes, hot, strict=True):
        for axis, history, label in zip(pair, (cold[name], hot[name]), ("without heat", "with heat"), strict=True):
            rows = shown(history)
            for row, colour in zip(rows, palette(rows), strict=True):
                worn = direct.without_rigid_motion(history.x, history.worn[row], name)
                cycle = (history.half_strokes[row] + 1) // 2
                axis.plot(*monotone_cubic(1e3 * history.x, 1e6 * worn), color=colour, label=f"cycle {cycle}")
            axis.set_title(f"{TITLES[name]}, {label}", fontsize=9)
            axis.legend()
        pair[0].set_ylabel("worn depth less rigid motion (µm)")
    for axis in axes[-1]:
        axis.set_xlabel("position on the punch x (mm)")
    figure.suptitle("Worn shape of the punch without and with heat", fontsize=10)
    return written(figure, path)


def steady(states, cold, hot, path):
    """The last pressures of both holders, without and with heat, on the direct steady states."""
    figure, axis = plt.subplots(figsize=(8.8, 4.6), layout="constrained")
    levels(axis)
    for (name, history), colour in zip(hot.items(), (BLUE, ORANGE), strict=True):
        state = states[name]
        for sign, style, way in ((1, "-", "v > 0"), (-1, "--", "v < 0")):
            label = f"{TITLES[name]}, {way}: direct, without heat"
            axis.plot(*monotone_cubic(1e3 * state.x, state.pressure[sign] / history.mean), style, color=colour, label=label)
            row = -2 if sign > 0 else -1
            cycles = int(history.half_strokes[-1] // 2)
            label = f"with heat, cycle {cycles}" if sign > 0 else None
            axis.plot(1e3 * history.x, history.pressure[row] / history.mean, color=colour, label=label,
                      **{**OPEN, "markevery": 1})  # fmt: skip
            label = f"without heat, cycle {int(cold[name].half_strokes[-1] // 2)}" if sign > 0 else None
            axis.plot(1e3 * cold[name].x, cold[name].pressure[row] / history.mean, color=GREY, linestyle="", marker=".",
                      markersize=3, label=label)  # fmt: skip
    axis.set_xlabel("position on the punch x (mm)")
    axis.set_ylabel("contact pressure over mean $p/p_m$")
    axis.set_ylim(-0.1, 2.9)
    axis.legend(ncols=2, loc="upper center")
    axis.set_title("Steady pressures with and without heat", fontsize=10)
    return written(figure, path)
