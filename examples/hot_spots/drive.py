"""A ring of steel on a turning ring of glass ceramic, below and above the speed from which hot spots grow: maps of the
pressure over time, growth of every wave beside theory, and what is left when the rings have come apart in places.

Run by `cargo fmu run hot_spots`, which builds the FMU and the Python environment; by hand:

    python drive.py --fmu SlidingContact.hot_spots.fmu --output results
"""

import argparse
import json
import sys
from pathlib import Path

import report
import ring

SPEEDS = (0.6, 2.0)  # over the critical speed


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of the rings")
    parser.add_argument("--output", type=Path, required=True, help="folder for CSV and plots")
    parser.add_argument("--duration", type=float, default=200.0, help="sliding time in seconds (default 200)")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    return parser.parse_args()


def main():
    options = arguments()
    # What the FMU logs is printed by fmpy, and no result.
    results, sys.stdout = sys.stdout, sys.stderr
    options.output.mkdir(parents=True, exist_ok=True)
    with ring.Unpacked(options.fmu) as unpacked:
        rings = ring.Rings.of(unpacked)
        critical = ring.critical_speed(unpacked)
        level = unpacked.level()
        runs = [ring.slide(unpacked, factor * critical, options.duration) for factor in SPEEDS]
    summary = {f"{factor:g} V_cr": report.figures(run, rings, critical) for factor, run in zip(SPEEDS, runs, strict=True)}

    # Imported late: matplotlib takes long to load.
    import plots

    paths = [report.write_csv(options.output / f"hot_spots_{index}.csv", run) for index, run in enumerate(runs)]
    paths += [
        plots.maps(runs, critical, level, options.output / "pressure.svg"),
        plots.growth(runs, rings, critical, level, options.output / "growth.svg"),
        plots.ends(runs, critical, level, options.output / "hot_spots.svg"),
    ]
    if options.json:
        print(json.dumps({**summary, "files": [str(path) for path in paths]}, indent=2), file=results)
    else:
        print(report.table(summary), file=results)
        print(f"  Written to {options.output}: {', '.join(path.name for path in paths)}", file=results)


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
