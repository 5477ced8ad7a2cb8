"""The curve that is drawn through values at few stations."""

import numpy as np
from sliding_contact._curve import monotone_cubic


def test_a_curve_keeps_its_stations_and_has_no_extremes_of_its_own():
    x = np.linspace(0.0, 1.0, 33) ** 1.5
    pressure = np.where(x < 0.4, 0.0, np.abs(np.sin(12.0 * x)))
    at, values = monotone_cubic(x, pressure)
    assert at.size == 257 and np.allclose(at[::8], x) and np.allclose(values[::8], pressure)
    assert values.min() == 0.0 and not values[at <= x[x < 0.4].max()].any()
    low, high = np.minimum(pressure[:-1], pressure[1:]), np.maximum(pressure[:-1], pressure[1:])
    cell = np.minimum(np.arange(257) // 8, 31)
    assert (values >= low[cell] - 1e-12).all() and (values <= high[cell] + 1e-12).all()
    # Between the stations it is a curve, not a polygon.
    assert np.abs(values - np.interp(at, x, pressure)).max() > 0.01
