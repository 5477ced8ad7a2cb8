"""Results: arrays in SI units, with the units at hand."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterator, Optional, Sequence, Union

import numpy as np

from . import _native
from ._drawing import drawn
from ._errors import Error
from ._native import meant
from ._tables import Columns, Table, source, tell
from ._units import converted, split

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

PROFILES = ("pressure", "temperature", "wear_punch", "wear_strip")


@dataclass(frozen=True)
class Profiles:
    """Distributions over the contact at some times: one row for each time, one column for each station."""

    time: np.ndarray  #: s
    x: np.ndarray  #: position along the contact line, m
    pressure: np.ndarray  #: Pa
    temperature: np.ndarray  #: K
    wear_punch: np.ndarray  #: worn depth, m
    wear_strip: np.ndarray  #: worn depth, m

    def frame(self) -> "pandas.DataFrame":
        """A table of pandas with a row for every time and station."""
        import pandas

        stations = self.x.size
        units = {"pressure": "Pa", "temperature": "K", "wear_punch": "m", "wear_strip": "m"}
        columns = {"time [s]": np.repeat(self.time, stations), "profile.x [m]": np.tile(self.x, self.time.size)}
        columns.update({f"profile.{name} [{unit}]": getattr(self, name).ravel() for name, unit in units.items()})
        return pandas.DataFrame(columns)


@dataclass(frozen=True)
class Deviation:
    """Simulated less measured values of a quantity, in its SI unit."""

    name: str
    unit: str
    time: np.ndarray  #: measured times within the simulated one, s
    measured: np.ndarray
    root_mean_square: float
    largest: float  #: by magnitude, with its sign
    at: float  #: time of the largest, s
    range: float  #: largest less smallest measured value
    outside: int  #: measured points outside of the simulated time

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        shown = f"{self.name}: {self.root_mean_square:.3g}{unit} root mean square, at most {self.largest:.3g}{unit} at {self.at:g} s"
        return f"{shown}, of a range of {self.range:.3g}{unit}; {self.time.size} points"


class Simulation(Mapping):
    """A run: every input and output over the time, by name, in SI units or in the one that the name has in brackets.

    >>> from sliding_contact import Scene
    >>> result = Scene.load("disc_brake").set({"nominal.duration": "1 s"}).simulate()
    >>> result.units["contact_temperature"], result["contact_temperature"].shape == result.time.shape
    ('K', True)
    >>> round(float(result["sliding_velocity [km/h]"][0]), 2)
    13.68
    """

    def __init__(self, answer: _native.Answer) -> None:
        self._answer = answer
        self.record: dict[str, Any] = answer.record
        channels = self.record["channels"]
        #: Communication points, s.
        self.time: np.ndarray = answer.array(0)
        self._values = {channel["name"]: answer.array(1 + at) for at, channel in enumerate(channels)}
        #: SI unit of every variable; "1" of a number.
        self.units: dict[str, str] = {channel["name"]: channel["unit"] for channel in channels}
        self.scene: str = self.record["scene"]
        #: Level at which the scene ran.
        self.level: str = self.record["level"]
        #: Largest residual of the energy balance over the largest energy.
        self.energy_residual: float = self.record["energy_residual"]
        #: Time [s] and text of what the run warned of.
        self.warnings: list[tuple[float, str]] = [(own["time"], own["text"]) for own in self.record["warnings"]]
        first = 1 + len(channels)
        times, x = answer.array(first), answer.array(first + 1)
        self._profiles: Optional[Profiles] = None
        if times.size:
            pressure, temperature = (answer.array(first + at).reshape(times.size, -1) for at in (2, 3))
            worn = answer.array(first + 4).reshape(times.size, 2, -1)
            stations = x.reshape(times.size, -1)[0]
            self._profiles = Profiles(times, stations, pressure, temperature, worn[:, 0].copy(), worn[:, 1].copy())

    @property
    def profiles(self) -> Profiles:
        """Pressure, temperature and worn depths over the contact at the times `at` of the run."""
        if self._profiles is None:
            raise Error(
                f"the scene {self.scene} ran at the level {self.level}, whose pressure is uniform; profiles need the contact line, "
                'as with set({"solver.fidelity": "line"})'
            )
        return self._profiles

    def __getitem__(self, name: str) -> np.ndarray:
        plain, unit = split(name)
        if plain in ("time",):
            values = self.time
        elif plain in self._values:
            values = self._values[plain]
        else:
            raise Error(f"there is no input or output {plain!r}{meant(plain, self._values, 'units')}")
        return values if unit is None or unit == self.units.get(plain, "s") else converted(plain, unit, values)

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __str__(self) -> str:
        return str(self.record["table"]).rstrip()

    def __repr__(self) -> str:
        return f"Simulation({self.scene!r}, level {self.level}, {self.time.size} times to {self.time[-1]:g} s)"

    def __eq__(self, other: object) -> bool:
        return self is other

    __hash__ = object.__hash__

    def frame(self, *columns: str) -> "pandas.DataFrame":
        """A table of pandas: `columns`, in SI units or as `"normal_load [kN]"`, or everything in SI units.

        Its headers are those that inputs and measured records have: what `frame().to_csv(path)` writes, with or without the index, can be read
        again as either.
        """
        import pandas

        names = columns or tuple(self)
        if "time" not in (split(name)[0] for name in names):
            names = ("time", *names)
        return pandas.DataFrame({name if split(name)[1] else f"{name} [{self.units.get(name, 's')}]": self[name] for name in names})

    def compare(self, measured: Table, *, columns: Optional[Columns] = None, strict: bool = False) -> dict[str, Deviation]:
        """Deviation from a measured record, by name: columns as those of inputs, of any inputs and outputs.

        `columns` and `strict`: as of `Scene.simulate`.

        >>> from sliding_contact import Scene
        >>> result = Scene.load("disc_brake").set({"nominal.duration": "1 s"}).simulate()
        >>> deviation = result.compare({"time [s]": [0.0, 0.5], "contact_temperature [degC]": [20, 30]})
        >>> deviation["contact_temperature"].range
        10.0
        """
        found = _native.ask({"analysis": "compare", "measured": source(measured, "measured", columns, strict)}, self._answer).record
        tell(found["notes"])
        deviations = {}
        for own in found["deviations"]:
            points = np.array(own.pop("points")).reshape(-1, 2)
            deviations[own["name"]] = Deviation(time=points[:, 0], measured=points[:, 1], **own)
        return deviations

    def plot(
        self,
        path: Union[str, "os.PathLike[str]", None] = None,
        *,
        measured: Optional[Table] = None,
        columns: Optional[Columns] = None,
        strict: bool = False,
    ) -> "Figure":
        """Draws inputs, outputs, energy balance and profiles over the contact, beside a measured record; needs matplotlib.

        Returns the figure, and writes it to `path` (svg, pdf or png) where one is given.
        """
        content = _native.ask({"analysis": "figure", "measured": source(measured, "measured", columns, strict)}, self._answer).record
        tell(content["notes"])
        return drawn(lambda figure: figure.figure_of(content["content"]), path)


class StepFailed(Error):
    """A step that failed; `result` holds the run before it, or is None where the exception came from another process: a run stays in its own."""

    def __init__(self, reason: str, result: Optional[Simulation] = None) -> None:
        super().__init__(reason)
        self.result = result

    def __reduce__(self) -> Any:
        # The run belongs to its process.
        return StepFailed, (str(self),)


StepFailed.__module__ = "sliding_contact"


@dataclass(frozen=True)
class Stroke:
    """One direction of a steady state, at its cells."""

    direction: str  #: forward or backward
    velocity: float  #: m/s
    friction: float  #: coefficient, 1
    pressure: np.ndarray  #: Pa; with heat the mean over the half-stroke
    approach: float  #: m
    tilt: float  #: rad


class SteadyState:
    """A steady state under nominal load and sliding: `record` holds all of it in SI units."""

    def __init__(self, record: dict[str, Any]) -> None:
        self._table: str = record.pop("table")
        self.record = record
        self.scene: str = record["scene"]
        #: Kind of the state in words.
        self.kind: str = record["kind"]
        #: Pa
        self.mean_pressure: float = record["pressure_mean"]
        #: Positions of the cells, m.
        self.x = np.array(record["x"])
        self.strokes: list[Stroke] = [_stroke(own) for own in record["strokes"]]
        #: Worn shape of the punch, m.
        self.shape = np.array(record["shape"])
        #: Worn depth of the strip, m.
        self.groove = np.array(record["groove"])
        #: m/s
        self.punch_wear_rate: float = record["punch_wear_rate"]
        #: With heat; `None` where nothing is heated, there is none, or without heat. `refused` says why there is none.
        self.heat: Optional[dict[str, Any]] = None
        self.refused: Optional[str] = None
        heat = record["heat"]
        if heat is not None:
            self.refused = heat.get("refused")
            self.heat = None if self.refused else {name: _arrays(value) for name, value in heat.items()}

    def __str__(self) -> str:
        return self._table.rstrip()

    def __repr__(self) -> str:
        return f"SteadyState({self.scene!r}, {self.kind}, {self.x.size} cells)"

    def plot(self, path: Union[str, "os.PathLike[str]", None] = None) -> "Figure":
        """Draws pressure and worn shape, and with heat the temperatures; needs matplotlib."""
        return drawn(lambda figure: figure.steady(self), path)


class Cycles:
    """A scene over its cycles: one entry for every jump, in SI units."""

    def __init__(self, record: dict[str, Any]) -> None:
        self._table: str = record.pop("table")
        self.record = record
        self.scene: str = record["scene"]
        jumps = record["jumps"]

        def of(name: str) -> np.ndarray:
            return np.array([np.nan if jump[name] is None else jump[name] for jump in jumps], dtype=float)

        self.cycles = of("cycles")
        #: Estimated error of every jump.
        self.estimate = of("estimate")
        #: Largest mean pressure of the forward half-stroke, Pa.
        self.pressure_max = of("pressure_max")
        #: m
        self.wear_depth_punch = of("wear_depth_punch")
        #: m
        self.wear_depth_strip = of("wear_depth_strip")
        #: K; not a number without heat
        self.contact_temperature = of("contact_temperature")
        #: Number of cycles that were computed.
        self.computed = int(jumps[-1]["cycles_computed"]) if jumps else 0
        #: Positions of the cells, m.
        self.x = np.array(record["x"])
        #: Worn depth of the punch at the end, m.
        self.wear_profile_punch = np.array(record["wear_profile_punch"])

    def __str__(self) -> str:
        return self._table.rstrip()

    def __repr__(self) -> str:
        return f"Cycles({self.scene!r}, {self.cycles[-1]:g} cycles from {self.computed} computed ones)"

    def plot(self, path: Union[str, "os.PathLike[str]", None] = None) -> "Figure":
        """Draws pressure, wear and temperature over the cycles; needs matplotlib."""
        return drawn(lambda figure: figure.cycles(self), path)


class Plan:
    """What `solver.fidelity = auto` takes for a scene, and why: `record` holds the comparison, effects and groups."""

    def __init__(self, record: dict[str, Any]) -> None:
        self._table: str = record.pop("table")
        self.record = record
        self.level: str = record["level"]
        self.cells: int = record["cells"]
        #: Error of the lumped level; `None` on a contact line, whose error is measured during the run.
        self.estimated_error: Optional[float] = record["estimated_error"]
        self.reason: str = record["reason"]

    @property
    def settings(self) -> dict[str, Any]:
        """The level for `Scene.set`."""
        return _settings(self.level, self.cells)

    def __str__(self) -> str:
        return self._table.rstrip()

    def __repr__(self) -> str:
        return f"Plan({self.record['description']}: {self.reason})"


class LevelComparison:
    """Every level on given inputs, and the cheapest that meets the tolerance: `record` holds errors and costs."""

    def __init__(self, record: dict[str, Any]) -> None:
        self._table: str = record.pop("table")
        self.record = record
        self.tolerance: float = record["tolerance"]
        cheapest = record["cheapest"] or {"fidelity": None, "cells": 0, "estimated_error": np.nan}
        #: `None` where none meets the tolerance, or the comparison was interrupted.
        self.level: Optional[str] = cheapest["fidelity"]
        #: Why there is none.
        self.unmet: Optional[str] = record["unmet"]
        self.cells: int = cheapest["cells"]
        self.estimated_error: float = cheapest["estimated_error"]

    @property
    def settings(self) -> dict[str, Any]:
        """The level with its tolerance for `Scene.set`."""
        if self.level is None:
            raise Error(self.unmet or "the comparison was interrupted before it named a level")
        return {**_settings(self.level, self.cells), "solver.tolerance": self.tolerance}

    def frame(self) -> "pandas.DataFrame":
        """A table of pandas with a row for every level."""
        import pandas

        return pandas.DataFrame(self.record["levels"])

    def __str__(self) -> str:
        return self._table.rstrip()

    def __repr__(self) -> str:
        return f"LevelComparison(level {self.level}, {self.cells} cells, estimated error {self.estimated_error:.1e})"


def _settings(level: str, cells: int) -> dict[str, Any]:
    return {"solver.fidelity": level, "solver.cells": cells if level == "line" else 0}


def _stroke(own: dict[str, Any]) -> Stroke:
    names = ("direction", "velocity", "friction", "approach", "tilt")
    return Stroke(pressure=np.array(own["pressure"]), **{name: own[name] for name in names})


def _arrays(value: Any) -> Any:
    """Lists of numbers as arrays, at any depth."""
    if isinstance(value, dict):
        return {name: _arrays(own) for name, own in value.items()}
    if isinstance(value, list):
        if value and all(isinstance(own, (int, float)) for own in value):
            return np.array(value, dtype=float)
        return [_arrays(own) for own in value]
    return value
