"""Fits parameters of a scene to measured records: end values of tests and histories of wear, friction force and temperature.

Weighted least squares by `scipy.optimize.least_squares` over the scene's own runs, at its level and tolerance. What the intervals assume:

- Errors are normal, and those of a quantity have one standard deviation in all tests: of end values of wear it is relative (logarithms are
  fitted), of all others absolute. It is given, or estimated from the residuals; of a quantity with too few values for that it is 5 % of the largest.
- The model is linear in the parameters over the size of the intervals: exponents as they are, all others by their logarithms.
- Residuals of a history that follow each other in time are correlated: a history counts as n (1 - r)/(1 + r) independent values, r the correlation of
  neighbouring residuals. So a constant error of the model makes an interval wider. It does not move its middle to the truth.
"""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from . import _native
from ._drawing import drawn
from ._errors import Error, Interrupted, SceneWarning
from ._numbers import number
from ._records import VOLUME as VOLUME
from ._records import Records as Records
from ._records import Test as Test
from ._records import is_exponent, tests_of
from ._tables import source
from .results import StepFailed

try:
    from scipy import optimize, stats
except ImportError as missing:
    raise ImportError("fits need scipy: pip install scipy") from missing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: A `sliding_contact.Scene`; its module uses this one.
Scene = Any

COEFFICIENT = "punch.wear_coefficient"
PRESSURE_EXPONENT = "punch.wear_pressure_exponent"
VELOCITY_EXPONENT = "punch.wear_velocity_exponent"
CELLS = 33  # of a line whose scene leaves them to the program
COARSE = 9  # cells beside the lumped level
STEPS = 50  # of a run at constant load and speed; the model's own step control does the rest

LARGEST_STEP = 0.1  # of a difference, in an exponent or a logarithm
SCALE = 0.05  # standard deviation that residuals have at first, over the largest measured value; of temperatures over the rise
FAR = 10.0  # first step at most, in an exponent or a logarithm: the whole step of Gauss and Newton, as worn volumes are nearly powers
FEW = 4.0  # values beyond what parameters take up, at least, for a standard deviation from residuals
NEAR = 0.25  # steps of a difference: at nearer points the derivatives are the same, to a quarter of what the step itself leaves out
ALIKE = 0.02  # part of a parameter's effect that others do not have, at least: differences are not more accurate
WIDEST = 1.5  # half of an interval, in an exponent or a logarithm: beyond it the records say nothing
WIDE = 10.0  # from there on the size of an interval tells nothing
ROUNDS = 4  # of the estimate of the standard deviations
SHORTEST = 8  # values of a history whose residuals may be found to be correlated
CORRELATED = 0.98  # highest correlation of neighbouring residuals that is counted


class Model:
    """A scene as a function from parameters to everything that was measured, at the scene's own level and tolerance.

    With `solver.fidelity = auto` the level is chosen once, so that results are smooth in the parameters.
    """

    def __init__(self, scene: Scene, records: Any) -> None:
        auto = scene["solver.fidelity"] == "auto"
        self.scene = scene.copy().set(scene.plan().settings) if auto else scene
        self.tests = tests_of(records)
        self.runs = 0
        #: SI units of the outputs.
        self.units: Mapping[str, str] = {}
        #: Highest `contact_temperature_max` of the last prediction, K.
        self.highest = np.nan
        #: What its runs warned of.
        self.warnings: list[str] = []
        #: What was measured: test, name, times and values; of end values of wear in logarithms.
        self.series = [
            _Series(at, name, *values, test.constant is not None and name.startswith("wear_"))
            for at, test in enumerate(self.tests)
            for name, values in test.measured.items()
            if values[0].size
        ]
        if not self.series:
            raise Error("records: there is no measured value of an output, as wear_depth [um], friction_force [N] or contact_temperature [degC]")
        #: Values of all series in one row.
        self.measured = np.concatenate([own.values for own in self.series])

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
        return Model(self.scene.copy().set({"solver.fidelity": "line", "solver.cells": cells}), self.tests)

    def predict(self, parameters: Mapping[str, float]) -> np.ndarray:
        """What the scene gives with these parameters for every measured value [SI units]."""
        scene = self.scene.copy().set(dict(parameters))
        self.highest, self.warnings = -np.inf, []
        predicted: list[np.ndarray] = [np.empty(0)] * len(self.series)
        # Tests at the same load and speed are points of one run.
        groups: dict[Any, list[int]] = {}
        for at, test in enumerate(self.tests):
            groups.setdefault(test.constant or at, []).append(at)
        for members in groups.values():
            own = [at for at, series in enumerate(self.series) if series.test in members]
            first = self.tests[members[0]]
            if first.constant is None:
                result = scene._run(source(first.inputs, "inputs", first.columns))
            else:
                times = np.unique(np.concatenate([self.series[at].times for at in own]))
                load, speed = first.constant
                inputs = {"time [s]": [0.0, *times], "sliding_velocity [m/s]": speed, "normal_load [N]": load}
                result = scene._run(source(inputs, "inputs"), step=times[-1] / STEPS)
            if result.record["failure"]:
                raise StepFailed(result.record["failure"], result)
            self.runs += 1
            self.warnings += [f"{first.name}, at {time:g} s: {text}" for time, text in result.warnings]
            self.units = result.units
            self.highest = max(self.highest, float(result["contact_temperature_max"].max()))
            for at in own:
                predicted[at] = np.interp(self.series[at].times, result.time, result[self.series[at].name])
        return np.concatenate(predicted)

    def slices(self) -> list[slice]:
        """Where the values of every series stand in a prediction."""
        ends = np.cumsum([own.times.size for own in self.series])
        return [slice(end - own.times.size, end) for end, own in zip(ends, self.series)]


@dataclass(frozen=True)
class _Series:
    test: int
    name: str
    times: np.ndarray
    values: np.ndarray
    relative: bool

    def residuals(self, predicted: np.ndarray) -> np.ndarray:
        """Measured less predicted values, or their ratio's logarithm."""
        apart: np.ndarray = np.log(self.values / predicted) if self.relative else self.values - predicted
        return apart


@dataclass(frozen=True)
class Scatter:
    """Standard deviation of what the errors of a quantity are, and how they follow each other."""

    name: str
    relative: bool  # of the logarithm
    deviation: float  # in the SI unit, or relative
    values: int
    estimated: bool  # from the residuals; else given or taken
    independent: float  # as many of them count

    def text(self, unit: str) -> str:
        size = f"{100 * self.deviation:.2g} %" if self.relative else f"{self.deviation:.3g}" + (f" {unit}" if unit != "1" else "")
        counted = f", correlated: they count as {self.independent:.0f}" if self.independent < self.values else ""
        return f"scatter of {self.name} {size}{'' if self.estimated else ', not estimated'}, {self.values} values{counted}"


@dataclass(frozen=True)
class Fit:
    """Result of a fit."""

    names: tuple[str, ...]  # of the parameters that are determined
    values: np.ndarray
    intervals: np.ndarray  # rows low, high
    confidence: float
    covariance: np.ndarray  # of exponents and of the logarithms of all others
    scatters: tuple[Scatter, ...]
    degrees_of_freedom: float
    undetermined: dict[str, str]  # parameters that keep the scene's value, and why
    runs: int  # of the scene
    model: Model
    companion: str  # what half the cells give

    @property
    def scatter(self) -> float:
        """Standard deviation of the first quantity: relative of end values of wear."""
        return self.scatters[0].deviation

    def parameters(self) -> dict[str, float]:
        """Fitted values by name, for `Scene.set`."""
        return dict(zip(self.names, (float(value) for value in self.values)))

    def draw(self, count: int, seed: int = 0) -> dict[str, np.ndarray]:
        """Values of the parameters by name, drawn from their joint distribution: Student's t of exponents and of the logarithms of all others.

        What a scene gives with them shows how far the doubt of the fit goes: percentiles of a wear depth, a life or a temperature.
        """
        middle = np.zeros(len(self.names))
        points = stats.multivariate_t(middle, self.covariance, df=self.degrees_of_freedom, seed=seed).rvs(count).reshape(count, -1)
        own = zip(self.names, self.values, points.T)
        return {name: value + offset if is_exponent(name) else value * np.exp(offset) for name, value, offset in own}

    def record(self) -> dict[str, Any]:
        """All of it as JSON: with `covariance` of `scales`, a joint distribution of the parameters."""
        unit = self.model.scene.unit
        rows = {
            name: {"value": float(value), "low": float(low), "high": float(high), "unit": unit(name)}
            for name, value, low, high in zip(self.names, self.values, *self.intervals)
        }
        scatters = {own.name: {"relative": own.relative, "deviation": own.deviation, "values": own.values, "estimated": own.estimated, "independent": own.independent} for own in self.scatters}
        return {
            "parameters": rows,
            "scales": {name: "linear" if is_exponent(name) else "logarithm" for name in self.names},
            "covariance": self.covariance.tolist(),
            "undetermined": self.undetermined,
            "confidence": self.confidence,
            "degrees_of_freedom": self.degrees_of_freedom,
            "scatter": scatters,
            "tests": len(self.model.tests),
            "runs": self.runs,
        }

    def __str__(self) -> str:
        unit = self.model.scene.unit
        count = len(self.model.tests)
        lines = [f"{count} test{'s' * (count > 1)}, {self.runs} runs"]
        for name, value, low, high in zip(self.names, self.values, *self.intervals):
            own = "" if unit(name) == "1" else f" {unit(name)}"
            lines.append(f"  {name:32} {value:.4g}{own}, {100 * self.confidence:g} % interval {low:.4g} to {high:.4g}")
        lines += [f"  {name:32} not determined: {reason}" for name, reason in self.undetermined.items()]
        lines += [f"  {own.text(self.model.units[own.name])}" for own in self.scatters]
        return "\n".join([*lines, f"  {self.model}", f"  {self.companion}"])

    def plot(self, path: Union[str, "os.PathLike[str]", None] = None) -> "Figure":
        """Draws what was measured beside the fitted scene, and how well the records determine its parameters; needs matplotlib."""
        from . import _fit_figure

        return drawn(lambda _: _fit_figure.figure_of(self), path)


def fit(
    model: Model,
    parameters: Sequence[str] = (COEFFICIENT, PRESSURE_EXPONENT),
    confidence: float = 0.95,
    scatter: Optional[Mapping[str, float]] = None,
    progress: Optional[Callable[[str], object]] = None,
    companion: bool = True,
) -> Fit:
    """Least squares, each residual over its standard deviation, and confidence intervals from Student's t.

    Derivatives are central differences over a step of the cube root of the tolerance, at most `LARGEST_STEP`, where the noise of the runs and the
    curvature of the model cost about the same. A parameter whose effect the others have too keeps the scene's value and is named, and so is one
    whose interval would be wider than a factor of exp(2 `WIDEST`). `scatter`: known standard deviations by output, in its SI unit, of end values of
    wear relative. `progress` is called with a line before every iteration; `companion`: whether half
    of the cells are compared.

    Raises `Error` where there are not more values than parameters, or no parameter is determined, and `Interrupted` at Ctrl-C.
    """
    problem = _Problem(model, _checked(model, parameters, confidence), scatter or {}, progress)
    try:
        return _found(problem, confidence, companion)
    except KeyboardInterrupt:
        best = problem.parameters(problem.reached)
        told = ", ".join(f"{name} = {value:.4g}" for name, value in best.items())
        raise Interrupted(f"the fit was interrupted after {model.runs} runs; so far {told}: set these and fit again to go on", best) from None


def _found(problem: "_Problem", confidence: float, companion: bool) -> Fit:
    model = problem.model
    undetermined = problem.undetermined()
    while problem.names:
        solved = problem.solve()
        _, singular, directions = np.linalg.svd(solved.jac, full_matrices=False)
        if singular[-1] <= np.finfo(float).eps * solved.jac.size * singular[0]:
            # The values ran to where the records do not depend on this parameter any more, or not beside the others.
            name = problem.names[int(np.argmax(np.abs(directions[-1])))]
            undetermined[name] = "at the best values it does not change the records"
            problem.drop([name])
            continue
        covariance = np.linalg.inv(solved.jac.T @ solved.jac)
        freedom = max(sum(own.independent for own in problem.scatters) - len(problem.names), 1.0)
        half = stats.t.ppf(0.5 + 0.5 * confidence, freedom) * np.sqrt(np.diag(covariance))
        widest = int(np.argmax(half))
        if half[widest] <= WIDEST:
            break
        name = problem.names[widest]
        size = f"+-{half[widest]:.3g}" if is_exponent(name) else f"a factor of {np.exp(half[widest]):.3g}" if half[widest] < WIDE else "without bounds"
        undetermined[name] = f"its {100 * confidence:g} % interval would be {size}"
        problem.drop([name])
    if not problem.names:
        raise Error("the records determine none of the parameters: " + "; ".join(f"{name}: {reason}" for name, reason in undetermined.items()))
    for name in sorted(problem.at_end):
        warnings.warn(f"{name} is at an end of the range that the scene accepts, so the fit and its intervals stop there", SceneWarning, stacklevel=4)
    values = problem.parameters(solved.x)
    low, high = problem.parameters(solved.x - half), problem.parameters(solved.x + half)
    model.predict(values)
    for text in model.warnings:
        warnings.warn(text, SceneWarning, stacklevel=4)
    text = _compare(problem, solved, half, values) if companion else "not compared with half of the cells"
    return Fit(
        tuple(values), np.array(list(values.values())), np.array([list(low.values()), list(high.values())]), confidence, covariance,
        tuple(problem.scatters), float(freedom), undetermined, model.runs, model, text,
    )  # fmt: skip


def _checked(model: Model, parameters: Sequence[str], confidence: float) -> list[str]:
    if not isinstance(parameters, (str, list, tuple)):
        raise Error(f"parameters = {parameters!r}: accepted are the name of a variable and lists of them")
    names = [parameters] if isinstance(parameters, str) else list(parameters)
    if not names or len(set(names)) < len(names):
        raise Error(f"parameters = {names}: at least one, and each once")
    if not (isinstance(confidence, (int, float)) and 0.0 < confidence < 1.0):
        raise Error(f"confidence = {confidence!r} must be above 0 and below 1")
    for name in names:
        value = model.scene[name]
        if np.ndim(value) or isinstance(value, (str, bool)):
            raise Error(f"parameters: {name} is no single number; of a table one element is fitted, as {name}[1]")
        if model.scene._known(name)["causality"] == "input":
            raise Error(f"parameters: {name} is an input, which the records give")
        if not value > 0.0 and not is_exponent(name):
            raise Error(f"parameters: {name} is {value:g} in the scene, and its logarithm is fitted; set a value above 0 from which the fit begins")
    if model.measured.size <= len(names):
        raise Error(f"{model.measured.size} values do not determine {len(names)} parameters and their scatter")
    return names


class _Problem:
    """Residuals of a model in the offsets of exponents and of the logarithms of other parameters from the scene's values."""

    def __init__(self, model: Model, names: list[str], given: Mapping[str, float], progress: Optional[Callable[[str], object]]) -> None:
        self.model, self.names, self.progress = model, names, progress
        self.point, self.told = np.zeros(len(names)), 0
        #: The last point that an iteration accepted.
        self.reached = self.point
        #: Parameters within a step of the end of their range.
        self.at_end: set[str] = set()
        self.step = min(float(np.cbrt(model.tolerance)), LARGEST_STEP)
        #: Points at which derivatives were taken.
        self.bases: list[np.ndarray] = []
        self.known = {tuple(self.point): model.predict(self.parameters(self.point))}
        # Quantities that share a standard deviation.
        keys = [(own.name, own.relative) for own in model.series]
        self.groups = {key: [at for at, own in enumerate(keys) if own == key] for key in keys}
        self.given = given
        for name in given:
            if name not in {own.name for own in model.series} or not number(f"scatter of {name}", given[name]) > 0.0:
                raise Error(f"scatter: {name} = {given[name]!r} must be above 0 and of a measured output: {', '.join(dict.fromkeys(own.name for own in model.series))}")
        self.deviations = {key: float(given[key[0]]) if key[0] in given else self._first(key) for key in self.groups}
        self.factors = np.ones(len(keys))  # number of values over that of independent ones, of every series
        self.scatters: list[Scatter] = []

    def _first(self, key: tuple[str, bool]) -> float:
        return SCALE if key[1] else max(SCALE * self._largest(key), np.finfo(float).tiny)

    def _least(self, key: tuple[str, bool]) -> float:
        """What the runs themselves scatter: smaller deviations cannot be told."""
        return 0.1 * self.model.tolerance * (1.0 if key[1] else max(self._largest(key), np.finfo(float).tiny))

    def parameters(self, point: np.ndarray) -> dict[str, float]:
        start = {name: float(self.model.scene[name]) for name in self.names}
        return {name: own + at if is_exponent(name) else own * np.exp(at) for (name, own), at in zip(start.items(), point)}

    def predicted(self, point: np.ndarray) -> np.ndarray:
        key = tuple(point)
        if key not in self.known:
            self.known[key] = self.model.predict(self.parameters(point))
        return self.known[key]

    def raw(self, predicted: np.ndarray) -> list[np.ndarray]:
        """Residuals of every series."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return [own.residuals(predicted[at]) for own, at in zip(self.model.series, self.model.slices())]

    def residuals(self, point: np.ndarray) -> np.ndarray:
        return self.weighted(self.predicted(point))

    def weighted(self, predicted: np.ndarray) -> np.ndarray:
        """Each residual over its standard deviation, those of a correlated series with less weight."""
        raw = self.raw(predicted)
        scale = np.empty(len(raw))
        for key, members in self.groups.items():
            scale[members] = self.deviations[key] * np.sqrt(self.factors[members])
        return np.concatenate([own / by for own, by in zip(raw, scale)])

    def tried(self, point: np.ndarray) -> np.ndarray:
        """As `residuals`; infinite where the scene refuses the parameters, so that a shorter step is tried."""
        try:
            return self.residuals(point)
        except Error:
            return np.full(self.model.measured.size, np.inf)

    def jacobian(self, point: np.ndarray) -> np.ndarray:
        self.at_end, self.reached = set(), point
        if self.progress is not None and self.model.runs > self.told:
            self.told = self.model.runs
            self.progress(f"{self.model.runs} runs, sum of squares {np.sum(self.residuals(point) ** 2):.4g} of {self.model.measured.size} values")
        base = next((own for own in self.bases if np.max(np.abs(own - point)) < NEAR * self.step), point)
        if base is point:
            self.bases.append(point)
        columns = []
        for step in self.step * np.eye(point.size):
            above, below = self.tried(base + step), self.tried(base - step)
            # At a bound of the scene the difference is to one side.
            one, other = (above if np.all(np.isfinite(above)) else self.residuals(base)), (below if np.all(np.isfinite(below)) else self.residuals(base))
            sides = int(np.all(np.isfinite(above))) + int(np.all(np.isfinite(below)))
            if sides < 2:
                self.at_end.add(self.names[int(np.argmax(step))])
            columns.append((one - other) / (max(sides, 1) * self.step))
        return np.column_stack(columns)

    def undetermined(self) -> dict[str, str]:
        """Parameters whose effect at the scene's values is none, or that of others, with the reason; they are dropped."""
        start = self.residuals(self.point)
        if not np.all(np.isfinite(start)):
            names = np.repeat([own.name for own in self.model.series], [own.values.size for own in self.model.series])
            raise Error(f"the scene gives no {names[~np.isfinite(start)][0]} where some was measured, so its logarithm cannot be fitted")
        jacobian = self.jacobian(self.point)
        size = np.linalg.norm(jacobian, axis=0)
        kept: list[int] = []
        reasons = {}
        # In the order in which they are named, those before being fitted.
        for own, name in enumerate(self.names):
            shares = np.linalg.lstsq(jacobian[:, kept], jacobian[:, own], rcond=None)[0]
            rest = np.linalg.norm(jacobian[:, own] - jacobian[:, kept] @ shares)
            if rest > max(ALIKE * size[own], self._told()):
                kept.append(own)
                continue
            alike = [self.names[at] for at, share in zip(kept, shares * size[kept]) if abs(share) > 0.2 * size[own]]
            effect = f"changes the records as {' and '.join(alike)}" if size[own] > self._told() and alike else "does not change the records"
            reasons[name] = f"{effect}; {self.model.scene[name]:g} is kept"
        self.drop(list(reasons))
        return reasons

    def _told(self) -> float:
        """Change of the weighted residuals by a parameter's unit that is the noise of the runs."""
        noise = [self.model.tolerance / self.deviations[key] * (1.0 if key[1] else self._largest(key)) for key in self.groups]
        return float(np.max(noise)) * 0.1 / self.step

    def _largest(self, key: tuple[str, bool]) -> float:
        """Largest measured value, of temperatures the rise."""
        values = np.concatenate([self.model.series[at].values for at in self.groups[key]])
        ambient = float(self.model.scene["ambient_temperature"]) if self.model.units.get(key[0], "") == "K" else 0.0
        return float(np.abs(values - ambient).max())

    def drop(self, names: Iterable[str]) -> None:
        kept = [at for at, name in enumerate(self.names) if name not in names]
        if len(kept) == len(self.names):
            return
        self.names, self.point = [self.names[at] for at in kept], np.zeros(len(kept))
        self.reached = self.point
        self.known.clear()
        self.bases.clear()

    def solve(self) -> Any:
        """Least squares; then standard deviations and correlations from the residuals, and again until they stay."""
        for _ in range(ROUNDS):
            solved = optimize.least_squares(self.tried, self.point, self.jacobian, method="trf", x_scale=FAR, ftol=1e-2 / self.model.measured.size, xtol=1e-5, gtol=1e-9, max_nfev=50)
            if not solved.success:
                raise Error(f"the fit did not converge: {solved.message}")
            self.point = solved.x
            changed = self._estimate(solved)
            # A common factor of all weights moves nothing.
            if changed < 0.05 or (len(self.groups) == 1 and np.all(self.factors == self.factors[0])):
                break
        solved.fun, solved.jac = self.residuals(self.point), self.jacobian(self.point)
        return solved

    def _estimate(self, solved: Any) -> float:
        """New standard deviations, correlations and their summary; the largest relative change of a weight."""
        raw = self.raw(self.predicted(solved.x))
        leverage = np.sum(np.linalg.qr(solved.jac)[0] ** 2, axis=1)
        slices = self.model.slices()
        old = {key: self.deviations[key] * np.sqrt(self.factors[members]) for key, members in self.groups.items()}
        self.scatters, changed = [], 0.0
        for key, members in self.groups.items():
            squares = sum(float(np.sum(raw[at] ** 2)) for at in members)
            freedom = max(sum(float(np.sum(1.0 - leverage[slices[at]])) for at in members), 1.0)
            is_estimated = key[0] not in self.given and freedom >= FEW
            if is_estimated:
                self.deviations[key] = max(np.sqrt(squares / freedom), self._least(key))
            for at in members:
                self.factors[at] = _excess(raw[at])
            counted = [self.model.series[at].times.size for at in members]
            independent = sum(count / self.factors[at] for count, at in zip(counted, members))
            self.scatters.append(Scatter(*key, float(self.deviations[key]), sum(counted), is_estimated, float(independent)))
            new = self.deviations[key] * np.sqrt(self.factors[members])
            changed = max(changed, float(np.max(np.abs(new / old[key] - 1.0))))
        return changed


def _excess(residuals: np.ndarray) -> float:
    """Number of values over that of independent ones, from the correlation of neighbours; 1 where that is not significant."""
    count = residuals.size
    centred = residuals
    squares = float(np.sum(centred**2))
    if count < SHORTEST or squares == 0.0:
        return 1.0
    correlation = float(np.sum(centred[1:] * centred[:-1])) / squares
    if correlation < 2.0 / np.sqrt(count):
        return 1.0
    correlation = min(correlation, CORRELATED)
    return min((1.0 + correlation) / (1.0 - correlation), float(count))


def _shown(change: float) -> str:
    return f"{change:+.1g}" if abs(change) >= 1e-3 else "less than 0.001"


def _compare(problem: _Problem, solved: Any, half: np.ndarray, found: Mapping[str, float]) -> str:
    """What the companion's results change: one line, and a warning where it is more than the intervals tell."""
    model, coarse = problem.model, problem.model.companion()
    moved = np.linalg.lstsq(solved.jac, solved.fun - problem.weighted(coarse.predict(found)), rcond=None)[0]
    model.runs += coarse.runs
    changes = [f"{name} by {_shown(own)}" if is_exponent(name) else f"{name} by {_shown(100 * np.expm1(own))} %" for name, own in zip(problem.names, moved)]
    rise = model.highest - float(model.scene["ambient_temperature"])
    highest = _native.ask(
        {"analysis": "convergence", "value": model.highest, "coarser": coarse.highest, "cells": model.cells, "coarser_cells": coarse.cells,
         "offset": 273.15, "scale": rise}
    ).record  # fmt: skip
    text = f"{coarse.cells} cells change {', '.join(changes)}; highest contact temperature, degC: {highest}"
    if np.any(np.abs(moved) > half):
        warnings.warn(f"the fit depends on the level more than its intervals tell: {model}; {text}", SceneWarning, stacklevel=5)
    return text
