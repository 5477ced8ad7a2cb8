"""Fits the wear law's coefficient and exponents to pin-on-disk records, through the model.

The law of the pin is

    dw/dt = k p0 v0 ((p - p_th)/p0)^b (|v|/v0)^a,   p0 = 1 MPa, v0 = 1 m/s,

p_th the scene's `punch.wear_threshold`, which is not fitted. What is measured is the volume lost over a distance at constant
load and speed. Every prediction is a run of the scene, so whatever it holds (geometry, temperature, a fade of the wear) is
part of the fit. Errors of wear measurements are relative, so logarithms are fitted: residual = ln(measured / predicted).
"""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Mapping, Sequence, Union

import numpy as np

from . import _native
from ._drawing import drawn
from ._errors import Error, SceneWarning
from ._numbers import numbers

try:
    from scipy import optimize, stats
except ImportError as missing:
    raise ImportError("fits need scipy: pip install scipy") from missing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: A `sliding_contact.Scene`; its module uses this one.
Scene = Any

COEFFICIENT = "punch.wear_coefficient"
EXPONENTS = {"pressure": "punch.wear_pressure_exponent", "velocity": "punch.wear_velocity_exponent"}
VOLUME = "wear_volume_punch"
CELLS = 33  # of a line whose scene leaves them to the program
COARSE = 9  # cells beside the lumped level
STEPS = 50  # of each run: load and speed are constant, so the FMU's own step control does the rest


@dataclass(frozen=True)
class Records:
    """Tests, one entry each."""

    load: np.ndarray  # N
    speed: np.ndarray  # m/s
    distance: np.ndarray  # m
    volume: np.ndarray  # m3, lost by the pin

    def __post_init__(self) -> None:
        for name in ("load", "speed", "distance", "volume"):
            own = numbers(f"records: {name}", getattr(self, name)).ravel()
            object.__setattr__(self, name, own)
            if own.size != self.load.size:
                raise Error(f"records: {name} has {own.size} values, load {self.load.size}")
            for index in np.flatnonzero(~(np.isfinite(own) & (own > 0.0)))[:1]:
                raise Error(f"records: {name}[{index}] = {own[index]:g} must be a finite number above 0")

    @classmethod
    def read(cls, path: Union[str, "os.PathLike[str]"]) -> "Records":
        """From a CSV file with a column for each of them, its unit behind the name: `load [N]` or `load_N`; lines that start with # are
        notes.
        """
        if not isinstance(path, (str, os.PathLike)):
            raise Error(f"records: {type(path).__name__} is no file; accepted are a CSV file and `wear_law.Records`")
        # The command refuses with the same reader what is wrong in a file before it builds anything.
        found = _native.ask({"analysis": "records", "path": os.fspath(path)}).record
        return cls(*(np.array(found[name]) for name in ("load", "speed", "distance", "volume")))


class Model:
    """A scene as a function from the law's parameters to worn volumes, at the scene's own level and tolerance.

    With `solver.fidelity = auto` the level is chosen once, so that volumes are smooth in the parameters.
    """

    def __init__(self, scene: Scene, records: Records) -> None:
        auto = scene["solver.fidelity"] == "auto"
        self.scene = scene.copy().set(scene.plan().settings) if auto else scene
        self.records = records
        self.runs = 0
        #: Highest `contact_temperature_max` of the last prediction, K.
        self.highest = np.nan

    @property
    def tolerance(self) -> float:
        """Relative tolerance of the runs, the size of their numerical noise."""
        return float(self.scene["solver.tolerance"]) or self.scene.tolerance

    @property
    def cells(self) -> int:
        """Cells of the contact line; 0 at the lumped level."""
        return int(self.scene["solver.cells"]) or CELLS if self.scene["solver.fidelity"] != "lumped" else 0

    def __str__(self) -> str:
        cells = f", {self.cells} cells" if self.cells else ""
        return f"level {self.scene['solver.fidelity']}{cells}, tolerance {self.tolerance:g}"

    def companion(self) -> "Model":
        """The same on half the cells, or of the lumped level the line with `COARSE` cells."""
        cells = (self.cells + 1) // 2 if self.cells else COARSE
        return Model(self.scene.copy().set({"solver.fidelity": "line", "solver.cells": cells}), self.records)

    def at(self, load: np.ndarray, speed: float, distance: float) -> "Model":
        """The same under other loads, at one speed over one distance."""
        return Model(self.scene, Records(load, np.full_like(load, speed), np.full_like(load, distance), np.ones_like(load)))

    def volumes(self, parameters: Mapping[str, float]) -> np.ndarray:
        """Predicted volume of every test [m3] for these parameters by name."""
        records = self.records
        volumes = np.empty(records.load.size)
        scene = self.scene.copy().set(dict(parameters))
        self.highest = -np.inf
        # Tests that differ only by their distance are points of one run.
        conditions = np.column_stack([records.speed, records.load])
        for speed, load in np.unique(conditions, axis=0):
            own = np.flatnonzero(np.all(conditions == (speed, load), axis=1))
            distances = np.unique(records.distance[own])
            times = distances / speed
            inputs = {"time [s]": [0.0, *times], "sliding_velocity [m/s]": speed, "normal_load [N]": load}
            run = scene.simulate(inputs, step=times[-1] / STEPS)
            self.runs += 1
            self.highest = max(self.highest, float(run["contact_temperature_max"].max()))
            # Rows of the inputs are communication points.
            at = run[VOLUME][np.searchsorted(run.time, times)]
            volumes[own] = at[np.searchsorted(distances, records.distance[own])]
        return volumes


@dataclass(frozen=True)
class Fit:
    """Result of a fit."""

    names: tuple[str, ...]  # of the parameters
    values: np.ndarray
    intervals: np.ndarray  # rows low, high
    confidence: float
    covariance: np.ndarray  # of (ln coefficient, exponents)
    scatter: float  # standard deviation of ln(measured / predicted)
    degrees_of_freedom: int
    runs: int  # of the scene
    model: Model
    companion: str  # what half the cells give

    def parameters(self) -> dict[str, float]:
        """Fitted values by name, for `Scene.set`."""
        return dict(zip(self.names, (float(value) for value in self.values)))

    def __str__(self) -> str:
        lines = [f"{self.model.records.load.size} tests, {self.runs} runs, scatter {100 * self.scatter:.1f} %"]
        for name, value, low, high in zip(self.names, self.values, *self.intervals):
            unit = self.model.scene.unit(name)
            unit = "" if unit == "1" else f" {unit}"
            percent = f"{100 * self.confidence:g} %"
            lines.append(f"  {name:32} {value:.4g}{unit}, {percent} interval {low:.4g} to {high:.4g}")
        lines += [f"  {self.model}", f"  {self.companion}"]
        return "\n".join(lines)

    def plot(self, path: Union[str, "os.PathLike[str]", None] = None) -> "Figure":
        """Draws the tests beside the law, and how well the records determine its parameters; needs matplotlib."""
        from . import _fit_figure

        return drawn(lambda _: _fit_figure.figure_of(self), path)


def fit(model: Model, exponents: Sequence[str] = ("pressure",), confidence: float = 0.95) -> Fit:
    """Least squares of the logarithms, and confidence intervals from Student's t.

    Derivatives are central differences over a step of the cube root of the tolerance, where the noise of the runs and the curvature
    of the model cost the same.

    Raises `Error` where the records cannot tell the parameters apart: an exponent needs tests at more than one load
    (or speed), and there must be more tests than parameters.
    """
    records = model.records
    unknown = [name for name in exponents if name not in EXPONENTS]
    if unknown or len(set(exponents)) < len(exponents):
        raise Error(f"exponents = {list(exponents)}: accepted are {', '.join(EXPONENTS)}, each once")
    if not (isinstance(confidence, (int, float)) and 0.0 < confidence < 1.0):
        raise Error(f"confidence = {confidence!r} must be above 0 and below 1")
    names = (COEFFICIENT, *(EXPONENTS[name] for name in exponents))
    if records.volume.size <= len(names):
        raise Error(f"{records.volume.size} tests do not determine {len(names)} parameters and their scatter")
    for name, varied in (("pressure", records.load), ("velocity", records.speed)):
        if name in exponents and np.unique(varied).size < 2:
            raise Error(f"the {name} exponent needs tests at more than one {'load' if name == 'pressure' else 'speed'}")
    measured = np.log(records.volume)

    # The volume is proportional to the coefficient to good approximation: one run tells where to begin.
    begin = 1e-14
    begin *= np.exp(np.mean(measured - np.log(model.volumes({COEFFICIENT: begin, **{name: 1.0 for name in names[1:]}}))))

    def parameters(point: np.ndarray) -> dict[str, float]:
        return {COEFFICIENT: np.exp(point[0]), **dict(zip(names[1:], point[1:]))}

    def residuals(point: np.ndarray) -> np.ndarray:
        difference: np.ndarray = measured - np.log(model.volumes(parameters(point)))
        return difference

    def jacobian(point: np.ndarray) -> np.ndarray:
        steps = np.cbrt(model.tolerance) * np.eye(point.size)
        return np.column_stack([(residuals(point + step) - residuals(point - step)) / (2.0 * step.sum()) for step in steps])

    start = np.array([np.log(begin), *([1.0] * len(exponents))])
    # Relative to the sum of squares: where less is gained the parameters stand within a hundredth of their intervals.
    solved = optimize.least_squares(residuals, start, jacobian, method="lm", x_scale="jac", ftol=1e-4, xtol=1e-6)
    if not solved.success:
        raise Error(f"the fit did not converge: {solved.message}")
    freedom = measured.size - len(names)
    scatter = np.sqrt(2.0 * solved.cost / freedom)
    covariance = scatter**2 * np.linalg.inv(solved.jac.T @ solved.jac)
    half = stats.t.ppf(0.5 + 0.5 * confidence, freedom) * np.sqrt(np.diag(covariance))
    residuals(solved.x)
    companion = _compare(model, measured, solved, names, half, parameters(solved.x))
    low, high, values = solved.x - half, solved.x + half, solved.x.copy()
    for array in (low, high, values):
        array[0] = np.exp(array[0])
    return Fit(names, values, np.array([low, high]), confidence, covariance, float(scatter), freedom, model.runs, model, companion)


def _compare(
    model: Model, measured: np.ndarray, solved: Any, names: Sequence[str], half: np.ndarray, found: Mapping[str, float]
) -> str:
    """What the companion's volumes and temperatures change: one line, and a warning where it is more than the intervals tell."""
    coarse = model.companion()
    moved = np.linalg.lstsq(solved.jac, -(measured - np.log(coarse.volumes(found))), rcond=None)[0]
    moved -= np.linalg.lstsq(solved.jac, -solved.fun, rcond=None)[0]
    model.runs += coarse.runs
    changes = [f"{names[0]} by {100 * np.expm1(moved[0]):+.1g} %", *(f"{name} by {own:+.1g}" for name, own in zip(names[1:], moved[1:]))]
    rise = model.highest - float(model.scene["ambient_temperature"])
    highest = _native.ask(
        {"analysis": "convergence", "value": model.highest, "coarser": coarse.highest, "cells": model.cells, "coarser_cells": coarse.cells,
         "offset": 273.15, "scale": rise}
    ).record  # fmt: skip
    text = f"{coarse.cells} cells change {', '.join(changes)}; highest contact temperature, degC: {highest}"
    if np.any(np.abs(moved) > half):
        warnings.warn(f"the fit depends on the level more than its intervals tell: {model}; {text}", SceneWarning, stacklevel=4)
    return text
