"""Numbers among the arguments: real ones, whatever holds them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._errors import Error


def plain(name: str, value: Any) -> Any:
    """A value out of its array of no dimension; a complex one is refused, as its imaginary part would be lost."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, (complex, np.complexfloating)):
        raise Error(f"{name} = {value} is complex; a real number is accepted")
    return value


def number(name: str, value: Any) -> float:
    """A finite number."""
    try:
        own = float(plain(name, value))
    except (TypeError, ValueError) as error:
        if isinstance(error, Error):
            raise
        own = float("nan")
    if not np.isfinite(own):
        raise Error(f"{name} = {value!r} must be a finite number")
    return own


def flag(name: str, value: Any) -> bool:
    """Yes or no; a text as "no" would be true in Python."""
    if not isinstance(value, (bool, np.bool_)):
        raise Error(f"{name} = {value!r} must be True or False")
    return bool(value)


def numbers(name: str, values: Any) -> np.ndarray:
    """Real numbers in an array of doubles."""
    own = np.asarray(values)
    if own.dtype.kind == "c":
        first = own.ravel()[int(np.argmax(own.ravel().imag != 0.0))] if own.size else own.dtype
        raise Error(f"{name} has the complex number {first}; real numbers are accepted")
    if own.dtype.kind == "O":
        own = np.array([plain(name, value) for value in own.ravel()], dtype=object).reshape(own.shape)
    try:
        return np.ascontiguousarray(own, dtype=np.float64)
    except (TypeError, ValueError):
        raise Error(f"{name} = {values!r} are no numbers") from None
