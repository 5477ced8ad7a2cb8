"""Figures of a test: wear as the standard evaluates it, temperatures, energy."""

import csv

import numpy as np

ZERO_CELSIUS = 273.15
LOSSES = ("heat_lost_ambient", "heat_lost_punch_top", "heat_lost_strip_base")


def figures(run, load):
    """Of one test under `load` [N]."""
    time, distance = run["time"], run["sliding_distance"]
    volume = run["wear_volume_punch"]
    energy = run["dissipated_energy"]
    open_energy = energy - run["stored_heat"] - sum(run[name] for name in LOSSES)
    return {
        "duration, s": float(time[-1]),
        "distance, m": float(distance[-1]),
        "wear of the pin, 1e-3 mm3": 1e12 * float(volume[-1]),
        "its wear coefficient, 1e-5 mm3/(N.m)": 1e14 * float(volume[-1] / (load * distance[-1])),
        "wear of the disk, 1e-3 mm3": 1e12 * float(run["wear_volume_strip"][-1]),
        "friction force, N": float(run["friction_force"][-1]),
        "mean contact temperature at the end, degC": float(run["contact_temperature"][-1]) - ZERO_CELSIUS,
        "hottest point of the contact, degC": float(run["contact_temperature_max"].max()) - ZERO_CELSIUS,
        "friction heat, kJ": 1e-3 * float(energy[-1]),
        "part of it that leaves through the pin": float(run["heat_lost_punch_top"][-1] / energy[-1]),
        "energy balance error": float(np.abs(open_energy).max() / energy[-1]),
        "estimated error": float(run["estimated_error"][-1]),
        "steps per second": run.steps / run.seconds,
    }


def table(summary):
    """One column for each test."""
    names = list(next(iter(summary.values())))
    width = max(map(len, names))
    lines = [f"  {'':{width}}" + "".join(f"{run:>12}" for run in summary)]
    lines += [f"  {name:{width}}" + "".join(f"{values[name]:>12.4g}" for values in summary.values()) for name in names]
    return "\n".join(lines)


def write_csv(path, run):
    """Every recorded value with its unit in the heading."""
    names = run.table.dtype.names
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", *(f"{name} [{run.units[name]}]" for name in names[1:])])
        writer.writerows(map(repr, row) for row in run.table.tolist())
    return path
