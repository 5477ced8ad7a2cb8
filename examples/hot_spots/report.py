"""Figures of the runs beside theory."""

import numpy as np

WAVES = 6


def measured(run, count):
    """Growth rate [1/s] of wave `count` while the contact is whole and the wave is small: the least squares slope of its
    logarithm over the later half of that time; `None` where that is too short."""
    amplitude = run.waves(count)[:, count - 1]
    whole = (run.scalars["contact_fraction"] > 0.999) & (run.waves(WAVES).max(axis=1) < 0.3)
    last = len(whole) if whole.all() else int(np.argmin(whole))
    # The layer after the start has gone, and what the unevenness itself presses is small beside the wave.
    part = slice(last // 2, last)
    if last < 40 or amplitude[part].max() < 3.0 * amplitude[1]:
        return None
    return float(np.polyfit(run.time[part], np.log(amplitude[part]), 1)[0])


def figures(run, rings, critical):
    """Of one run."""
    scalars = run.scalars
    lost = sum(scalars[name][-1] for name in ("heat_lost_ambient", "heat_lost_punch_top", "heat_lost_strip_base"))
    energy = scalars["dissipated_energy"][-1]
    mean = 0.5 * (run.pressure[:, 0] + run.pressure[:, -1]) / 32 + run.pressure[:, 1:-1].sum(axis=1) / 32
    values = {
        "speed, m/s": run.speed,
        "critical speed, m/s": critical,
        "least contact fraction": float(scalars["contact_fraction"].min()),
        "highest pressure over its mean": float((scalars["pressure_max"] / mean).max()),
        "highest contact temperature, degC": float(scalars["contact_temperature_max"].max() - 273.15),
        "mean contact temperature at the end, degC": float(scalars["contact_temperature"][-1] - 273.15),
        "energy balance error": float(abs(energy - scalars["stored_heat"][-1] - lost) / energy),
        "steps_per_second": (len(run.time) - 1) / run.seconds,
    }
    rates = [float(rings.growth(count, run.speed)) for count in range(1, WAVES + 1)]
    # The others are soon made of what the fastest one does to the contact.
    fastest = int(np.argmax(rates)) + 1
    values["fastest wave, number around the ring"] = fastest
    values["its growth in theory, 1/s"] = rates[fastest - 1]
    values["its growth measured, 1/s"] = measured(run, fastest)
    return values


def table(summary):
    """One column for each run."""
    names = list(next(iter(summary.values())))
    width = max(map(len, names))
    lines = [f"  {'':{width}}" + "".join(f"{run:>14}" for run in summary)]
    for name in names:
        values = ["-" if values[name] is None else f"{values[name]:.4g}" for values in summary.values()]
        lines.append(f"  {name:{width}}" + "".join(f"{value:>14}" for value in values))
    return "\n".join(lines)


def write_csv(path, run):
    """Instants by row: scalars, then pressure and temperature at the stations."""
    header = ["time_s", *run.scalars]
    header += [f"{name}_at_{1e3 * x:.4g}_mm" for name in ("pressure_Pa", "temperature_K") for x in run.x]
    columns = [run.time, *run.scalars.values(), *run.pressure.T, *run.temperature.T]
    np.savetxt(path, np.column_stack(columns)[::10], delimiter=",", header=",".join(header), comments="", fmt="%.9g")
    return path
