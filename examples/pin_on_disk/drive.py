"""A pin on a disk after ASTM G99, at three speeds over the same distance: wear, temperatures, heat.

Run by `cargo fmu run pin_on_disk`, which builds the FMU and the Python environment; by hand:

    python drive.py --fmu SlidingContact.pin_on_disk.fmu --output results
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "disc_brake"))

import report  # noqa: E402  (the one beside this file comes first)
import simulation  # noqa: E402

DISTANCE = 1000.0  # [m], of the standard's test
SPEEDS = (1.0, 2.0, 3.0)  # over the nominal one; the contact is thermoelastically unstable from 3.7 on
STEPS = 1000


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of a pin on a disk")
    parser.add_argument("--output", type=Path, required=True, help="folder for CSV and plots")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    return parser.parse_args()


def test(fmu, load, speed):
    """The recording of a test at constant load [N] and speed [m/s]."""
    duration = DISTANCE / speed
    signals = np.zeros(2, dtype=[("time", float), ("sliding_velocity", float), ("normal_load", float)])
    signals["time"] = 0.0, duration
    signals["sliding_velocity"], signals["normal_load"] = speed, load
    nominal = {"nominal.velocity": speed, "nominal.load": load, "nominal.duration": duration}
    return simulation.drive(fmu, signals, duration / STEPS, nominal)


def main():
    options = arguments()
    # What the FMU logs is printed by fmpy, and no result.
    results, sys.stdout = sys.stdout, sys.stderr
    options.output.mkdir(parents=True, exist_ok=True)
    description, start = simulation.describe(options.fmu)
    load, nominal = float(start["nominal.load"]), float(start["nominal.velocity"])
    runs = {f"{factor * nominal:g} m/s": test(options.fmu, load, factor * nominal) for factor in SPEEDS}
    summary = {name: report.figures(run, load) for name, run in runs.items()}

    # Imported late: matplotlib takes long to load.
    import plots

    paths = [
        report.write_csv(options.output / f"pin_on_disk_{name.split()[0]}_m_per_s.csv", run) for name, run in runs.items()
    ]
    paths.append(plots.over_the_distance(runs, options.output / "pin_on_disk.svg"))
    if options.json:
        print(json.dumps({**summary, "files": [str(path) for path in paths]}, indent=2), file=results)
    else:
        print(f"{description.modelName}: {DISTANCE:g} m under {load:g} N, level {simulation.level(description)}", file=results)
        print(report.table(summary), file=results)
        print(f"  Written to {options.output}: {', '.join(path.name for path in paths)}", file=results)


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
