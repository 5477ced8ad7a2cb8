"""Scenes: a contact with its bodies, holder, materials and laws, and what can be computed of it."""

from __future__ import annotations

import os
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from . import _native
from ._batch import Batch, batch
from ._errors import Error, Interrupted, SceneWarning, writing
from ._native import meant
from ._numbers import flag, number, plain
from ._records import tests_of
from ._tables import Columns, Table, source, tell
from ._units import Value, converted, count, literal, seconds, split, tables, with_unit
from .results import Cycles, LevelComparison, Plan, Simulation, SteadyState, StepFailed

if TYPE_CHECKING:
    from .fit import Fit


#: A time, in seconds or with its unit as "20 ms".
Time = Union[float, str]


def scenes() -> list[str]:
    """Names of the shipped scenes.

    >>> "disc_brake" in scenes()
    True
    """
    return list(_native.ask({"analysis": "names", "scenes": str(_native.SCENES)}).record)


def fmu(name: str) -> Path:
    """Path of the FMU (FMI 2.0 for co-simulation) of a shipped scene, for any importer.

    >>> fmu("disc_brake").name
    'disc_brake.fmu'
    """
    path = _native.FMUS / f"{name}.fmu"
    if not path.is_file():
        known = sorted(file.stem for file in _native.FMUS.glob("*.fmu"))
        raise Error(f"there is no FMU of a scene {name!r}; shipped are {', '.join(known) or 'none'}")
    return path


@dataclass(frozen=True)
class Trajectory:
    """Inputs over time, in SI units."""

    inputs: tuple[str, ...]  #: names, one for each column of values
    time: np.ndarray  #: s, increasing
    values: np.ndarray  #: one row for each time
    step: float  #: communication step, s; the inputs of a file are resolved by equal steps of this length as by those of `simulate`


class Scene:
    """A scene, loaded by the name of a shipped one or from a file, with values of its variables changed.

    >>> scene = Scene.load("disc_brake").set({"punch.width": "80 mm"}, wear_acceleration=10)
    >>> scene["punch.width"], scene.unit("punch.width"), scene["punch.width [mm]"]
    (0.08, 'm', 80.0)
    """

    def __init__(self, scene: Optional[str] = None, assignments: Iterable[str] = ()) -> None:
        self._scene = scene
        self._assignments: list[str] = []
        self._variables: dict[str, dict[str, Any]] = {}
        self._read(list(assignments))

    @classmethod
    def load(cls, scene: Union[str, "os.PathLike[str]", None] = None) -> "Scene":
        """The scene of a shipped name or of a file; without one the stock scene.

        >>> Scene.load("pin_on_disk").name
        'pin_on_disk'
        """
        if scene is not None and not isinstance(scene, (str, os.PathLike)):
            raise Error(f"{scene!r} is no scene; accepted are the path of a scene file and the names {', '.join(scenes())}")
        return cls(None if scene is None else os.fspath(scene))

    def copy(self) -> "Scene":
        """A scene of its own with the same values."""
        return Scene(self._scene, self._assignments)

    def set(
        self, values: Union[Mapping[str, Value], str, None] = None, value: Optional[Value] = None, **more: Value
    ) -> "Scene":
        """Gives variables other values, `set({name: value})` or `set(name, value)`, and returns the scene itself.

        Numbers are in the SI unit, or in the one that the name has in brackets (`"punch.width [mm]"`); texts have a unit or are the item of an enumeration. Arrays are lists. A table
        (`contact.friction_fade`, `contact.friction_table`, `punch.wear_fade`) is a dictionary of its lists and has as many points as these. What is refused changes nothing.

        >>> brake = Scene.load("disc_brake").set({"normal_load": "12 kN", "solver.fidelity": "line"})
        >>> brake["normal_load"], brake["solver.fidelity"]
        (12000.0, 'line')
        >>> brake.set({"contact.friction_table": {"speed": [0, "36 km/h", 20], "coefficient": [0.5, 0.4, 0.36]}})
        Scene('disc_brake')...
        >>> brake["contact.friction_table.speed"][:3].tolist(), brake["contact.friction_table.points"]
        ([0.0, 10.0, 20.0], 3)
        >>> brake.set({"punch.widht": 0.1})
        Traceback (most recent call last):
            ...
        sliding_contact.Error: setting punch.widht=0.1: ...did you mean punch.width?...
        """
        if isinstance(values, str) != (value is not None) or not isinstance(values, (str, Mapping, type(None))):
            raise Error("set takes a dictionary of names and values, or one name and its value")
        named: dict[str, Any] = {values: value, **more} if isinstance(values, str) else {**(values or {}), **more}
        given: dict[str, Any] = {}
        for name, own in named.items():
            columns = {f"{name}.{column}": of for column, of in own.items()} if isinstance(own, Mapping) else {name: own}
            for column, of in columns.items():
                plain, unit = split(column)
                given[plain] = of if unit is None else with_unit(column, of, unit)
        assigned = tables(given)

        def is_replaced(assignment: str) -> bool:
            name = assignment.split("=", 1)[0].strip()
            return name in assigned or name.split("[")[0] in assigned

        kept = [assignment for assignment in self._assignments if not is_replaced(assignment)]
        self._read([*kept, *(f"{name}={literal(name, own)}" for name, own in assigned.items())])
        return self

    def set_numbers(self, values: Mapping[str, float]) -> "Scene":
        """As `set`, with the numbers of `start_values`.

        >>> Scene.load("disc_brake").set_numbers({"solver.fidelity": 1})["solver.fidelity"]
        'auto'
        """
        return self.set({name: self._item(name, value) for name, value in values.items()})

    def _item(self, name: str, value: float) -> Value:
        own = self._known(name)
        items, value = own["items"], plain(name, value)
        if not items:
            kind = type(own["value"])
            return kind(value) if kind in (bool, int) else value
        if not 1 <= value <= len(items):
            raise Error(f"{name} = {value:g} is none of 1 to {len(items)}: {', '.join(items)}")
        return str(items[int(value) - 1])

    def _read(self, assignments: list[str]) -> None:
        record = _native.ask(self._request("scene", assignments)).record
        new = set(record["scene_warnings"]) - set(getattr(self, "_warned", ()))
        self._assignments, self._variables = assignments, record["variables"]
        self._warned: set[str] = set(record["scene_warnings"])
        self.name: str = record["name"]
        self.description: str = record["description"]
        #: Relative tolerance of a simulation.
        self.tolerance: float = record["tolerance"]
        for text in sorted(new):
            warnings.warn(text, SceneWarning, stacklevel=4)

    def _request(self, analysis: str, assignments: Optional[list[str]] = None, **more: Any) -> dict[str, Any]:
        own = list(self._assignments if assignments is None else assignments)
        return {"analysis": analysis, "scene": self._scene, "scenes": str(_native.SCENES), "set": own, **more}

    def __setitem__(self, name: str, value: Value) -> None:
        self.set({name: value})

    def __getitem__(self, name: str) -> Any:
        """Value of a variable, of an array all its elements: in the SI unit, or in the one that the name has in brackets.

        >>> Scene.load("clutch")["contact.friction_fade.temperature [degC]"].round(6).tolist()
        [20.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0, 400.0]
        """
        plain, unit = split(name)
        value = self._known(plain)["value"]
        return value if unit is None else converted(plain, unit, value)

    def __contains__(self, name: object) -> bool:
        return name in self._variables or f"{name}[1]" in self._variables

    def __repr__(self) -> str:
        return f"Scene({self.name!r})" + "".join(f".set({text!r})" for text in self._assignments)

    def _known(self, name: str) -> dict[str, Any]:
        if name in self._variables:
            return self._variables[name]
        array = name.split("[")[0]
        elements: list[dict[str, Any]] = []
        while f"{array}[{len(elements) + 1}]" in self._variables:
            elements.append(self._variables[f"{array}[{len(elements) + 1}]"])
        if not elements:
            raise Error(f"{name} is no variable of the scene{meant(name, (key.split('[')[0] for key in self._variables), 'variables')}")
        if name != array:
            raise Error(f"{name}: {array} has the elements 1 to {len(elements)}")
        # Elements differ by their values alone.
        return {**elements[0], "value": np.array([own["value"] for own in elements])}

    def unit(self, name: str) -> str:
        """SI unit of a variable; "1" of a number."""
        return str(self._known(name)["unit"])

    def start_values(self) -> dict[str, float]:
        """Every parameter as a number in its SI unit, an item of an enumeration as its place from 1: what an FMU of the scene starts with."""
        return {name: float(own["start"]) for name, own in self._variables.items() if own["causality"] == "parameter"}

    @property
    def variables(self) -> list[str]:
        """Names of everything that can be set."""
        return list(self._variables)

    def trajectory(self, inputs: Optional[Table] = None, *, columns: Optional[Columns] = None, strict: bool = False) -> Trajectory:
        """Inputs over time as `simulate` takes them: linear between their rows, by default nominal load and velocity.

        >>> Scene.load("pin_on_disk").trajectory().inputs
        ('normal_load', 'angular_velocity', 'sliding_velocity')
        """
        answer = _native.ask(self._request("trajectory", inputs=source(inputs, "inputs", columns, strict)))
        tell(answer.record["notes"])
        names = tuple(answer.record["inputs"])
        values = np.column_stack([answer.array(1 + at) for at in range(len(names))])
        return Trajectory(names, answer.array(0), values, float(answer.record["step"]))

    def simulate(
        self,
        inputs: Optional[Table] = None,
        *,
        measured: Optional[Table] = None,
        step: Optional[Time] = None,
        at: Union[Time, Sequence[Time]] = (),
        columns: Optional[Columns] = None,
        strict: bool = False,
        progress: Optional[Callable[[float], object]] = None,
    ) -> Simulation:
        """Simulates the scene along inputs, linear between their rows; without inputs at nominal load and velocity.

        `inputs`: columns by name with a unit, as a dictionary, a table of pandas or a CSV file; a single number holds for all
        times. `measured`: a record as of `Simulation.compare`; its deviations are printed, and its times are communication points too.
        `step`: longest communication step [s], or with its unit as "20 ms". `at`: times of the profiles over the contact, likewise.
        `columns`: what headers of other names are, as {"Kraft": "normal_load"}; `strict` refuses what is still unknown instead of
        leaving it out with a warning. `progress` is called with the part that is done. Where a step fails `StepFailed` is raised, at Ctrl-C
        `Interrupted`: `result` of both holds the run so far.

        >>> stop = {"time [s]": [0, 4], "sliding_velocity [km/h]": [36, 0], "normal_load [kN]": 4}
        >>> result = Scene.load("disc_brake").simulate(stop)
        >>> round(float(result["dissipated_energy [kJ]"][-1]), 1)
        64.0
        """
        moments: Any = [at] if np.ndim(at) == 0 else at
        times = [seconds("at", time) for time in moments]

        def kept(answer: _native.Answer) -> Interrupted:
            run = Simulation(answer)
            return Interrupted(f"interrupted at {run.time[-1]:g} s of {run.record['last']:g} s", run, "the run up to there")

        driven, record = (source(own, name, columns, strict) for name, own in (("inputs", inputs), ("measured", measured)))
        result = self._run(driven, step, times, record, progress=progress, kept=kept)
        tell(result.record["notes"])
        for time, text in result.warnings:
            warnings.warn(f"at {time:g} s: {text}", SceneWarning, stacklevel=2)
        if result.record["failure"]:
            raise StepFailed(result.record["failure"], result)
        return result

    def _run(
        self,
        inputs: Optional[dict[str, Any]],
        step: Optional[Time] = None,
        at: Sequence[float] = (),
        measured: Optional[dict[str, Any]] = None,
        assignments: Sequence[str] = (),
        progress: Optional[Callable[[float], object]] = None,
        kept: Optional[Callable[[_native.Answer], Interrupted]] = None,
    ) -> Simulation:
        """A run with further assignments, up to a step that fails; it warns of nothing."""
        longest = None if step is None else seconds("step", step)
        request = self._request("simulate", [*self._assignments, *assignments], inputs=inputs, measured=measured, step=longest, at=list(at))
        return Simulation(_native.ask(request, progress=progress, kept=kept))

    def steady(
        self, *, cells: Optional[int] = None, return_speed: Optional[float] = None, cold: bool = False
    ) -> SteadyState:
        """The steady state under nominal load and sliding, without time integration; `cold`: without heat.

        >>> punch = Scene.load("reciprocating_punch").steady(cells=33, cold=True)
        >>> round(float(punch.strokes[0].pressure.max() / punch.mean_pressure), 2)
        2.0
        """
        speed = None if return_speed is None else number("return_speed", return_speed)
        request = self._request("steady", cells=count("cells", cells), return_speed=speed, cold=flag("cold", cold))
        return SteadyState(self._warn(_native.ask(request).record))

    def cycles(
        self,
        cycles: float,
        *,
        tolerance: float = 1e-3,
        cells: Optional[int] = None,
        cold: bool = False,
        progress: Optional[Callable[[float], object]] = None,
    ) -> Cycles:
        """Reciprocating sliding over many cycles, in jumps with an error estimate each. `progress` is called with the part that is done.
        Ctrl-C raises `Interrupted`, whose `result` has the jumps so far.

        >>> worn = Scene.load("reciprocating_punch").cycles(1e6, cells=17, tolerance=1e-2, cold=True)
        >>> round(float(1e6 * worn.wear_depth_punch[-1]), 1)  # micrometres
        3900.0
        """
        wanted = number("cycles", cycles)
        request = self._request("cycles", cycles=wanted, tolerance=number("tolerance", tolerance), cells=count("cells", cells),
                                cold=flag("cold", cold))  # fmt: skip

        def kept(answer: _native.Answer) -> Interrupted:
            course = Cycles(answer.record)
            passed = course.cycles[-1] if course.cycles.size else 0.0
            return Interrupted(f"interrupted after {passed:g} of {wanted:g} cycles", course, "the jumps so far")

        return Cycles(self._warn(_native.ask(request, progress=progress, kept=kept).record))

    def plan(
        self,
        inputs: Optional[Table] = None,
        *,
        tolerance: Optional[float] = None,
        columns: Optional[Columns] = None,
        strict: bool = False,
        progress: Optional[Callable[[float], object]] = None,
    ) -> Union[Plan, LevelComparison]:
        """The level that `solver.fidelity = auto` takes, or with `inputs` the cheapest that meets the tolerance on them; where none
        does, its `level` is None. `progress` is called with the part that is done. Ctrl-C raises `Interrupted`, whose `result` has the levels that were run.

        >>> plan = Scene.load("reciprocating_punch").plan(tolerance=1e-1)
        >>> plan.settings["solver.fidelity"] in ("lumped", "line")
        True
        """
        wanted = None if tolerance is None else number("tolerance", tolerance)
        request = self._request("plan", inputs=source(inputs, "inputs", columns, strict), tolerance=wanted)

        def kept(answer: _native.Answer) -> Interrupted:
            levels = LevelComparison(answer.record)
            return Interrupted(f"interrupted after {len(levels.record['levels'])} levels", levels, "what is known of them")

        record = self._warn(_native.ask(request, progress=progress, kept=None if inputs is None else kept).record)
        tell(record.pop("notes"))
        return Plan(record) if inputs is None else LevelComparison(record)

    def fit(
        self,
        records: Any,
        parameters: Union[str, Sequence[str]] = ("punch.wear_coefficient", "punch.wear_pressure_exponent"),
        confidence: float = 0.95,
        *,
        scatter: Optional[Mapping[str, float]] = None,
        columns: Optional[Columns] = None,
        strict: bool = False,
        progress: Optional[Callable[[str], object]] = None,
    ) -> "Fit":
        """Fits parameters to end values or histories of wear, friction and temperature, with confidence intervals; needs scipy.

        `records`: a file or a table, or a list of them. With the columns load [N], speed [m/s] and distance [m] they are end values of tests, as of
        volume [mm3]; with time [s] a history: its inputs are driven and its outputs compared. `parameters`: names of variables; one that the
        records do not determine keeps the scene's value, from which the fit begins. `scatter`: known standard deviations of measured outputs.
        `columns` and `strict`: as of `simulate`. `progress` is called with a line before every iteration. Ctrl-C raises `Interrupted`, whose
        `result` has the best values so far, to `set` and fit on.
        """
        from . import fit

        return fit.fit(fit.Model(self, tests_of(records, columns, strict)), parameters, confidence, scatter, progress)

    def batch(
        self,
        design: Union[Mapping[str, Sequence[Value]], "Fit"],
        inputs: Optional[Table] = None,
        *,
        count: int = 200,
        step: Optional[Time] = None,
        done: Optional[Batch] = None,
        columns: Optional[Columns] = None,
        strict: bool = False,
        progress: Optional[Callable[[float], object]] = None,
    ) -> Batch:
        """Runs the scene once for every row of a design along the same inputs, on all cores: outputs at the end, their peaks, wear life.

        `design`: lists of equal length by the name of the variable, or a fit, whose parameters are drawn `count` times from their joint
        distribution. A scene that fails is a row with its reason. Ctrl-C raises `Interrupted`, whose `result` has the scenes that are done;
        the same call with `done=result` runs the others.

        >>> stop = {"time [s]": [0, 4], "sliding_velocity [km/h]": [36, 0], "normal_load [kN]": 4}
        >>> wear = Scene.load("disc_brake").batch({"punch.wear_coefficient": [1e-14, 2e-14]}, stop)
        >>> round(float(wear["wear_depth_punch"][1] / wear["wear_depth_punch"][0]), 2)
        2.0
        """
        rows: Any = design.draw(count) if hasattr(design, "draw") else design
        return batch(self, rows, source(inputs, "inputs", columns, strict), step, done, progress)

    def package(self, path: Union[str, "os.PathLike[str]"]) -> Path:
        """Writes the FMU of the scene (FMI 2.0 for co-simulation, for the platform of this package) and returns its path.

        It is that of `cargo fmu package` to the byte: the scene is filled into the library of a shipped FMU, and model description,
        page and reference are written for it. An FMU that exists is replaced.

        >>> Scene.load("disc_brake").set({"punch.width": "80 mm"}).package("my.fmu").name
        'my.fmu'
        """
        own = Path(path)
        if own.suffix.lower() != ".fmu":
            raise Error(f"path = {str(path)!r} must end in .fmu")
        if own.exists() and not own.is_file():
            raise Error(f"path = {str(path)!r} is no regular file and would be replaced by one")
        shipped = sorted(_native.FMUS.glob("*.fmu"))
        if not shipped:
            raise Error(f"there is no FMU in {_native.FMUS}, whose library is needed: install the wheel")
        target = own.resolve()
        # Renamed when it is complete.
        partial = target.with_name(f"{target.name}.{os.getpid()}.partial")
        with writing(own):
            try:
                with tempfile.TemporaryDirectory(prefix="sliding_contact.") as folder:
                    run = os.path.join(folder, "fmu")
                    _native.ask(self._request("package", packaged=str(shipped[0]), folder=run, output=str(partial)))
                os.replace(partial, target)
            finally:
                partial.unlink(missing_ok=True)
        return own

    def _warn(self, record: dict[str, Any]) -> dict[str, Any]:
        for text in record["scene_warnings"]:
            if text not in self._warned:
                self._warned.add(text)
                warnings.warn(text, SceneWarning, stacklevel=3)
        return record
