"""Wear coefficient and exponent of a pin from pin-on-disk records, with confidence intervals, through the model.

    python fit.py --output results
"""

import argparse
import json
import sys
import warnings
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

from sliding_contact import Scene, wear_law  # noqa: E402  (the backend is chosen first)

HERE = Path(__file__).resolve().parent


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--scene", default="pin_on_disk", help="a shipped scene or a scene file of a pin on a disk")
    parser.add_argument("--output", type=Path, required=True, help="folder for the picture")
    parser.add_argument("--records", type=Path, default=HERE / "records" / "pin_on_disk.csv", help="CSV of tests")
    parser.add_argument(
        "--exponents", nargs="*", choices=tuple(wear_law.EXPONENTS), default=["pressure"], help="which to fit; others stay 1"
    )
    parser.add_argument("--confidence", type=float, default=0.95)
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    options = parser.parse_args()
    if not 0.0 < options.confidence < 1.0:
        parser.error("--confidence must lie between 0 and 1")
    return options


def main():
    options = arguments()
    # Each once, without the line of the package that raised it.
    warnings.simplefilter("once")
    warnings.showwarning = lambda message, *_: print(f"warning: {message}", file=sys.stderr)
    picture = options.output / "wear_law.svg"
    scene = Scene.load(options.scene)
    found = scene.fit(options.records, tuple(options.exponents), options.confidence)
    options.output.mkdir(parents=True, exist_ok=True)
    found.plot(picture)
    if not options.json:
        print(f"{found}\n  Written: {picture}")
        return
    rows = {
        name: {"value": value, "low": low, "high": high, "unit": scene.unit(name)}
        for name, value, low, high in zip(found.names, found.values, *found.intervals)
    }
    details = {"confidence": found.confidence, "scatter": found.scatter, "tests": found.model.records.load.size}
    print(json.dumps({"parameters": rows, **details, "runs": found.runs, "files": [str(picture)]}, indent=2))


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
