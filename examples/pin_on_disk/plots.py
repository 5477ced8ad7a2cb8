"""Plots of the tests over the distance slid."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)

from report import ZERO_CELSIUS  # noqa: E402

# Okabe and Ito's palette: told apart by every eye and in print.
COLOURS = ("#0072B2", "#009E73", "#D55E00")
STYLE = {
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "pin on disk",
}


def over_the_distance(runs, path):
    """Worn volume, hottest point of the contact, mean temperature of pin and disk."""
    quantities = (
        ("worn volume\nof the pin (0.001 mm³)", lambda run: 1e12 * run["wear_volume_punch"]),
        ("hottest point\nof the contact (°C)", lambda run: run["contact_temperature_max"] - ZERO_CELSIUS),
        ("mean temperature\nof the pin (°C)", lambda run: run["punch.mean_temperature"] - ZERO_CELSIUS),
    )
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, len(quantities), figsize=(180 / 25.4, 2.2), layout="constrained")
        for axis, (label, of) in zip(axes, quantities, strict=True):
            for (name, run), colour, dash in zip(runs.items(), COLOURS, ("-", "--", "-."), strict=True):
                axis.plot(run["sliding_distance"], of(run), dash, color=colour, label=name)
            axis.set_xlabel("distance (m)")
            axis.set_ylabel(label)
            axis.set_xlim(0.0, 1000.0)
        axes[0].set_ylim(bottom=0.0)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=len(runs))
        # Without the date, the same run gives the same bytes.
        figure.savefig(path, metadata={"Date": None})
        plt.close(figure)
    return path
