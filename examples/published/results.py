"""What a case has: comparisons, curves, and the change that its bands must not survive."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from model import Model, Run

AMBIENT = 293.15


@dataclass(frozen=True)
class Comparison:
    """One number: deviation is (model - published) / published, and has to stay within `band`, (lowest, highest)."""

    quantity: str
    unit: str
    published: float
    model: float
    band: tuple[float, float]

    @property
    def deviation(self) -> float:
        return self.model / self.published - 1.0

    @property
    def holds(self) -> bool:
        return self.band[0] <= self.deviation <= self.band[1]


@dataclass(frozen=True)
class Curve:
    label: str
    x: np.ndarray
    y: np.ndarray
    published: bool
    points: bool = False  # published values that are marked one by one


@dataclass(frozen=True)
class Result:
    title: str
    x: str
    y: str
    comparisons: list[Comparison]
    curves: list[Curve] = field(default_factory=list)
    limits: tuple[float, float] | None = None  # of the vertical axis


@dataclass(frozen=True)
class Case:
    compute: Callable[[Model], Result]
    change: str  # a change of the model that its bands must not survive


def rise(run: Run, name: str = "temperature") -> np.ndarray:
    return run[name] - AMBIENT


def table_of(times: np.ndarray, velocities: np.ndarray, loads: np.ndarray) -> str:
    """Inputs as a file has them."""
    rows = zip(times.tolist(), velocities.tolist(), loads.tolist(), strict=True)
    return "time [s],sliding_velocity [m/s],normal_load [N]\n" + "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in rows)
