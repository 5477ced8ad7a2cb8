"""Drives a lumped brake written with pythonfmu, and the FMU of this project, through the same cycle in fmpy.

Reads the scene as JSON from standard input - `fmu` is the path of this project's FMU, `folder` a place to work in - and
writes one JSON object per run (see fmu-build/lab/src/chart/peers.rs). Both FMUs are unpacked before; the time is that of
fmpy's `simulate_fmu`: instantiation, initialisation, stepping and recording.
"""

import contextlib
import json
import sys
import time
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from pythonfmu.builder import FmuBuilder

OUTPUTS = ["wear_depth", "contact_temperature", "friction_force"]
TURNS = 7
LUMPED = 2  # item of solver.fidelity


def build(scene, folder):
    """Packs the slave with the scene's parameters among its resources."""
    folder.mkdir(parents=True, exist_ok=True)
    parameters = folder / "scene.json"
    parameters.write_text(json.dumps(scene["parameters"]))
    script = Path(__file__).with_name("lumped_brake_slave.py")
    return FmuBuilder.build_FMU(script, dest=folder, project_files=[parameters])


class Driven:
    """An FMU ready to be driven."""

    def __init__(self, path):
        self.description = read_model_description(str(path))
        self.folder = extract(str(path))

    def run(self, signals, step, stop, samples, start_values):
        """Processor time of a run, and the samples."""
        begin = time.process_time()
        # fmpy prints which inputs it was not given; the results alone belong on the standard output.
        with contextlib.redirect_stdout(sys.stderr):
            result = simulate_fmu(
                self.folder,
                model_description=self.description,
                fmi_type="CoSimulation",
                stop_time=stop,
                output_interval=step,
                input=signals,
                output=OUTPUTS,
                start_values=start_values,
            )
        seconds = time.process_time() - begin
        indices = [int(round(sample / step)) for sample in samples]
        rows = [[float(result[name][index]) for name in OUTPUTS] + [None] for index in indices]
        return seconds, rows


def main():
    scene = json.load(sys.stdin)
    stop = scene["samples"][-1]
    names = ("time", "sliding_velocity", "normal_load")
    # Whole seconds are the rows of the cycle; between them the inputs are linear.
    rows = [tuple(row) for row in scene["inputs"] if abs(row[0] - round(row[0])) < 1e-9]
    signals = np.array(rows, dtype=[(name, np.float64) for name in names])
    peers = (
        ("pythonfmu's lumped FMU in fmpy", Driven(build(scene, Path(scene["folder"]))), {}),
        ("this FMU (lumped) in fmpy", Driven(scene["fmu"]), {"solver.fidelity": LUMPED}),
    )
    for step in (1.0, 0.5, 0.2, 0.1, 0.05):
        # In turns, so that a machine that changes its pace does so for both.
        turns = [[driven.run(signals, step, stop, scene["samples"], values) for _, driven, values in peers]
                 for _ in range(TURNS)]
        for (family, _, _), runs in zip(peers, zip(*turns)):
            run = {
                "family": family,
                "setting": f"communication step {step:g} s, inputs held",
                "initialisation": 0.0,
                "seconds": min(seconds for seconds, _ in runs),
                "steps": round(stop / step),
                "samples": runs[0][1],
            }
            print(json.dumps(run), flush=True)


if __name__ == "__main__":
    main()
