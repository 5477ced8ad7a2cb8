"""Plots of the reciprocating punch."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)
import numpy as np  # noqa: E402

STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.2,
    "legend.frameon": False,
    "legend.fontsize": 8,
}
TITLES = {"translate": "punch that can only translate", "rotate": "punch that can also rotate about its pivot"}


def shown(history, count=6):
    """Rows of forward half-strokes to show: the first, then spread over the logarithm."""
    forward = np.flatnonzero(history.half_strokes % 2 == 1)
    wanted = np.geomspace(1, history.half_strokes[forward[-1]], count)
    nearest = [forward[np.argmin(np.abs(np.log(history.half_strokes[forward] / w)))] for w in wanted]
    return list(dict.fromkeys(nearest))


def pressures(axis, history, steady, direction):
    rows = [row + (0 if direction > 0 else 1) for row in shown(history)]
    colours = plt.cm.viridis(np.linspace(0.05, 0.9, len(rows)))
    for row, colour in zip(rows, colours, strict=True):
        label = f"half-stroke {history.half_strokes[row]}"
        axis.plot(1e3 * history.x, history.pressure[row] / 1e6, color=colour, label=label)
    if steady is not None:
        x, pressure = steady["forward" if direction > 0 else "backward"]
        axis.plot(1e3 * x, pressure / 1e6, "k--", linewidth=1.0, label="direct steady state")
    axis.axhline(history.mean / 1e6, color="#888888", linewidth=0.8)
    axis.set_ylim(0, 3.2 * history.mean / 1e6)
    axis.set_xlabel("position on the punch x [mm]")
    axis.set_ylabel("contact pressure [MPa]")
    axis.set_title(f"v {'>' if direction > 0 else '<'} 0", fontsize=9)
    axis.legend(ncols=2, loc="upper center")


def save_pressures(path, history, steady, title):
    figure, axes = plt.subplots(1, 2, figsize=(9.6, 4.0), sharey=True, layout="constrained")
    for axis, direction in zip(axes, (1, -1), strict=True):
        pressures(axis, history, steady, direction)
    figure.suptitle(f"Pressure at the middle of successive half-strokes: {title}", fontsize=10)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def save_edges(path, histories):
    figure, axes = plt.subplots(1, len(histories), figsize=(9.6, 3.8), sharey=True, layout="constrained")
    for axis, (name, history) in zip(axes, histories.items(), strict=True):
        forward = history.half_strokes % 2 == 1
        for station, edge, colour in ((0, "x = -a", "#0072B2"), (-1, "x = +a", "#D55E00")):
            for mask, style, way in ((forward, "-", "v > 0"), (~forward, "--", "v < 0")):
                ratio = history.pressure[mask, station] / history.mean
                axis.semilogx(history.half_strokes[mask], ratio, style, color=colour, label=f"{edge}, {way}")
        for level in (0, 1, 2):
            axis.axhline(level, color="#888888", linewidth=0.8)
        axis.set_xlabel("half-stroke [1]")
        axis.set_title(TITLES[name], fontsize=9)
    axes[0].set_ylabel("pressure in the edge interval over mean pressure [1]")
    axes[0].legend()
    figure.suptitle("Edge pressures go to 0 and to twice the mean", fontsize=10)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def save_shapes(path, histories):
    figure, axes = plt.subplots(1, len(histories), figsize=(9.6, 3.8), layout="constrained")
    for axis, (name, history) in zip(axes, histories.items(), strict=True):
        rows = shown(history)
        colours = plt.cm.viridis(np.linspace(0.05, 0.9, len(rows)))
        for row, colour in zip(rows, colours, strict=True):
            worn = history.worn[row]
            # Without the rigid motion: what reshapes the contact.
            line = np.polynomial.Polynomial.fit(history.x, worn, 1 if name == "rotate" else 0)
            label = f"half-stroke {history.half_strokes[row]}"
            axis.plot(1e3 * history.x, 1e6 * (worn - line(history.x)), color=colour, label=label)
        axis.set_xlabel("position on the punch x [mm]")
        axis.set_title(TITLES[name], fontsize=9)
        axis.legend(ncols=2)
    axes[0].set_ylabel("worn depth less its rigid motion [um]")
    figure.suptitle("Worn shape of the punch", fontsize=10)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def save_holders(path, histories, steadies):
    figure, axis = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
    for (name, history), colour in zip(histories.items(), ("#0072B2", "#D55E00"), strict=True):
        for row, style, way in ((-2, "-", "v > 0"), (-1, "--", "v < 0")):
            axis.plot(1e3 * history.x, history.pressure[row] / history.mean, style, color=colour, label=f"{name}, {way}")
        if name in steadies:
            x, pressure = steadies[name]["forward"]
            label = "direct" if name == "translate" else None
            axis.plot(1e3 * x, pressure / history.mean, "k:", linewidth=1.4, label=label)
    axis.set_xlabel("position on the punch x [mm]")
    axis.set_ylabel("contact pressure over mean [1]")
    axis.set_title("Last cycle, both holders, and the direct steady state", fontsize=10)
    axis.set_ylim(0, 2.3)
    axis.legend(ncols=2, loc="upper center")
    figure.savefig(path, dpi=130)
    plt.close(figure)


def save(folder, histories, steadies):
    """Writes all pictures; returns their paths."""
    plt.rcParams.update(STYLE)
    paths = [folder / f"pressures_{name}.png" for name in histories]
    for path, (name, history) in zip(paths, histories.items(), strict=True):
        save_pressures(path, history, steadies.get(name), TITLES[name])
    others = [folder / name for name in ("edge_pressures.png", "worn_shapes.png", "steady_pressures.png")]
    save_edges(others[0], histories)
    save_shapes(others[1], histories)
    save_holders(others[2], histories, steadies)
    return [*paths, *others]
