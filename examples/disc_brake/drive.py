"""Drives the disc brake's FMU through a drive cycle: CSV, plots and a table of results. With `--stops` also one stop
from 100 km/h and a fade run of fifteen, at the lumped level and on the contact line.

Run by `cargo fmu run`, which builds the FMU and the Python environment; by hand:

    python drive.py --fmu SlidingContact.fmu --cycle ../data/udds.csv --output results
"""

import argparse
import json
import sys
from pathlib import Path

import report
import road_load
import simulation

MOST_STEPS = 2e6  # that are kept


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of a disc brake")
    parser.add_argument("--cycle", type=Path, required=True, help="CSV with the columns time_s, speed_m_per_s")
    parser.add_argument("--output", type=Path, required=True, help="folder for CSV and plots")
    parser.add_argument("--step", type=float, default=0.1, help="communication step in seconds (default 0.1)")
    parser.add_argument("--one-level", action="store_true", help="leave out the contact line beside the scene's level")
    parser.add_argument("--stops", action="store_true", help="then stops from 100 km/h, one and fifteen, at two levels")
    parser.add_argument("--car", action="append", default=[], metavar="NAME=VALUE", help="a property of the car, in its SI unit")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    return parser.parse_args()


def main():
    options = arguments()
    # What the FMU logs is printed by fmpy, and no result.
    results, sys.stdout = sys.stdout, sys.stderr
    time, speed = road_load.read_cycle(options.cycle)
    if not time[-1] / MOST_STEPS <= options.step <= time[-1]:
        raise ValueError(f"--step {options.step:g} s must be from {time[-1] / MOST_STEPS:g} s to the cycle's {time[-1]:g} s")
    description, start_values = simulation.describe(options.fmu)
    car = road_load.Car.of(options.car)
    drive = road_load.front_brake(time, speed, road_load.Brake.of(start_values), car)
    recording = simulation.drive(options.fmu, drive.signals(), options.step)
    summary = report.summarise(recording, drive)
    level = simulation.level(description)
    options.output.mkdir(parents=True, exist_ok=True)
    table = options.output / f"{options.cycle.stem}.csv"
    report.write_csv(table, recording, drive)
    trips = report.of_trips(recording, drive, road_load.read_trips(options.cycle))
    columns = {level: summary}
    if not options.one_level and level in ("auto", "lumped"):
        lines = simulation.drive_lines(options.fmu, drive.signals(), options.step)
        for cells, line in zip(simulation.LINE_CELLS, lines):
            columns[f"line, {cells} cells"] = report.summarise(line, drive)

    title = f"{description.modelName}: one front brake over {options.cycle.stem.upper()}, level {level}"
    # Imported late: matplotlib takes longer to load than the cycle to run.
    import plots

    paths = [table, *plots.save(options.output, recording, drive, title)]
    stopping = {}
    if options.stops:
        import stop_plots
        import stops

        one = stops.drive_both(options.fmu, 1, stops.SNAPSHOTS, car)
        fifteen = stops.drive_both(options.fmu, stops.STOPS, car=car)
        stopping = {"stop": stops.figures(one), "fade": stops.figures(fifteen)}
        paths += [
            stop_plots.one_stop(one, options.output / "stop.svg"),
            stop_plots.fade(fifteen, options.output / "fade.svg"),
        ]
    if options.json:
        levels = {heading: column.as_dictionary() for heading, column in columns.items()}
        files = [str(path) for path in paths]
        print(json.dumps({"level": level, **summary.as_dictionary(), "levels": levels, "trips": trips, **stopping, "files": files}, indent=2), file=results)
    else:
        print(title, file=results)
        print(report.table(columns), file=results)
        for text in report.comparison(columns):
            print(f"  {text}", file=results)
        if trips:
            print(report.trips_table(trips), file=results)
        if stopping:
            print(stops.table(stopping), file=results)
        print(f"  Written to {options.output}: {', '.join(path.name for path in paths)}", file=results)


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
