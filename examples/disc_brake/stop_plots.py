"""Plots of the stops from 100 km/h: the contact line beside the lumped level."""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import numpy as np  # noqa: E402
from plots import BLUE, GREEN, ORANGE, RED, SAVED, STYLE  # noqa: E402
from report import ZERO_CELSIUS  # noqa: E402

# One curve through the values at the stations for the package and the examples.
sys.path.append(str(Path(__file__).resolve().parents[2] / "python" / "sliding_contact"))

from _curve import monotone_cubic  # noqa: E402

LINES = {"line": "-", "lumped": "--"}


def both(axis, courses, paint):
    """Draws `paint` of either level in its own line style."""
    for level, course in courses.items():
        paint(axis, course, LINES[level], level)


def one_stop(courses, path):
    """The course of one stop, and the contact line at some of its times."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(3, 2, figsize=(9.6, 8.4), layout="constrained")
        (speed, torque), (temperature, pressure), (profile, hot) = axes
        line, lumped = courses["line"], courses["lumped"]
        both(speed, courses, lambda axis, c, style, level: axis.plot(c.time, 3.6 * c.speed, style, color=BLUE, label=level))
        speed.set_ylabel("car speed (km/h)")
        both(torque, courses, lambda axis, c, style, level: axis.plot(
            c.time, np.abs(c["friction_torque"]), style, color=GREEN, label=level))
        torque.set_ylabel("friction torque of one brake (N·m)")
        for name, label, colour in (
            ("contact_temperature_max", "hottest point", RED),
            ("contact_temperature", "mean of both surfaces", ORANGE),
            ("strip.mean_temperature", "disc, mean", BLUE),
        ):
            both(temperature, courses, lambda axis, c, style, level, name=name, label=label, colour=colour: axis.plot(
                c.time, c[name] - ZERO_CELSIUS, style, color=colour, label=f"{label}, {level}"))
        temperature.set_ylabel("temperature (°C)")
        pressure.plot(line.time, line["pressure_max"] / 1e6, color=RED, label="largest, line")
        pressure.plot(line.time, line["pressure_mean"] / 1e6, color=BLUE, label="mean, line")
        pressure.plot(lumped.time, lumped["pressure_mean"] / 1e6, "--", color=BLUE, label="lumped: one pressure")
        pressure.set_ylabel("contact pressure (MPa)")
        pressure.set_ylim(bottom=0)
        for axis in (speed, torque, temperature, pressure):
            axis.set_xlabel("time (s)")
            axis.set_xlim(0, line.time[-1])
            if axis is not temperature:
                axis.legend()
        # Room for the legend above the curves.
        temperature.set_ylim(0, 1.5 * (line["contact_temperature_max"].max() - ZERO_CELSIUS))
        temperature.legend(ncols=2, loc="upper center", columnspacing=0.8)
        colours = plt.cm.viridis(np.linspace(0.0, 0.92, len(line.snapshots)))
        for index, (at, colour) in enumerate(zip(line.snapshots, colours, strict=True)):
            profile.plot(*monotone_cubic(1e3 * line.x, line.profiles["pressure"][index] / 1e6), color=colour, label=f"{at:g} s")
            hot.plot(*monotone_cubic(1e3 * line.x, line.profiles["temperature"][index] - ZERO_CELSIUS), color=colour, label=f"{at:g} s")
        level = lumped["pressure_mean"].max() / 1e6
        profile.axhline(level, color="black", linestyle="--", linewidth=0.9, label="lumped, full load")
        profile.set_ylabel("contact pressure (MPa)")
        hot.set_ylabel("temperature, mean of both\nsurfaces (°C)")
        for axis in (profile, hot):
            axis.set_xlabel("position on the pad x (mm); the disc comes in at the right edge")
        profile.legend(ncols=2)
        hot.set_ylim(0, 1.25 * (line.profiles["temperature"].max() - ZERO_CELSIUS))
        hot.legend(ncols=3, loc="upper center")
        figure.suptitle("One stop from 100 km/h: the contact line (solid, 33 cells) and lumped (dashed), both at tolerance 1e-3")
        figure.savefig(path, **SAVED)
        plt.close(figure)
    return path


def fade(courses, path):
    """Fifteen stops: temperatures over time, and what each stop came to."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplot_mosaic(
            [["time", "time"], ["friction", "distance"], ["wear", "pressure"]], figsize=(9.6, 8.8), layout="constrained"
        )
        for level, course in courses.items():
            style = LINES[level]
            for name, label, colour in (
                ("contact_temperature_max", "hottest point of the contact", RED),
                ("strip.mean_temperature", "disc, mean", BLUE),
            ):
                axes["time"].plot(course.time, course[name] - ZERO_CELSIUS, style, color=colour, linewidth=0.9,
                                  label=f"{label}, {level}")  # fmt: skip
            stops = np.arange(1, len(course.distance) + 1)
            marks = {"linestyle": style, "marker": "o", "markersize": 3.5}
            worn = np.array([course["wear_depth_punch"][course.stop == number][-1] for number in stops - 1])
            friction = course.over_stops("friction_coefficient", np.min)
            axes["friction"].plot(stops, friction, color=GREEN, label=level, **marks)
            axes["distance"].plot(stops, course.distance, color=ORANGE, label=level, **marks)
            axes["wear"].plot(stops, 1e6 * np.diff(worn, prepend=0.0), color=BLUE, label=level, **marks)
            largest = course.over_stops("pressure_max", np.max) / 1e6
            axes["pressure"].plot(stops, largest, color=RED, label=level, **marks)
        axes["time"].set_xlabel("time (s)")
        axes["time"].set_ylabel("temperature (°C)")
        axes["time"].legend(ncols=2, loc="upper left")
        axes["time"].margins(x=0.01)
        axes["time"].set_ylim(0, 1.3 * max(course["contact_temperature_max"].max() - ZERO_CELSIUS for course in courses.values()))
        for name, label in (
            ("friction", "least friction coefficient"),
            ("distance", "stopping distance (m)"),
            ("wear", "wear of the pad in a stop (µm)"),
            ("pressure", "largest pressure in a stop (MPa)"),
        ):
            axes[name].set_xlabel("stop")
            axes[name].set_ylabel(label)
            axes[name].legend()
        figure.suptitle("Fifteen stops from 100 km/h, one every 45 s: the contact line (solid, 33 cells) and lumped (dashed), both at tolerance 1e-3")
        figure.savefig(path, **SAVED)
        plt.close(figure)
    return path
