"""A reciprocating punch until its wear is steady: pressure of successive half-strokes, edge pressures, worn shape,
for a punch that can only translate and for one that can also rotate about a pivot, beside the direct steady states; and the
same with the heat of friction, which distorts both bodies.

Run by `cargo fmu run reciprocating_punch`, which builds the FMU and the Python environment and computes the direct
steady states; by hand:

    cargo fmu steady reciprocating_punch --cells 65 --json > translate.json
    cargo fmu steady reciprocating_punch --cells 65 --json --set holder.constraint=translate_and_rotate \
        --set holder.pivot_height="30 mm" > rotate.json
    python drive.py --fmu SlidingContact.reciprocating_punch.fmu --steady translate.json rotate.json --output results
"""

import argparse
import json
import sys
from pathlib import Path

import direct
import report
import strokes

ACCELERATION = 10  # wear_acceleration of the second run


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--fmu", type=Path, required=True, help="the FMU of the reciprocating punch")
    parser.add_argument("--steady", type=Path, nargs="+", required=True, help="direct steady states, one a holder")
    parser.add_argument("--output", type=Path, required=True, help="folder for CSV and plots")
    parser.add_argument("--cycles", type=int, default=8000, help="cycles to slide (default 8000)")
    parser.add_argument("--json", action="store_true", help="print the summary as JSON")
    return parser.parse_args()


def check(unpacked, states):
    """Refuses steady states of another scene."""
    for state in states:
        for name, own, other in (
            ("punch.width", unpacked.start("punch.width"), 2.0 * state.half_width),
            ("nominal.load", unpacked.start("nominal.load"), state.load),
            ("stroke", 2.0 * strokes.AMPLITUDE, state.stroke),
        ):
            if abs(own - other) > 1e-9 * own:
                raise ValueError(f"the direct steady state is of another scene: {name} is {other} there, {own} here")


def main():
    options = arguments()
    # What the FMU logs is printed by fmpy, and no result.
    results, sys.stdout = sys.stdout, sys.stderr
    options.output.mkdir(parents=True, exist_ok=True)
    states = {state.name: state for state in map(direct.read, options.steady)}
    histories, accelerated, hot = {}, {}, {}
    with strokes.Unpacked(options.fmu) as unpacked:
        check(unpacked, states.values())
        for name, state in states.items():
            histories[name] = strokes.slide(unpacked, state.parameters, state.load, options.cycles)
            cycles = max(options.cycles // ACCELERATION, 2)
            hot[name] = strokes.slide(
                unpacked, strokes.hot(unpacked, state.parameters), state.load, max(options.cycles // 2, 2)
            )
            accelerated[name] = strokes.slide(unpacked, state.parameters, state.load, cycles, ACCELERATION)
    summary = {name: report.figures(history, states[name]) for name, history in histories.items()}
    summary |= {f"{name}, accelerated": report.figures(run, states[name]) for name, run in accelerated.items()}

    summary |= {f"{name}, hot": report.figures(run, states[name]) for name, run in hot.items()}

    # Imported late: matplotlib takes long to load.
    import hot_plots
    import plots

    paths = [report.write_csv(options.output / f"half_strokes_{name}.csv", run) for name, run in histories.items()]
    paths += [report.write_csv(options.output / f"half_strokes_{name}_hot.csv", run) for name, run in hot.items()]
    paths += [
        plots.pressures(histories, states, options.output / "pressures.svg"),
        plots.edges(histories, options.output / "edge_pressures.svg"),
        plots.shapes(histories, states, options.output / "worn_shapes.svg"),
        plots.relaxation(histories, accelerated, states, options.output / "relaxation.svg"),
        hot_plots.half_strokes(hot, options.output / "hot_half_strokes.svg"),
        hot_plots.shapes(histories, hot, options.output / "hot_worn_shapes.svg"),
        hot_plots.steady(states, histories, hot, options.output / "hot_steady_pressures.svg"),
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
