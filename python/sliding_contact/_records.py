"""Records of tests: end values at constant load and speed, and histories."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Union

import numpy as np

from . import _native
from ._errors import Error
from ._numbers import numbers
from ._tables import Columns, Table, source, tell

VOLUME = "wear_volume_punch"


@dataclass(frozen=True)
class Records:
    """End values of tests at constant load and speed, one entry each; a value that is not a number is a gap."""

    load: np.ndarray  # N
    speed: np.ndarray  # m/s
    distance: np.ndarray  # m
    volume: Optional[np.ndarray] = None  # m3, lost by the punch
    values: Mapping[str, np.ndarray] = field(default_factory=dict)  # other outputs at the end, by name, in SI units

    def __post_init__(self) -> None:
        named = {name: getattr(self, name) for name in ("load", "speed", "distance", "volume")}
        if named["volume"] is None:
            del named["volume"]
        for name, given in {**named, **self.values}.items():
            own = numbers(f"records: {name}", given).ravel()
            if name in named:
                object.__setattr__(self, name, own)
            if own.size != self.load.size:
                raise Error(f"records: {name} has {own.size} values, load {self.load.size}")
            missing = np.isnan(own) if name not in ("load", "speed", "distance") else np.zeros(own.size, bool)
            for index in np.flatnonzero(~((np.isfinite(own) & ((own > 0.0) | (name not in named))) | missing))[:1]:
                raise Error(f"records: {name}[{index}] = {own[index]:g} must be a finite number" + (" above 0" if name in named else ""))
        object.__setattr__(self, "values", {name: numbers(name, own).ravel() for name, own in self.values.items()})

    @classmethod
    def read(cls, path: Union[str, "os.PathLike[str]"]) -> "Records":
        """From a file with a column for each of them, its unit behind the name: `load [N]` or `load_N`."""
        if not isinstance(path, (str, os.PathLike)):
            raise Error(f"records: {type(path).__name__} is no file; accepted are a CSV file and `fit.Records`")
        # The command refuses with the same reader what is wrong in a file before it builds anything.
        return cls._of(_native.ask({"analysis": "records", "records": source(path, "records")}).record)

    @classmethod
    def _of(cls, found: Mapping[str, Any]) -> "Records":
        values = {name: np.array(own, dtype=float) for name, own in found["values"].items()}
        load, speed, distance = (np.array(found[name], dtype=float) for name in ("load", "speed", "distance"))
        return cls(load, speed, distance, values.pop(VOLUME, None), values)

    def tests(self) -> "list[Test]":
        """The same as tests."""
        worn = {} if self.volume is None else {VOLUME: self.volume}
        tests = []
        for at in range(self.load.size):
            end = self.distance[at] / self.speed[at]
            inputs = {"time [s]": [0.0, end], "sliding_velocity [m/s]": self.speed[at], "normal_load [N]": self.load[at]}
            own = {name: (np.array([end]), values[at : at + 1]) for name, values in {**worn, **self.values}.items() if not np.isnan(values[at])}
            tests.append(Test(inputs, own, f"test {at + 1}", None, (float(self.load[at]), float(self.speed[at]))))
        return tests


@dataclass(frozen=True)
class Test:
    """Inputs over time, and what was measured: times [s] and values in the SI unit, by the name of the output."""

    __test__ = False  # of pytest

    inputs: Table
    measured: Mapping[str, "tuple[np.ndarray, np.ndarray]"]
    name: str = "test"
    columns: Optional[Columns] = None  # of the inputs, as of `Scene.simulate`
    constant: "Optional[tuple[float, float]]" = None  # load and speed; such tests share their runs


def tests_of(records: Any, columns: Optional[Columns] = None, strict: bool = False) -> "list[Test]":
    """Tests of a file, a table or `Records`, or of several: end values where there is a column for the distance, else a history."""
    if isinstance(records, Test):
        return [records]
    if isinstance(records, Records):
        return records.tests()
    if isinstance(records, (list, tuple)):
        return [test for own in records for test in tests_of(own, columns, strict)]
    if not (isinstance(records, (str, os.PathLike)) or hasattr(records, "keys")):
        raise Error(f"records: {type(records).__name__} is no file, no table and no `fit.Records`")
    answer = _native.ask({"analysis": "records", "records": source(records, "records", columns, strict)})
    found = answer.record
    tell(found["notes"], 4)
    if "load" in found:
        return Records._of(found).tests()
    measured = {name: (answer.array(2 * at), answer.array(2 * at + 1)) for at, name in enumerate(found["outputs"])}
    return [Test(records, measured, found["name"], columns)]


def is_exponent(name: str) -> bool:
    """Whether a parameter is fitted as it is, and not by its logarithm."""
    return "exponent" in name
