"""Figures of the drives: what happened, what is conserved, how fast it went."""

import csv

import numpy as np
from system import BRAKES, VEHICLE

ZERO_CELSIUS = 273.15


def coupling_error(recording):
    """Heat made in the contacts less the car's brake work, relative to the latter. A contact sees the speed that the
    car had at the last communication point, so this is of first order in the communication step."""
    work = recording[VEHICLE, "brake_work"][-1]
    heat = sum(recording[brake, "dissipated_energy"][-1] for brake in BRAKES)
    return float(heat / work - 1.0)


def balance_error(recording):
    """Largest heat not accounted for in any contact at any time, relative to the heat made in it."""
    worst = 0.0
    for brake in BRAKES:
        energy = recording[brake, "dissipated_energy"]
        out = sum(recording[brake, f"heat_lost_{way}"] for way in ("ambient", "punch_top", "strip_base"))
        worst = max(worst, np.abs(energy - recording[brake, "stored_heat"] - out).max() / energy[-1])
    return float(worst)


def stop_figures(recording, begin):
    """Of a full stop that begins at the time `begin` [s]."""
    at = lambda name: float(np.interp(begin, recording.time, recording[VEHICLE, name]))  # noqa: E731
    position, speed = recording[VEHICLE, "position"], recording[VEHICLE, "speed"]
    if speed[-1] != 0.0:
        raise RuntimeError(f"the car did not stop: it still drives {speed[-1]:.3g} m/s")
    return {
        "speed_km_per_h": 3.6 * at("speed"),
        "distance_m": float(position[-1]) - at("position"),
        "duration_s": float(recording.time[np.argmax((speed == 0.0) & (recording.time > begin))]) - begin,
        "front_disc_before_degC": float(np.interp(begin, recording.time, recording["front_left", "strip.mean_temperature"]))
        - ZERO_CELSIUS,
        "rear_disc_before_degC": float(np.interp(begin, recording.time, recording["rear_left", "strip.mean_temperature"]))
        - ZERO_CELSIUS,
        "front_friction_lowest": float(recording["front_left", "friction_coefficient"][recording.time >= begin].min()),
        "rear_friction_lowest": float(recording["rear_left", "friction_coefficient"][recording.time >= begin].min()),
    }


def hill_figures(recording, seconds=60.0):
    """Of standing still: travel over `seconds` [s] after the car has come to rest."""
    speed, position = recording[VEHICLE, "speed"], recording[VEHICLE, "position"]
    first = int(np.argmax(speed == 0.0))
    last = int(np.searchsorted(recording.time, recording.time[first] + seconds - 1e-9))
    if speed[first] != 0.0 or last >= len(position):
        raise RuntimeError(f"the car has not stood for {seconds:g} s")
    return {
        "grade": float(recording[VEHICLE, "grade"][last]),
        "seconds": float(recording.time[last] - recording.time[first]),
        "drift_mm": float(1e3 * np.abs(position[first : last + 1] - position[first]).max()),
    }


def cycle_figures(recording):
    speed, reference = recording[VEHICLE, "speed"], recording[VEHICLE, "reference_speed"]
    return {
        "distance_km": float(recording[VEHICLE, "position"][-1]) / 1e3,
        "speed_error_rms_km_per_h": 3.6 * float(np.sqrt(np.mean((speed - reference) ** 2))),
        "front_disc_peak_degC": float(recording["front_left", "strip.mean_temperature"].max()) - ZERO_CELSIUS,
        "rear_disc_peak_degC": float(recording["rear_left", "strip.mean_temperature"].max()) - ZERO_CELSIUS,
        "front_pad_wear_um": 1e6 * float(recording["front_left", "wear_depth_punch"][-1]),
        "rear_pad_wear_um": 1e6 * float(recording["rear_left", "wear_depth_punch"][-1]),
        "brake_heat_kJ": sum(float(recording[brake, "dissipated_energy"][-1]) for brake in BRAKES) / 1e3,
    }


def run_figures(recording):
    """Of any drive."""
    return {
        "steps": recording.steps,
        "steps_per_second": recording.steps / recording.seconds,
        "coupling_error": coupling_error(recording),
        "heat_balance_error": balance_error(recording),
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


def write_csv(path, recording, every=10):
    """One row in `every` steps, seventeen digits, units in the headings."""
    keys = list(recording.columns)
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", *(f"{c}.{o} [{recording.units[c, o]}]" for c, o in keys)])
        for row in range(0, len(recording.time), every):
            writer.writerow([repr(float(recording.time[row])), *(repr(float(recording[key][row])) for key in keys)])
