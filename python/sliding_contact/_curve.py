"""The curve that is drawn through values at few stations. Needs numpy alone: the examples, which run without the package, take it from here."""

from __future__ import annotations

import numpy as np

POINTS = 257  # of a curve at least: more cannot be seen


def monotone_cubic(x: np.ndarray, y: np.ndarray, points: int = POINTS) -> tuple[np.ndarray, np.ndarray]:
    """Monotone cubic interpolation (Fritsch and Carlson) at the stations and equally spaced between neighbouring ones: the curve has no
    extremes of its own, so a pressure that is 0 at neighbouring stations is 0 between them, and nowhere below.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    if x.size < 2:
        return x, y
    width = np.diff(x)
    secant = np.diff(y) / width
    product = secant[:-1] * secant[1:]
    # Harmonic mean: within the monotone region.
    inner = np.divide(2.0 * product, secant[:-1] + secant[1:], out=np.zeros_like(product), where=product > 0.0)
    slope = np.concatenate([secant[:1], inner, secant[-1:]])
    parts = max(-(-(points - 1) // width.size), 1)
    index = np.arange(parts * width.size + 1)
    cell = np.minimum(index // parts, width.size - 1)
    t = (index - parts * cell) / parts
    at = x[cell] + t * width[cell]
    left, right, rise = width[cell] * slope[cell], width[cell] * slope[cell + 1], y[cell + 1] - y[cell]
    return at, y[cell] + t * (left + t * ((3.0 * rise - 2.0 * left - right) + t * (left + right - 2.0 * rise)))
