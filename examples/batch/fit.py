"""Wear coefficient and exponent of a pin from pin-on-disk records, with confidence intervals, through the FMU.

    python fit.py --fmu SlidingContact.pin_on_disk.fmu --host libfmu_host.so --output results
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

import host
import wear_law

HERE = Path(__file__).resolve().parent


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of a pin on a disk")
    parser.add_argument("--host", type=Path, required=True, help="the host library, libfmu_host.so")
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
    records = wear_law.Records.read(options.records)
    options.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="sliding-contact-") as scratch:
        with host.Fmu(host.unpack(options.fmu, Path(scratch) / "fmu"), options.host) as fmu:
            model = wear_law.Model(fmu, records)
            found = wear_law.fit(model, tuple(options.exponents), options.confidence)
            units = {name: fmu.unit(name) for name in found.names}
            # Imported late: matplotlib takes longer to load than the fit to run.
            import fit_chart

            picture = options.output / "wear_law.png"
            fit_chart.save(picture, model, found)
    rows = {
        name: {"value": value, "low": low, "high": high, "unit": units[name]}
        for name, value, low, high in zip(found.names, found.values, *found.intervals)
    }
    if options.json:
        details = {"confidence": found.confidence, "scatter": found.scatter, "tests": len(records.load)}
        print(json.dumps({"parameters": rows, **details, "fmu_runs": found.runs, "files": [str(picture)]}, indent=2))
        return
    print(f"{len(records.load)} tests, {found.runs} runs of the FMU, scatter {100 * found.scatter:.1f} %")
    for name, row in rows.items():
        unit = "" if row["unit"] == "1" else f" {row['unit']}"
        print(f"  {name:32} {row['value']:.4g}{unit}, {100 * found.confidence:g} % interval {row['low']:.4g} to {row['high']:.4g}")
    print(f"  Written: {picture}")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
