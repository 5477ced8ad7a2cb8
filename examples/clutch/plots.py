"""Plots of the runs."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import numpy as np  # noqa: E402
from plant import RADIANS_PER_SECOND  # noqa: E402
from report import ZERO_CELSIUS, end_of_slip  # noqa: E402

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


def save(panels, title, path, sharex=True):
    """A figure of panels (name, function that paints an axis), one above the other."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            len(panels), 1, figsize=(9.0, 2.1 * len(panels) + 0.5), layout="constrained", squeeze=False, sharex=sharex
        )
        for axis, (name, paint) in zip(axes[:, 0], panels):
            paint(axis)
            axis.set_title(name, loc="left", fontweight="bold", fontsize=9)
        figure.align_ylabels(axes[:, 0])
        figure.suptitle(title)
        figure.savefig(path, metadata={"Date": None})
        plt.close(figure)
    return path


def engagement(run, level, path):
    time = run["time"]

    def speeds(axis):
        axis.plot(time, run["engine_speed"] / RADIANS_PER_SECOND, color=RED, label="engine")
        axis.plot(time, run["vehicle_speed"] / RADIANS_PER_SECOND, color=BLUE, label="transmission input")
        axis.set_ylabel("speed (rev/min)")
        axis.legend()

    def torque(axis):
        axis.plot(time, run["torque"], color=PURPLE)
        axis.set_ylabel("torque (N·m)")

    def temperature(axis):
        axis.plot(time, run["contact_temperature_max"] - ZERO_CELSIUS, color=ORANGE)
        axis.set_ylabel("hottest point (°C)")

    def wear(axis):
        axis.plot(time, 1e9 * run["wear_depth_punch"], color=GREEN)
        axis.set_ylabel("wear of a facing (nm)")
        axis.set_xlabel("time (s)")

    panels = (("Speeds", speeds), ("Clutch torque", torque), ("Temperature", temperature), ("Wear", wear))
    return save(panels, f"Engagement from 3,000 rev/min, bristle at the end, level {level}", path)


def masters(runs, path):
    """Around the end of slip: `runs` is label -> run."""
    end = end_of_slip(next(iter(runs.values())))
    colours = (RED, BLUE, GREEN, ORANGE)

    def quantity(name, label, factor, last=False):
        def paint(axis):
            # What explodes is drawn first, so that it hides nothing.
            for (text, run), colour in zip(runs.items(), colours):
                rows = np.abs(run["time"] - end) < 0.05
                axis.plot(run["time"][rows] - end, factor * run[name][rows], color=colour, label=text, linewidth=0.9)
            axis.set_ylabel(label)
            if name == "slip":
                axis.set_ylim(-3.0, 6.0)
            if last:
                axis.set_xlabel("time since the slip has ended (s)")
            else:
                axis.legend(loc="upper right")
        return paint

    panels = (("Slip", quantity("slip", "slip (rad/s)", 1.0)), ("Clutch torque", quantity("torque", "torque (N·m)", 1.0, True)))
    return save(panels, "The end of slip under four masters", path)


def hill(run, travel, path):
    def position(axis):
        axis.plot(run["time"], 1e3 * travel, color=RED)
        axis.axhline(1.0, color="black", linewidth=0.8, linestyle=":")
        axis.text(run["time"][-1], 1.0, "1 mm ", ha="right", va="bottom", fontsize=8)
        axis.set_ylim(-0.2, 1.3)
        axis.set_ylabel("travel of the car (mm)")

    def torque(axis):
        axis.plot(run["time"], run["torque"], color=PURPLE)
        axis.set_ylabel("clutch torque (N·m)")
        axis.set_xlabel("time (s)")

    return save((("Drift", position), ("Torque", torque)), "Parked in gear on a 10 % grade", path)


def judder(with_stribeck, without, path):
    def speed(axis):
        for run, colour, label in ((with_stribeck, RED, "friction rises towards standstill"), (without, BLUE, "constant friction")):
            axis.plot(run["time"], run["slip"], color=colour, label=label, linewidth=0.8)
        axis.set_ylabel("slip (rad/s)")
        axis.legend(loc="upper left")
        axis.margins(y=0.25)

    def torque(axis):
        axis.plot(with_stribeck["time"], with_stribeck["torque"], color=RED, linewidth=0.8)
        axis.plot(without["time"], without["torque"], color=BLUE, linewidth=0.8)
        axis.set_ylabel("clutch torque (N·m)")
        axis.set_xlabel("time (s)")

    return save((("Slip", speed), ("Torque", torque)), "Creeping with a slipping clutch: judder", path)


def critical_speed(engaging, carbon, mean_radius, path):
    def paint_for(run, title):
        def paint(axis):
            axis.semilogy(run["time"], np.maximum(np.abs(run["slip"]) * mean_radius, 1e-6), color=BLUE, label="sliding speed")
            axis.semilogy(run["time"], run["critical_speed"], color=RED, linestyle="--", label="critical speed")
            axis.set_ylabel("speed (m/s)")
            axis.set_ylim(1e-4, 1e3)
            axis.legend(loc="upper right", ncols=2)
            axis.set_xlabel("time (s)")
        return title, paint

    panels = (paint_for(engaging, "Organic facing, engagement"), paint_for(carbon, "Carbon on carbon, slip up to twice the limit"))
    return save(panels, "Sliding speed against the thermoelastic limit", path, sharex=False)
