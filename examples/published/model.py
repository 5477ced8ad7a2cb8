"""Runs the model through `cargo fmu simulate` and reads what it writes. The names of outputs stand here and nowhere else."""

import csv
import json
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).resolve().parent

# What the cases read, by the name that the model gives it, without its unit.
OUTPUTS = {
    "time": "time",
    "distance": "sliding_distance",
    "temperature": "contact_temperature",
    "disc": "strip.mean_temperature",
    "highest": "contact_temperature_max",
    "radius": "effective_radius",
    "critical": "critical_speed",
    "heat": "dissipated_energy",
    "strip_heat": "heat_received_strip",
    "mean_pressure": "pressure_mean",
    "fraction": "contact_fraction",
    "airborne": "wear_mass_airborne",
    "x": "profile.x",
    "pressure": "profile.pressure",
    "local_temperature": "profile.temperature",
    "worn_punch": "profile.wear_punch",
    "worn_strip": "profile.wear_strip",
}

Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class Run:
    outputs: Columns
    profiles: list[Columns]  # one for every time asked for, in their order

    def __getitem__(self, name: str) -> np.ndarray:
        return self.outputs[OUTPUTS[name]]

    def profile(self, index: int, name: str) -> np.ndarray:
        return self.profiles[index][OUTPUTS[name]]


class Model:
    """The command, and changes that are made to every scene: by them a test shows that a comparison can fail."""

    def __init__(self, command: Path, changes: tuple[str, ...] = ()) -> None:
        self.command = command
        self.changes = changes

    def simulate(
        self,
        scene: str,
        inputs: str | None = None,
        settings: tuple[str, ...] = (),
        at: tuple[float, ...] = (),
        step: float | None = None,
    ) -> Run:
        """The run of examples/published/`scene` (or of a shipped scene) with `inputs`, text in CSV or a file beside it."""
        own = FOLDER / scene / "scene.toml"
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out.csv"
            arguments = ["simulate", str(own) if own.is_file() else scene, "-o", str(out), "--json"]
            if inputs is not None:
                file = FOLDER / scene / inputs
                if "\n" in inputs:
                    file = Path(folder) / "in.csv"
                    file.write_text(inputs, encoding="utf-8")
                arguments += ["--inputs", str(file)]
            for setting in (*settings, *self.changes):
                arguments += ["--set", setting]
            if step is not None:
                arguments += ["--step", repr(step)]
            if at:
                arguments += ["--at", ",".join(repr(time) for time in at)]
            self.call(arguments)
            profiles = out.with_suffix(".profiles.csv")
            return Run(columns(out), parts(columns(profiles)) if profiles.is_file() else [])

    def call(self, arguments: list[str]) -> dict[str, object]:
        environment = os.environ | {"CARGO_MANIFEST_DIR": str(FOLDER.parents[1] / "fmu-build")}
        run = subprocess.run([str(self.command), *arguments], capture_output=True, text=True, env=environment)
        if run.returncode != 0:
            raise RuntimeError(f"{' '.join(arguments)}: {run.stderr.strip()}")
        return json.loads(run.stdout)


def columns(path: Path) -> Columns:
    """Columns by their name without the unit; everything that the command writes is in SI units."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    values = np.array(rows, dtype=float)
    return {name.split(" [")[0]: values[:, index] for index, name in enumerate(header)}


def parts(profiles: Columns) -> list[Columns]:
    """The profiles of every time."""
    times = profiles[OUTPUTS["time"]]
    return [{name: values[times == time] for name, values in profiles.items()} for time in dict.fromkeys(times)]
