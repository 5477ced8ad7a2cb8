"""Sensitivity of a result to the design's variables, from the scenes already run."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import rankdata


@dataclass(frozen=True)
class Sensitivity:
    """Of one result; one entry per variable."""

    first_order: np.ndarray  # part of the variance that the variable explains alone, 0 to 1
    interval: np.ndarray  # 95 % bootstrap interval of it, rows low and high
    rank_correlation: np.ndarray  # Spearman's, -1 to 1: the direction


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
    ranks = np.apply_along_axis(rankdata, 0, x)
    constant = np.ptp(y) == 0.0
    correlation = np.array([0.0 if constant else np.corrcoef(rank, rankdata(y))[0, 1] for rank in ranks.T])
    return Sensitivity(index, index + spread, correlation)
