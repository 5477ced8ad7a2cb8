"""A car with four contact FMUs for its brakes, in co-simulation: friction decides the speed, the speed is the input.

Run by `cargo fmu run vehicle_brake`, which builds the brake's FMU and the Python environment; by hand:

    python drive.py --fmu SlidingContact.disc_brake.fmu --cycle ../data/udds.csv --output results

Drives a cycle, a mountain descent with a full stop at its foot, the same stop with cold brakes, and stands on a hill.
The master is the one of master.py, on fmpy; the descent runs as an SSP package with libcosim too.
"""

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path

import libcosim
import manoeuvres
import master
import report
import simulation
import ssp
import system
import vehicle_fmu
from fmpy import read_model_description


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of a disc brake")
    parser.add_argument("--cycle", type=Path, required=True, help="CSV with the columns time_s, speed_m_per_s")
    parser.add_argument("--output", type=Path, required=True, help="folder for FMU, SSP package, CSV and plots")
    parser.add_argument("--car", action="append", default=[], metavar="NAME=VALUE", help="a parameter of the vehicle, in its SI unit")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    return parser.parse_args()


def start_values(fmu):
    return {variable.name: variable.start for variable in read_model_description(str(fmu)).modelVariables}


def drive(manoeuvre, brake, folder, extrapolate=False):
    """Runs a manoeuvre with the master on fmpy; the vehicle's FMU stays in `folder`."""
    vehicle = vehicle_fmu.pack(folder / f"Vehicle.{manoeuvre.name}.fmu", manoeuvre)
    return master.run(
        {system.VEHICLE: vehicle, **{name: brake for name in system.BRAKES}},
        system.connections(),
        system.parameters(manoeuvre, start_values(brake)),
        system.recorded(),
        manoeuvre.duration,
        manoeuvres.STEP,
        manoeuvre.name,
        extrapolate,
    )


def drive_package(manoeuvre, brake, folder):
    """Runs a manoeuvre as an SSP package with libcosim; the package stays in `folder`."""
    parameters = system.parameters(manoeuvre, start_values(brake))
    package = folder / f"vehicle_brake.{manoeuvre.name}.ssp"
    ssp.pack(package, brake, system.connections(), parameters, manoeuvre, manoeuvres.STEP)
    return libcosim.run(package, system.recorded(), manoeuvre.duration, manoeuvres.STEP)


def main():
    options = arguments()
    # What the FMU logs is printed by fmpy, and no result.
    results, sys.stdout = sys.stdout, sys.stderr
    options.output.mkdir(parents=True, exist_ok=True)
    car = {name: float(value) for name, _, value in (text.partition("=") for text in options.car)}
    drives = {
        manoeuvre.name: replace(manoeuvre, parameters={**manoeuvre.parameters, **car})
        for manoeuvre in (
            manoeuvres.cycle(options.cycle), manoeuvres.descent(), manoeuvres.cold_stop(), manoeuvres.hill()
        )
    }
    recordings = {name: drive(manoeuvre, options.fmu, options.output) for name, manoeuvre in drives.items()}
    summary = {name: report.run_figures(recording) for name, recording in recordings.items()}
    level = simulation.level(read_model_description(str(options.fmu)))
    summary["contacts"] = {"level": level}
    begins = {name: drives[name].parameters["stop_time"] for name in ("cold_stop", "descent")}
    for name, begin in begins.items():
        summary[name] |= report.stop_figures(recordings[name], begin)
    summary["hill"] |= report.hill_figures(recordings["hill"])
    cycle = options.cycle.stem
    summary[cycle] |= report.cycle_figures(recordings[cycle])
    extrapolated = drive(drives["cold_stop"], options.fmu, options.output, extrapolate=True)
    summary["cold_stop"]["coupling_error_extrapolated"] = report.coupling_error(extrapolated)
    longer = summary["descent"]["distance_m"] / summary["cold_stop"]["distance_m"]
    summary["brake fade"] = {"hot_over_cold_stopping_distance": longer}
    try:
        other = drive_package(drives["descent"], options.fmu, options.output)
        error, where = libcosim.difference(recordings["descent"], other)
        summary["libcosim"] = {
            "descent_steps_per_second": other.steps / other.seconds,
            "difference_from_fmpy_over_range": error,
            "largest_at": where or "nowhere",
        }
    except libcosim.NotInstallable as reason:
        summary["libcosim"] = {"skipped": f"libcosimpy cannot be installed here: {reason}"}

    # Imported late: matplotlib takes long to load.
    import plots

    paths = []
    for name in (cycle, "descent"):
        paths.append(options.output / f"{name}.csv")
        report.write_csv(paths[-1], recordings[name])
    title = f"Car with four contact FMUs (level {level}), "
    paths += [
        plots.along(recordings[cycle], title + cycle.upper(), options.output / f"{cycle}.svg"),
        plots.along(recordings["descent"], title + "descent at 8 % and full stop", options.output / "descent.svg"),
        plots.stops(recordings["cold_stop"], recordings["descent"], (begins["cold_stop"], begins["descent"]),
                    options.output / "stopping_distance.svg"),
        plots.hill(recordings["hill"], options.output / "hill.svg"),
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
