"""Many scenes along the same inputs, on all cores."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, Any, Callable, Iterator, Optional, Sequence

import numpy as np

from ._errors import Error, Interrupted
from ._native import meant
from ._tables import tell
from ._units import converted, literal, quantity, split, with_unit
from .results import Simulation

if TYPE_CHECKING:
    import pandas

PEAK = ".peak"
LIFE = "life"
_PAUSE = 0.1  # s, between two looks at the runs


class Batch(Mapping):
    """A row for every scene, columns by name in SI units or in the one that the name has in brackets.

    Outputs are those at the end, `OUTPUT.peak` is the largest value. `life`: how often the inputs are passed until a body is worn to its
    `wear_limit`, by the wear of one pass; infinite where there is no limit or no wear. Rows of scenes that failed are not numbers, and
    `reasons` has their texts by row.
    """

    def __init__(self, columns: dict[str, np.ndarray], units: dict[str, str], scenes: dict[int, Any], origin: Any) -> None:
        self._columns = columns
        # For a batch that goes on: results or reasons by row, and what they are of.
        self._scenes, self._origin = scenes, origin
        #: SI unit of every column; "1" of a number.
        self.units = units
        #: Why scenes failed, by row.
        self.reasons = {at: own for at, (_, own) in enumerate(sorted(scenes.items())) if isinstance(own, str)}
        #: Row of the design of every row.
        self.scenes = np.array(sorted(scenes), dtype=int)

    def __getitem__(self, name: str) -> np.ndarray:
        plain, unit = split(name)
        if plain not in self._columns:
            raise Error(f"there is no column {plain!r}{meant(plain, self._columns, 'units')}")
        values = self._columns[plain]
        own = plain[: -len(PEAK)] if plain.endswith(PEAK) else plain
        return values if unit is None or unit == self.units[plain] else converted(own, unit, values)

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def percentiles(self, name: str, percent: Sequence[float] = (5.0, 50.0, 95.0)) -> np.ndarray:
        """Percentiles of a column over the scenes that did not fail: how far the doubt of a design goes in a result."""
        values = self[name]
        # By rank, as a life may be infinite.
        return np.asarray(np.percentile(values[~np.isnan(values)], list(percent), method="closest_observation"))

    def frame(self) -> "pandas.DataFrame":
        """A table of pandas with all columns in SI units."""
        import pandas

        return pandas.DataFrame({f"{name} [{self.units[name]}]": values for name, values in self._columns.items()}, index=self.scenes)

    def __repr__(self) -> str:
        return f"Batch({self.scenes.size} scenes, {len(self.reasons)} failed)"


class _Ended(Exception):
    pass


def batch(scene: Any, given: Any, inputs: Optional[dict[str, Any]], step: Any, before: Optional[Batch], progress: Optional[Callable[[float], object]]) -> Batch:
    """`Scene.batch`, with inputs as the native library takes them."""
    design = _checked(scene, given)
    count = len(next(iter(design.values())))
    settings = [[f"{name}={literal(name, values[row])}" for name, values in design.items()] for row in range(count)]
    origin = scene._request("simulate", inputs=inputs, step=step), settings
    if before is not None and (not isinstance(before, Batch) or before._origin != origin):
        raise Error("done: its scenes are others; `batch` goes on with the same scene, design, inputs and step")
    done: dict[int, Any] = {} if before is None else dict(before._scenes)
    stop = threading.Event()

    def look(_: float) -> None:
        if stop.is_set():
            raise _Ended

    def run(row: int) -> Simulation:
        look(0.0)
        result: Simulation = scene._run(inputs, step, assignments=settings[row], progress=look)
        if result.record["failure"]:
            raise Error(result.record["failure"])
        return result

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        waiting = {pool.submit(run, row): row for row in range(count) if row not in done}
        try:
            while waiting:
                for future in wait(waiting, _PAUSE, FIRST_COMPLETED).done:
                    failure = future.exception()
                    if failure is not None and not isinstance(failure, Error):
                        raise failure
                    done[waiting.pop(future)] = str(failure) if failure else _summary(future.result())
                if progress is not None:
                    progress(len(done) / count)
        except BaseException as error:
            stop.set()
            if not isinstance(error, KeyboardInterrupt):
                raise
            raise Interrupted("interrupted", _gathered(scene, design, done, origin), f"{len(done)} of {count} scenes; as `done` it goes on") from None
    if all(isinstance(own, str) for own in done.values()):
        raise Error(f"every scene failed, the first for: {done[0]}")
    return _gathered(scene, design, done, origin)


def _checked(scene: Any, given: Any) -> dict[str, list[Any]]:
    """Columns of a design by the names of the variables, with units in their cells."""
    if not hasattr(given, "keys"):
        raise Error(f"design: {type(given).__name__} is no table; accepted are a fit, dictionaries of lists and tables of pandas")
    design: dict[str, list[Any]] = {}
    for header in given.keys():
        name, unit = split(header)
        scene.unit(name)
        cells = list(given[header]) if np.ndim(given[header]) == 1 else []
        design[name] = [cell if unit is None else with_unit(header, cell, unit) for cell in cells]
    for name, cells in design.items():
        if len(cells) != len(next(iter(design.values()))) or not cells:
            raise Error(f"design: {name} has {len(cells)} rows; every column must be a list of the same length, at least 1")
    if not design:
        raise Error("design: there is no column")
    return design


def _summary(result: Simulation) -> tuple[list[str], dict[str, str], dict[str, float]]:
    """Notes, units and values of a run: the last and the largest ones."""
    last = {name: float(values[-1]) for name, values in result.items()}
    return result.record["notes"], result.units, {**last, **{name + PEAK: float(values.max()) for name, values in result.items()}}


def _gathered(scene: Any, design: Mapping[str, list[Any]], done: dict[int, Any], origin: Any) -> Batch:
    rows = sorted(done)
    good = {row: own for row, own in done.items() if not isinstance(own, str)}
    notes, units, names = next(iter(good.values()), ([], {}, {}))
    tell(notes)
    columns = {name: np.array([good[row][2][name] if row in good else np.nan for row in rows]) for name in names}
    for name, cells in design.items():
        own = [cells[row] for row in rows]
        columns[name] = np.array([quantity(name, cell) if isinstance(cell, str) and isinstance(scene[name], float) else cell for cell in own])
    life = np.full(len(rows), np.inf)
    for body in ("punch", "strip"):
        limit, wear = (columns.get(name, np.nan) for name in (f"{body}.wear_limit", f"wear_depth_{body}"))
        limit = scene[f"{body}.wear_limit"] if np.all(np.isnan(limit)) else limit
        with np.errstate(divide="ignore", invalid="ignore"):
            life = np.minimum(life, np.where((limit > 0.0) | np.isnan(wear), limit / wear, np.inf))
    named = {**units, **{name + PEAK: unit for name, unit in units.items()}, **{name: scene.unit(name) for name in design}, LIFE: "1"}
    return Batch({**columns, LIFE: life}, named, done, origin)
