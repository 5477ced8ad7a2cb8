"""Parameters of a scene from records of tests, with confidence intervals, through the model.

    python fit.py --output results
"""

import argparse
import csv
import json
import sys
import warnings
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

from sliding_contact import Interrupted, Scene, fit  # noqa: E402  (the backend is chosen first)
from sliding_contact._commands import Progress, kind, said  # noqa: E402  (messages in the words of the command line)

HERE = Path(__file__).resolve().parent


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--scene", default="pin_on_disk", help="a shipped scene or a scene file of the tests")
    parser.add_argument("--output", type=Path, required=True, help="folder for picture and result")
    parser.add_argument("--records", type=Path, nargs="+", default=[HERE / "records" / "pin_on_disk.csv"], help="end values or histories of tests")
    parser.add_argument("--column", action="append", default=[], metavar="HEADER=VARIABLE", help="what a column is")
    parser.add_argument("--strict", action="store_true", help="refuse columns that are no known quantity")
    parser.add_argument("--parameters", nargs="+", default=[fit.COEFFICIENT, fit.PRESSURE_EXPONENT], help="names of variables")
    parser.add_argument("--set", nargs="+", default=[], help="KEY=VALUE of the scene")
    parser.add_argument("--confidence", type=float, default=0.95)
    parser.add_argument("--draw", type=int, default=0, help="scenes of a design that has the joint distribution of the parameters")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    options = parser.parse_args()
    if options.draw < 0:
        parser.error(f"--draw {options.draw} must be 0 or more")
    return options


def write_design(path, scene, drawn):
    """A design for `cargo fmu batch`, a row for every draw."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([f"{name} [{scene.unit(name)}]" for name in drawn])
        writer.writerows([repr(float(value)) for value in row] for row in zip(*drawn.values()))


def main():
    options = arguments()
    # Each once, without the line of the package that raised it.
    warnings.simplefilter("once")
    warnings.showwarning = lambda message, category, *_: print(f"{kind(category)}: {said(message)}", file=sys.stderr)
    picture, result = options.output / "fit.svg", options.output / "fit.json"
    scene = Scene.load(options.scene).set(dict(own.split("=", 1) for own in options.set))
    columns = dict(own.rsplit("=", 1) for own in options.column)
    records = [str(own) for own in options.records]
    with Progress() as progress:
        found = scene.fit(records, options.parameters, options.confidence, columns=columns, strict=options.strict, progress=progress)
    options.output.mkdir(parents=True, exist_ok=True)
    found.plot(picture)
    files = [picture, result]
    if options.draw:
        files.append(options.output / "draws.csv")
        write_design(files[-1], scene, found.draw(options.draw))
    record = {**found.record(), "files": [str(file) for file in files]}
    result.write_text(json.dumps(record, indent=2) + "\n")
    print(json.dumps(record, indent=2) if options.json else f"{found}\n  Written: {', '.join(record['files'])}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt as stopped:
        values = stopped.result.items() if isinstance(stopped, Interrupted) else ()
        sets = " ".join(f"--set {name}={value:.6g}" for name, value in values)
        print(f"{stopped}; as {sets}" if sets else "interrupted; nothing is written", file=sys.stderr)
        sys.exit(130)
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {said(error)}")
