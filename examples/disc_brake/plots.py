"""Plots of a run: five pictures one above the other, on one time axis."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import numpy as np  # noqa: E402

from report import ZERO_CELSIUS, stored_minus_lost  # noqa: E402

# Okabe and Ito's palette: told apart by every eye and in print.
BLUE, ORANGE, GREEN, RED, PURPLE, SKY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9"
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
    # Text stays text, to be found and edited. Without date and random names, the same run gives the same bytes.
    "svg.fonttype": "none",
    "svg.hashsalt": "sliding contact",
}
SAVED = {"metadata": {"Date": None}}
# Points of an area, which is not simplified as lines are.
MOST = 2000


def thinned(time):
    """Rows of at most `MOST` times, evenly spread, the last among them."""
    return np.unique(np.linspace(0, len(time) - 1, min(MOST, len(time))).round().astype(int))


def speed_and_load(axis, recording, drive):
    axis.plot(drive.time, 3.6 * drive.speed, color=BLUE)
    axis.set_ylabel("car speed (km/h)", color=BLUE)
    load = axis.twinx()
    load.spines["right"].set_visible(True)
    load.grid(False)
    some = thinned(recording["time"])
    load.fill_between(recording["time"][some], recording["normal_load"][some] / 1e3, color=ORANGE, alpha=0.75, linewidth=0)
    load.set_ylabel("pad load (kN)", color=ORANGE)
    load.set_ylim(0, 2.2 * recording["normal_load"].max() / 1e3)
    axis.set_ylim(bottom=0)


def temperatures(axis, recording, _drive):
    for name, label, colour in (
        ("contact_temperature_max", "hottest point", RED),
        ("strip.mean_temperature", "disc, mean", BLUE),
        ("punch.mean_temperature", "pad, mean", GREEN),
    ):
        axis.plot(recording["time"], recording[name] - ZERO_CELSIUS, color=colour, label=label)
    axis.set_ylabel("temperature (°C)")
    axis.legend(loc="upper right", ncols=3)
    low, high = axis.get_ylim()
    axis.set_ylim(low, high + 0.2 * (high - low))


def wear(axis, recording, _drive):
    for name, label, colour in (("wear_depth_punch", "pad", GREEN), ("wear_depth_strip", "disc, each face", BLUE)):
        axis.plot(recording["time"], 1e6 * recording[name], color=colour, label=label)
    axis.set_ylabel("wear depth (µm)")
    axis.set_ylim(bottom=0)
    axis.legend(loc="upper left")


def friction_torque(axis, recording, _drive):
    axis.plot(recording["time"], recording["friction_torque"], color=PURPLE, linewidth=0.9)
    axis.set_ylabel("friction torque (N·m)")
    axis.set_ylim(bottom=min(0.0, recording["friction_torque"].min()))


def energy_balance(axis, recording, _drive):
    time = recording["time"]
    some = thinned(time)
    parts = (
        ("stored_heat", "stored", SKY),
        ("heat_lost_ambient", "lost to the air", ORANGE),
        ("heat_lost_punch_top", "lost to the caliper", GREEN),
        ("heat_lost_strip_base", "lost through the disc's base", PURPLE),
    )
    # What is a line's width or less of the whole is no area.
    energy = recording["dissipated_energy"]
    parts = [part for part in parts if np.abs(recording[part[0]]).max() > 1e-3 * energy[-1]]
    axis.stackplot(
        time[some],
        *(recording[name][some] / 1e3 for name, _, _ in parts),
        labels=[label for _, label, _ in parts],
        colors=[colour for *_, colour in parts],
        linewidth=0,
    )
    axis.plot(time, energy / 1e3, color="black", label="friction heat")
    axis.set_ylabel("energy (kJ)")
    axis.set_xlabel("time (s)")
    axis.set_ylim(bottom=0)
    error = np.abs(stored_minus_lost(recording)).max() / energy[-1]
    axis.set_title(f"balance closed to {error:.0e} of the energy in", fontsize=8, loc="right", pad=2)
    axis.legend(loc="upper left")


PANELS = (
    ("Speed and load", speed_and_load),
    ("Temperatures", temperatures),
    ("Wear", wear),
    ("Friction torque", friction_torque),
    ("Energy balance", energy_balance),
)


def draw(recording, drive, title, panels=PANELS):
    """The figure of the given panels."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            len(panels), 1, sharex=True, figsize=(9.0, 2.1 * len(panels) + 0.5), layout="constrained", squeeze=False
        )
        for axis, (name, paint) in zip(axes[:, 0], panels):
            paint(axis, recording, drive)
            axis.set_title(name, loc="left", fontweight="bold", fontsize=9)
            axis.set_xlim(drive.time[0], drive.time[-1])
        axes[-1, 0].set_xlabel("time (s)")
        figure.align_ylabels(axes[:, 0])
        figure.suptitle(title)
    return figure


def save(folder, recording, drive, title):
    """Writes all panels as `overview`, the first three as `summary` and each on its own; returns the paths."""
    paths = []
    with plt.rc_context(STYLE):
        single = [(name.lower().replace(" ", "_"), [(name, paint)]) for name, paint in PANELS]
        for stem, panels in [("overview", PANELS), ("summary", PANELS[:3]), *single]:
            figure = draw(recording, drive, title, panels)
            path = folder / f"{stem}.svg"
            figure.savefig(path, **SAVED)
            paths.append(path)
            plt.close(figure)
    return paths
