"""Pictures of a finished batch."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import numpy as np  # noqa: E402

# Okabe and Ito's palette: told apart by every eye and in print.
BLUE, ORANGE, GREEN, RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"
STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 8,
    # Text stays text; without date and random names, the same run gives the same bytes.
    "svg.fonttype": "none",
    "svg.hashsalt": "sliding contact",
}


def sensitivities(path, names, results, title):
    """Two panels side by side: the part of the variance each variable explains, and the direction.

    `results`: label to `Sensitivity`.
    """
    colours = (GREEN, RED, BLUE, ORANGE)
    strongest = np.max([result.first_order for result in results.values()], axis=0)
    order = np.argsort(strongest)
    place = np.arange(len(names))
    thickness = 0.8 / len(results)
    with plt.rc_context(STYLE):
        figure, (variance, rank) = plt.subplots(
            1, 2, sharey=True, figsize=(9.5, 1.4 + 0.42 * len(names)), layout="constrained"
        )
        for at, ((label, result), colour) in enumerate(zip(results.items(), colours)):
            offset = place + (0.5 * (len(results) - 1) - at) * thickness
            index = np.clip(result.first_order[order], 0.0, 1.0)
            low = np.clip(index - result.interval[0, order], 0.0, None)
            high = np.clip(result.interval[1, order] - index, 0.0, None)
            variance.barh(
                offset, index, thickness, color=colour, label=label, xerr=[low, high], error_kw={"elinewidth": 0.8}
            )
            if result.total_order is not None:
                total = np.clip(result.total_order[order], 0.0, 1.0)
                label = "total order (with interactions)" if at == len(results) - 1 else None
                variance.barh(offset, total, thickness, facecolor="none", edgecolor="black", linewidth=0.7, label=label)
            rank.barh(offset, result.rank_correlation[order], thickness, color=colour, label=label)
        variance.set_yticks(place, [names[at] for at in order])
        variance.set_xlabel("first-order index $S_i$: part of the variance explained\n(bar: 95 % interval)")
        variance.set_xlim(left=0.0)
        rank.set_xlabel("Spearman's rank correlation\n(sign: direction)")
        rank.set_xlim(-1.0, 1.0)
        rank.set_xticks(np.linspace(-1.0, 1.0, 5))
        rank.axvline(0.0, color="black", linewidth=0.6)
        # Below the axes, where no bar is.
        figure.legend(*variance.get_legend_handles_labels(), loc="outside lower center", ncols=4)
        figure.suptitle(title, fontsize=10)
        figure.savefig(path, metadata={"Date": None})
        plt.close(figure)


def wear_life(path, life, unit, title):
    """Distribution of the wear life: how many scenes, and which part of them is worn out by then."""
    life = np.sort(life)
    early, half = np.percentile(life, [10, 50])
    with plt.rc_context(STYLE):
        figure, count = plt.subplots(figsize=(7.5, 4.2), layout="constrained")
        edges = np.geomspace(life[0], life[-1], min(60, max(8, life.size // 20)) + 1) if life[0] < life[-1] else 1
        count.hist(life, bins=edges, color=BLUE, alpha=0.75, histtype="stepfilled")
        count.set_xscale("log")
        count.set_xlabel(f"wear life ({unit})")
        count.set_ylabel("scenes", color=BLUE)
        part = count.twinx()
        part.grid(False)
        part.spines["right"].set_visible(True)
        # Of many scenes a few hundred points: more cannot be seen.
        shown = np.unique(np.linspace(0, life.size - 1, 400).astype(int))
        part.plot(life[shown], 100.0 * (shown + 1) / life.size, color=RED)
        part.set_ylabel("worn out by then (%)", color=RED)
        part.set_ylim(0, 103)
        for value, label in ((early, "10 %"), (half, "50 %")):
            count.axvline(value, color="black", linewidth=0.8, linestyle="--")
            count.annotate(
                f"{label}: {value:,.3g} {unit}" if value < 1000 else f"{label}: {value:,.0f} {unit}",
                (value, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, 3),
                textcoords="offset points",
                ha="center",
                va="bottom",
                fontsize=8,
            )
        ticks = matplotlib.ticker.FuncFormatter(lambda value, _place: f"{value:,.4g}" if value < 1e4 else f"{value:,.0f}")
        count.xaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
        count.xaxis.set_major_formatter(ticks)
        count.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
        figure.suptitle(title, fontsize=10)
        figure.savefig(path, metadata={"Date": None})
        plt.close(figure)
