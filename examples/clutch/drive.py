"""A clutch between engine and vehicle: engagement with stick, three masters, a hill, judder, the thermoelastic limit.

Run by `cargo fmu run clutch`, which builds the FMU and the Python environment; by hand:

    python drive.py --fmu SlidingContact.clutch.fmu --output results
"""

import argparse
import json
import sys
from pathlib import Path

import cases
import masters
import numpy as np
import report
from contact import Unpacked

IMPLICIT_RATIO = 50.0  # step of the implicit master over the explicit limit


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of a clutch")
    parser.add_argument("--output", type=Path, required=True, help="folder for CSV and plots")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    return parser.parse_args()


def main():
    options = arguments()
    # What the FMU logs is printed by fmpy, and no result.
    results, sys.stdout = sys.stdout, sys.stderr
    options.output.mkdir(parents=True, exist_ok=True)
    summary = {}
    with Unpacked(options.fmu) as clutch:
        mean_radius = clutch.start("contact.mean_radius")
        cases.check_capacity(clutch)
        bristle = cases.engage(clutch, 1e-3)
        summary["contact"] = {"level": clutch.level()}
        summary["engagement, bristle, explicit"] = report.engagement(bristle, mean_radius)

        predicted = cases.predicted_limit(clutch)
        observed = cases.observed_limit(clutch, predicted)
        summary["explicit limit, regularised friction"] = {
            "predicted_us": 1e6 * predicted,
            "observed_us": 1e6 * observed,
            "observed_over_predicted": observed / predicted,
        }
        below = cases.engage(clutch, 0.9 * predicted, cases.REGULARISED, duration=1.2)
        above = cases.engage(clutch, 2.0 * predicted, cases.REGULARISED, duration=1.2)
        step = IMPLICIT_RATIO * predicted
        implicit = cases.engage(clutch, step, cases.REGULARISED, implicit=True)
        hot = cases.engage(clutch, step, cases.REGULARISED | cases.HOT, implicit=True)
        summary["regularised, explicit at 0.9 of the limit"] = report.engagement(below, mean_radius)
        summary["regularised, explicit at 2 times the limit"] = report.engagement(above, mean_radius)
        for name, run in (("implicit at 50 times the limit", implicit), ("implicit, from 250 degC", hot)):
            summary[f"regularised, {name}"] = report.engagement(run, mean_radius) | report.implicit(run)

        held, travel = cases.hill(clutch)
        summary["hill"] = {
            "grade": cases.HILL_GRADE,
            "seconds": float(held["time"][-1]),
            "step_ms": 1e3 * held.step,
            "drift_mm": float(1e3 * np.abs(travel).max()),
            "drift_in_the_last_half_mm": float(1e3 * np.ptp(travel[len(travel) // 2 :])),
            "steps_per_second": held.steps_per_second,
        }
        juddering, slope = cases.judder(clutch, clutch.start("contact.static_friction_ratio"))
        smooth, level = cases.judder(clutch, 1.0)
        driveline = cases.Driveline()
        summary["judder"] = {
            "frequency_Hz": float(driveline.frequency),
            "growth_rate_predicted_per_s": driveline.growth_rate(slope),
            "growth_rate_observed_per_s": cases.observed_growth_rate(juddering),
            "torque_swing_N_m": float(np.ptp(juddering["torque"][len(juddering.table) // 2 :])),
            "growth_rate_predicted_without_stribeck_per_s": driveline.growth_rate(level),
            "growth_rate_observed_without_stribeck_per_s": cases.observed_growth_rate(smooth),
        }
        carbon = cases.across_critical_speed(clutch)
        speed = carbon["slip"] * mean_radius
        summary["thermoelastic limit, carbon on carbon"] = {
            "critical_speed_m_per_s": float(carbon["critical_speed"][-1]),
            "crossed_at_s": float(carbon["time"][np.argmax(speed > carbon["critical_speed"])]),
            "highest_sliding_over_critical_speed": float((speed / carbon["critical_speed"]).max()),
        }

    # Imported late: matplotlib takes long to load.
    import plots

    paths = [
        report.write_csv(options.output / "engagement.csv", bristle),
        report.write_csv(options.output / "judder.csv", juddering),
        plots.engagement(bristle, summary["contact"]["level"], options.output / "engagement.svg"),
        plots.masters(
            {
                f"explicit, {2.0 * predicted * 1e6:.0f} us, regularised": above,
                f"explicit, {0.9 * predicted * 1e6:.0f} us, regularised": below,
                f"explicit, {bristle.step * 1e3:g} ms, bristle": bristle,
                f"implicit, {step * 1e3:.2f} ms, regularised": implicit,
            },
            options.output / "masters.svg",
        ),
        plots.hill(held, travel, options.output / "hill.svg"),
        plots.judder(juddering, smooth, options.output / "judder.svg"),
        plots.critical_speed(bristle, carbon, mean_radius, options.output / "critical_speed.svg"),
    ]
    if options.json:
        print(json.dumps({**summary, "files": [str(path) for path in paths]}, indent=2), file=results)
    else:
        print(report.table(summary), file=results)
        print(f"  Written to {options.output}: {', '.join(path.name for path in paths)}", file=results)


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError, masters.DidNotConverge) as error:
        sys.exit(f"error: {error}")
