"""The direct steady state as `cargo fmu steady --json` prints it."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Direct:
    """Steady cycle of one holder, computed without time integration."""

    name: str  # translate or rotate
    parameters: dict  # of the FMU: holder and cells
    load: float  # [N]
    half_width: float  # [m]
    stroke: float  # [m]
    x: np.ndarray  # stations of the FMU's profiles [m]
    pressure: dict  # at the stations, forward (1) and backward (-1) [Pa]
    tilt: dict  # [rad]
    approach: dict  # [m]
    shape: np.ndarray  # worn depth of the punch at the stations, less its rigid motion [m]


def read(path):
    """The direct steady state in a file."""
    state = json.loads(Path(path).read_text(encoding="utf-8"))
    strokes = {1 if stroke["direction"] == "forward" else -1: stroke for stroke in state["strokes"]}
    if set(strokes) != {1, -1}:
        raise ValueError(f"{path}: {state['scene']} is not reciprocating: nominal.stroke is {state['stroke']} m")
    holder = state["holder"]
    name = "translate" if holder["constraint"] == "translate" else "rotate"
    x = np.array(state["profile_x"])
    return Direct(
        name=name,
        parameters={
            "holder.constraint": holder["constraint"],
            "holder.pivot_height": holder["pivot_height"],
            "solver.cells": len(state["x"]),
        },
        load=state["load"],
        half_width=x[-1],
        stroke=state["stroke"],
        x=x,
        pressure={sign: np.array(stroke["profile_pressure"]) for sign, stroke in strokes.items()},
        tilt={sign: stroke["tilt"] for sign, stroke in strokes.items()},
        approach={sign: stroke["approach"] for sign, stroke in strokes.items()},
        shape=without_rigid_motion(x, np.array(state["profile_shape"]), name),
    )


def without_rigid_motion(x, depth, name):
    """A worn depth less the motion that reshapes nothing: a constant, and a line where the punch can rotate."""
    rigid = np.polynomial.Polynomial.fit(x, depth, 0 if name == "translate" else 1)
    return depth - rigid(x)
