"""Sensitivity of a result to the design's variables, from the scenes already run."""

from dataclasses import dataclass
from typing import Optional

import numpy as np
from scipy.stats import rankdata


@dataclass(frozen=True)
class Sensitivity:
    """Of one result; one entry per variable."""

    first_order: np.ndarray  # part of the variance that the variable explains alone, 0 to 1
    interval: np.ndarray  # 95 % bootstrap interval of it, rows low and high
    rank_correlation: np.ndarray  # Spearman's, -1 to 1: the direction
    total_order: Optional[np.ndarray] = None  # part of the variance that is left when all the others are known
    total_interval: Optional[np.ndarray] = None  # 95 % bootstrap interval of it, rows low and high


def first_order(x, y, classes=None):
    """First-order variance-based index Var(E[y | x]) / Var(y) (Sobol's S_i) from given data.

    The scenes are sorted by `x` into classes of equal size; the variance of the classes' means, less what chance gives
    (K - 1 classes of N scenes catch (K - 1)/(N - K) of the variance within them: Kelley's epsilon squared), is
    compared with the whole; 0 where y does not vary. Unbiased for scenes drawn by chance and classes narrow against the
    changes of E[y | x]. Sobol's sequence is spread more evenly, so that its indices come out low by up to (K - 1)/(N - K).
    """
    y = np.asarray(y, dtype=np.float64)
    count = y.size
    classes = classes or max(2, min(50, int(round(np.sqrt(count) / 2))))
    if count <= classes:
        raise ValueError(f"{count} scenes are too few for {classes} classes")
    groups = np.array_split(y[np.argsort(x, kind="stable")], classes)
    total = np.sum((y - y.mean()) ** 2)
    if total <= (count * np.finfo(float).eps * np.abs(y).max()) ** 2:
        return 0.0
    between = sum(group.size * (group.mean() - y.mean()) ** 2 for group in groups)
    within = total - between
    return float((between - (classes - 1) * within / (count - classes)) / total)


def analyse(x, y, seed=0, resamplings=100):
    """Sensitivity of the result `y` (scenes) to the variables `x` (scenes, variables)."""
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    columns = range(x.shape[1])
    index = np.array([first_order(x[:, column], y) for column in columns])
    random = np.random.default_rng(seed)
    resampled = np.empty((resamplings, x.shape[1]))
    for row in resampled:
        chosen = random.integers(0, y.size, y.size)
        row[:] = [first_order(x[chosen, column], y[chosen]) for column in columns]
    # Scenes drawn twice inflate the index; only the spread of the bootstrap is used.
    spread = np.percentile(resampled, [2.5, 97.5], axis=0) - np.median(resampled, axis=0)
    return Sensitivity(index, index + spread, rank_correlation(x, y))


def rank_correlation(x, y):
    """Spearman's correlation of the result with every variable; 0 where it does not vary."""
    ranks = np.apply_along_axis(rankdata, 0, x)
    constant = np.ptp(y) == 0.0
    return np.array([0.0 if constant else np.corrcoef(rank, rankdata(y))[0, 1] for rank in ranks.T])


def analyse_total_order(design, x, y, seed=0):
    """First-order and total-order indices by SALib (Saltelli 2010, Jansen) of a `TotalOrderDesign`; `y` is not a number where a scene failed.

    A group with a failed scene is left out.
    """
    from SALib.analyze import sobol

    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    size = len(design.variables) + 2
    whole = np.repeat(np.isfinite(y).reshape(-1, size).all(axis=1), size)
    x, y = x[whole], y[whole]
    if y.size < 2 * size or np.ptp(y) == 0.0:
        raise ValueError(f"{y.size // size} groups of scenes without a failed one, with results that vary, are too few")
    found = sobol.analyze(design.problem(), y, calc_second_order=False, seed=seed)
    first, total = (np.array([found[name] - found[f"{name}_conf"], found[name] + found[f"{name}_conf"]]) for name in ("S1", "ST"))
    return Sensitivity(found["S1"], first, rank_correlation(x, y), found["ST"], total)
