"""Plots of the drives."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import numpy as np  # noqa: E402
from report import ZERO_CELSIUS  # noqa: E402
from system import VEHICLE  # noqa: E402

# Okabe and Ito's palette: told apart by every eye and in print.
BLUE, ORANGE, GREEN, RED, PURPLE = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7"
STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 8,
    # Without date and random names, the same run gives the same bytes.
    "svg.fonttype": "none",
    "svg.hashsalt": "sliding contact",
}


def figure_of(panels, title, width=9.0, **options):
    figure, axes = plt.subplots(
        len(panels), 1, figsize=(width, 2.1 * len(panels) + 0.5), layout="constrained", squeeze=False, **options
    )
    for axis, (name, paint) in zip(axes[:, 0], panels):
        paint(axis)
        axis.set_title(name, loc="left", fontweight="bold", fontsize=9)
    figure.align_ylabels(axes[:, 0])
    figure.suptitle(title)
    return figure


def save(figure, path):
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    return path


def along(recording, title, path):
    """A drive over time: speed, forces, temperatures, friction, wear."""
    time = recording.time

    def speed(axis):
        axis.plot(time, 3.6 * recording[VEHICLE, "reference_speed"], color=ORANGE, label="reference", linewidth=2.2)
        axis.plot(time, 3.6 * recording[VEHICLE, "speed"], color=BLUE, label="car", linewidth=0.9)
        axis.set_ylabel("speed (km/h)")
        axis.margins(y=0.2)
        axis.set_ylim(bottom=0.0)
        axis.legend(loc="upper right", ncols=2)

    def force(axis):
        # At rest the brakes could give it but do not have to.
        drives = recording[VEHICLE, "speed"] > 0.0
        for axle, colour in (("front", BLUE), ("rear", ORANGE)):
            values = np.where(drives, recording[VEHICLE, f"{axle}_brake_force"], np.nan)
            axis.plot(time, values / 1e3, color=colour, label=f"{axle} axle", linewidth=0.9)
        axis.set_ylabel("brake force (kN)")
        axis.margins(y=0.25)
        axis.set_ylim(bottom=0.0)
        axis.legend(loc="upper right", ncols=2)

    def temperature(axis):
        for brake, colour in (("front_left", BLUE), ("rear_left", ORANGE)):
            place = brake.split("_")[0]
            axis.plot(time, recording[brake, "contact_temperature"] - ZERO_CELSIUS, color=colour, linewidth=0.6,
                      alpha=0.7, label=f"{place}, mean of both surfaces")
            axis.plot(time, recording[brake, "strip.mean_temperature"] - ZERO_CELSIUS, color=colour, linestyle="--",
                      label=f"{place} disc")
        axis.set_ylabel("temperature (°C)")
        axis.legend(loc="upper left", ncols=4)
        axis.margins(y=0.25)
        axis.set_ylim(bottom=0.0)

    def friction(axis):
        for brake, colour in (("front_left", BLUE), ("front_right", GREEN), ("rear_left", ORANGE)):
            axis.plot(time, recording[brake, "friction_coefficient"], color=colour, label=brake.replace("_", " "))
        axis.set_ylabel("friction coefficient")
        axis.legend(loc="lower left", ncols=3)

    def wear(axis):
        for brake, colour in (("front_left", BLUE), ("rear_left", ORANGE)):
            axis.plot(time, 1e6 * recording[brake, "wear_depth_punch"], color=colour, label=brake.replace("_", " "))
        axis.set_ylabel("pad wear (µm)")
        axis.set_xlabel("time (s)")
        axis.legend(loc="upper left", ncols=2)

    panels = (("Speed", speed), ("Brake forces while driving", force), ("Temperatures", temperature),
              ("Friction", friction), ("Wear", wear))
    with plt.rc_context(STYLE):
        return save(figure_of(panels, title, sharex=True), path)


def stops(cold, hot, begins, path):
    """A stop with cold and with hot brakes over the distance since the pedal was pressed."""
    runs = ((cold, begins[0], BLUE, "cold"), (hot, begins[1], RED, "foot of the descent"))

    def over_distance(recording, begin):
        rows = recording.time >= begin - 1e-9
        start = np.interp(begin, recording.time, recording[VEHICLE, "position"])
        return recording[VEHICLE, "position"][rows] - start, rows

    def speed(axis):
        for recording, begin, colour, label in runs:
            distance, rows = over_distance(recording, begin)
            axis.plot(distance, 3.6 * recording[VEHICLE, "speed"][rows], color=colour,
                      label=f"{label}: {distance[-1]:.1f} m")
        axis.set_ylabel("speed (km/h)")
        axis.legend()

    def quantity(name, factor, offset, label):
        def paint(axis):
            for recording, begin, colour, text in runs:
                distance, rows = over_distance(recording, begin)
                for brake, line in (("front_left", "-"), ("rear_left", "--")):
                    axis.plot(distance, factor * recording[brake, name][rows] + offset, color=colour, linestyle=line,
                              label=f"{text}, {brake.split('_')[0]}")
            axis.set_ylabel(label)
        return paint

    def friction(axis):
        quantity("friction_coefficient", 1.0, 0.0, "friction coefficient")(axis)
        axis.set_ylim(bottom=0.0)
        axis.set_xlabel("distance since the pedal was pressed (m)")
        axis.legend(loc="lower right", ncols=2)

    panels = (("Speed", speed),
              ("Contact temperature, mean of both surfaces", quantity("contact_temperature", 1.0, -ZERO_CELSIUS, "temperature (°C)")),
              ("Friction", friction))
    with plt.rc_context(STYLE):
        return save(figure_of(panels, "The same pedal, cold and after the descent", sharex=True), path)


def hill(recording, path):
    """Coming to rest on a grade, and standing there."""
    time = recording.time
    first = int(np.argmax(recording[VEHICLE, "speed"] == 0.0))

    def speed(axis):
        axis.plot(time, recording[VEHICLE, "speed"], color=BLUE)
        axis.set_ylabel("speed (m/s)")

    def drift(axis):
        position = recording[VEHICLE, "position"]
        axis.plot(time[first:], 1e3 * (position[first:] - position[first]), color=RED)
        axis.axhline(1.0, color="black", linewidth=0.8, linestyle=":")
        axis.text(time[-1], 1.0, "1 mm ", ha="right", va="bottom", fontsize=8)
        axis.set_ylabel("travel since standstill (mm)")
        axis.set_ylim(-0.2, 1.3)
        axis.set_xlabel("time (s)")

    with plt.rc_context(STYLE):
        return save(figure_of((("Speed", speed), ("Drift", drift)), "Held on a 10 % grade", sharex=True), path)
