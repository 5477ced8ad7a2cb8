"""Figures of the runs."""

import csv

import cases
import numpy as np

ZERO_CELSIUS = 273.15


def end_of_slip(run):
    """Time at which the slip first reaches zero [s]."""
    passed = run["slip"] <= 1e-2 * cases.START_SPEED * 1e-2
    if not passed.any():
        raise RuntimeError(f"the clutch still slips at {run['slip'][-1]:.4g} rad/s")
    return float(run["time"][np.argmax(passed)])


def engagement(run, mean_radius):
    """Of an engagement that ends in stick."""
    end = end_of_slip(run)
    rest = run["time"] >= run["time"][-1] - 0.2
    speed = np.abs(run["slip"]) * mean_radius
    above = speed > run["critical_speed"]
    return {
        "step_ms": 1e3 * run.step,
        "slip_ends_s": end,
        "torque_peak_N_m": float(run["torque"].max()),
        "torque_stuck_N_m": float(run["torque"][rest].mean()),
        "torque_chatter_N_m": float(np.ptp(run["torque"][rest])),
        "slip_chatter_rad_per_s": float(np.ptp(run["slip"][rest])),
        "contact_temperature_peak_degC": float(run["contact_temperature_max"].max()) - ZERO_CELSIUS,
        "facing_wear_um": 1e6 * float(run["wear_depth_punch"][-1]),
        "friction_heat_kJ": float(run["dissipated_energy"][-1]) / 1e3,
        "critical_speed_m_per_s": float(run["critical_speed"][-1]),
        "above_critical_speed_s": float(above.sum() * run.step),
        "steps_per_second": run.steps_per_second,
    }


def implicit(run):
    """Work of the implicit master."""
    values, counts = np.unique(run.iterations, return_counts=True)
    return {
        "iterations_most": int(run.iterations.max()),
        "iterations_mean": float(run.iterations.mean()),
        "iterations_histogram": {int(value): int(count) for value, count in zip(values, counts)},
        "evaluations_most": int(run.evaluations.max()),
        "evaluations_mean": float(run.evaluations.mean()),
    }


def table(summary):
    """One screen of text."""
    lines = []
    for name, figures in summary.items():
        lines.append(f"  {name}")
        width = max(map(len, figures))
        for key, value in figures.items():
            shown = f"{value:.5g}" if isinstance(value, float) else str(value)
            lines.append(f"    {key:{width}}  {shown}")
    return "\n".join(lines)


def write_csv(path, run):
    """Every row of a run, seventeen digits, units in the headings."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([f"{name} [{unit}]" for name, unit in cases.UNITS.items()])
        for row in run.table.tolist():
            writer.writerow(map(repr, row))
    return path
