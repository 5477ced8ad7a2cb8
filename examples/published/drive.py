"""Published solutions beside the model's: table, figures.

Run by `cargo fmu run published`; by hand:

    python drive.py --command target/release/fmu-build --output results
"""

import argparse
import json
import sys
from pathlib import Path

from cases import CASES
from model import Model
from results import Result


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--command", type=Path, required=True, help="the program of cargo fmu")
    parser.add_argument("--output", type=Path, required=True, help="folder for the figures")
    parser.add_argument("--case", choices=CASES, action="append", help="only this case; may be repeated")
    parser.add_argument("--format", choices=("svg", "png", "pdf"), default="svg", help="of the figures")
    parser.add_argument("--json", action="store_true", help="print the comparisons as JSON")
    return parser.parse_args()


def rows(name: str, result: Result) -> list[dict[str, object]]:
    return [
        {
            "case": name,
            "quantity": item.quantity,
            "unit": item.unit,
            "published": item.published,
            "model": item.model,
            "deviation": item.deviation,
            "band": item.band,
            "holds": bool(item.holds),
        }
        for item in result.comparisons
    ]


def table(found: list[dict[str, object]]) -> str:
    units = {row["quantity"]: "" if row["unit"] == "1" else f", {row['unit']}" for row in found}
    names = {quantity: quantity + unit for quantity, unit in units.items()}
    width = max(map(len, names.values()))
    lines = [f"  {'case':21} {'quantity':{width}} {'published':>10} {'model':>10} {'deviation':>10}  band"]
    for row in found:
        low, high = row["band"]
        mark = "" if row["holds"] else "  OUTSIDE"
        lines.append(
            f"  {row['case']:21} {names[row['quantity']]:{width}} {row['published']:>10.5g} {row['model']:>10.5g} "
            f"{100.0 * row['deviation']:>+9.2f}%  {100.0 * low:+g} to {100.0 * high:+g} %{mark}"
        )
    return "\n".join(lines)


def main() -> None:
    options = arguments()
    options.output.mkdir(parents=True, exist_ok=True)
    model = Model(options.command.resolve())
    # Imported late: matplotlib takes long to load.
    import plots

    found = []
    for name in options.case or CASES:
        print(f"{name} ...", file=sys.stderr)
        result = CASES[name].compute(model)
        found += rows(name, result)
        plots.draw(result, options.output / f"{name}.{options.format}")
    if options.json:
        print(json.dumps(found, indent=2))
    else:
        print(table(found))
        print(f"  Figures written to {options.output}")
    if not all(row["holds"] for row in found):
        raise ValueError("a deviation is outside of its band")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"error: {error}")
