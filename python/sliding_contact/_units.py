"""Names with units, and values as they stand in a scene file."""

from __future__ import annotations

import json
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import _native
from ._errors import Error
from ._numbers import number, plain

Value = Union[float, int, bool, str, Sequence[Union[float, str]], np.ndarray, Mapping[str, Any]]


def split(name: str) -> tuple[str, Optional[str]]:
    """Name and unit of `name [unit]`."""
    if not isinstance(name, str):
        raise Error(f"{name!r} is no name of a variable")
    # Elements of arrays have an index right behind the name, units stand apart.
    at = name.rfind(" [")
    return (name[:at].rstrip(), name[at + 2 : -1].strip()) if at > 0 and name.endswith("]") else (name, None)


def converted(name: str, unit: str, values: Any) -> Any:
    """SI values of a variable in another unit."""
    record = _native.ask({"analysis": "unit", "name": name, "unit": unit}).record
    return (values - record["zero"]) / record["slope"]


def quantity(name: str, text: str, difference: bool = False) -> float:
    """SI value of a number with or without a unit, as a value of a variable; `difference`: of two of its values.

    >>> quantity("sliding_velocity", "36 km/h"), quantity("ambient_temperature", "20 degC"), quantity("punch.width", "0.1")
    (10.0, 293.15, 0.1)
    """
    return float(_native.ask({"analysis": "quantity", "name": name, "text": text, "difference": difference}).record)


def count(name: str, value: Any, most: int = 1025) -> Optional[int]:
    """A whole number from 1 among the arguments, or none."""
    if value is None:
        return None
    own = number(name, value)
    if not (1 <= own <= most and own == int(own)):
        raise Error(f"{name} = {value!r} must be a whole number from 1 to {most}")
    return int(own)


def seconds(name: str, value: Any) -> float:
    """A time among the arguments, in seconds or with its unit as "20 ms"."""
    if not isinstance(value, str):
        return number(name, value)
    try:
        return quantity("nominal.duration", value)
    except Error as error:
        raise Error(f"{name} = {value!r}: {str(error).split(': ', 1)[-1]}") from None


def with_unit(name: str, value: Any, unit: str) -> Value:
    """A number or numbers in a unit, as texts."""
    if isinstance(value, (str, bytes)):
        raise Error(f"{name} = {value!r}: the name has the unit already; a number is accepted")
    if np.ndim(value) == 0:
        return f"{number(name, value)!r} {unit}"
    return [f"{number(name, entry)!r} {unit}" for entry in value]


def tables(given: Mapping[str, Any]) -> dict[str, Any]:
    """Values by name, the arrays of a table together, and its number of points with them: they are read as one."""

    def is_array(value: Any) -> bool:
        return isinstance(value, (list, tuple)) or isinstance(value, np.ndarray) and value.ndim == 1

    def table(name: str) -> str:
        return name.rsplit(".", 1)[0]

    arrays = [table(name) for name, value in given.items() if is_array(value)]
    joined: dict[str, Any] = {}
    for name, value in given.items():
        if arrays.count(table(name)) > 1:
            joined.setdefault(table(name), {})[name.rsplit(".", 1)[1]] = value
        else:
            joined[name] = value
    return joined


def literal(name: str, value: Any) -> str:
    """A value as it stands in a scene file."""
    value = plain(name, value)
    if isinstance(value, Mapping):
        cells = {key: json.dumps(own) if isinstance(own, str) else literal(f"{name}.{key}", own) for key, own in value.items()}
        return "{" + ", ".join(f"{key} = {cell}" for key, cell in cells.items()) + "}"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(json.dumps(entry) if isinstance(entry, str) else literal(name, entry) for entry in value) + "]"
    if not isinstance(value, (float, np.floating)):
        raise Error(f"{name} = {value!r}: accepted are numbers, texts with a unit or of an item, and lists of them")
    return repr(float(value))
