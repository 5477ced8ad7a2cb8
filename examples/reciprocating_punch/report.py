"""Figures of the runs beside the direct steady states."""

import direct
import numpy as np

CLOSE = 1e-2  # of the mean pressure: what counts as steady


def distances(history, state):
    """Root mean square distance of every recorded half-stroke's pressure from the direct steady state, over p_m."""
    exact = np.where((history.half_strokes % 2 == 1)[:, None], state.pressure[1], state.pressure[-1])
    return np.sqrt(np.mean((history.pressure - exact) ** 2, axis=1)) / history.mean


def relaxation(history, state):
    """Cycles in which the distance falls by e, over the decade below 0.1 of p_m; `None`: not there yet."""
    distance = distances(history, state)
    tail = (distance < 0.1) & (distance > 0.01)
    if tail.sum() < 3:
        return None
    return float(-1.0 / np.polyfit(history.cycles[tail], np.log(distance[tail]), 1)[0])


def figures(history, state):
    """Of one run."""
    distance = distances(history, state)
    edges = history.pressure[-2:, [0, -1]] / history.mean
    steady = history.cycles[distance < CLOSE]
    worn = direct.without_rigid_motion(history.x, history.worn[-1], state.name)
    (pressure_before, worn_before), (pressure_after, worn_after) = history.reversal["before"], history.reversal["after"]
    sums = (history.means[1] + history.means[-1]) / history.mean
    return {
        "wear_acceleration": history.acceleration,
        "cycles": int(history.half_strokes[-1] // 2),
        "forward: pressure at x = -a over p_m": edges[0, 0],
        "forward: pressure at x = +a over p_m": edges[0, 1],
        "backward: pressure at x = -a over p_m": edges[1, 0],
        "backward: pressure at x = +a over p_m": edges[1, 1],
        "sum of half-stroke means less 2 p_m, most, over p_m": float(np.abs(sums - 2.0).max()),
        "pressure less the direct one, root mean square, over p_m": distance[-2:].max(),
        "first cycle within 1 % of it": float(steady[0]) if steady.size else None,
        "cycles in which the distance falls by e": relaxation(history, state),
        "tilt forward, urad": 1e6 * history.tilt[-2],
        "jump of the tilt at reversal, urad": 1e6 * (history.tilt[-2] - history.tilt[-1]),
        "the same, direct, urad": 1e6 * (state.tilt[1] - state.tilt[-1]),
        "worn shape less the direct one, most, nm": 1e9 * np.abs(worn - state.shape).max(),
        "range of the worn shape, nm": 1e9 * np.ptp(worn),
        "jump of the pressure at reversal, most, over p_m": np.ptp([pressure_after, pressure_before], axis=0).max()
        / history.mean,
        "jump of the worn shape at reversal, nm": 1e9 * np.abs(worn_after - worn_before).max(),
        "contact temperature at the end, hottest station, degC": history.temperature[-1].max() - 273.15,
        "steps_per_second": history.steps / history.seconds,
    }


def table(summary):
    """One column for each run."""
    names = list(next(iter(summary.values())))
    width = max(map(len, names))
    lines = [f"  {'':{width}}" + "".join(f"{run:>24}" for run in summary)]
    for name in names:
        values = ["-" if values[name] is None else f"{values[name]:.4g}" for values in summary.values()]
        lines.append(f"  {name:{width}}" + "".join(f"{value:>24}" for value in values))
    return "\n".join(lines)


def write_csv(path, history):
    """Half-strokes by row: pressure, worn depth and temperature at the stations."""
    header = ["half_stroke", "tilt_rad", "approach_m"]
    header += [f"{name}_at_{1e3 * x:.4g}_mm" for name in ("pressure_Pa", "worn_m", "temperature_K") for x in history.x]
    columns = [history.half_strokes, history.tilt, history.approach, *history.pressure.T, *history.worn.T]
    columns += [*history.temperature.T]
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=",".join(header), comments="", fmt="%.9g")
    return path
