"""A design of experiments: ranges of parameters, filled evenly by Sobol's sequence."""

import csv
import hashlib
import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

FACTOR = ".factor"


@dataclass(frozen=True)
class Variable:
    """A parameter, or the factor on an input's column of the schedule (`normal_load.factor`), and its range."""

    name: str
    low: float
    high: float
    scale: str = "linear"  # or "log": evenly spread is the logarithm

    def __post_init__(self):
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise ValueError(f"{self.name}: the range must be finite and low < high, not {self.low:g} to {self.high:g}")
        if self.scale not in ("linear", "log"):
            raise ValueError(f"{self.name}: the scale {self.scale!r} is neither linear nor log")
        if self.scale == "log" and self.low <= 0.0:
            raise ValueError(f"{self.name}: a log scale starts above 0, not at {self.low:g}")

    @property
    def is_factor(self):
        return self.name.endswith(FACTOR)

    def spread(self, unit):
        """Values for numbers from 0 to 1."""
        if self.scale == "log":
            return self.low * (self.high / self.low) ** unit
        return self.low + (self.high - self.low) * unit


@dataclass(frozen=True)
class Design:
    """Scenes in order: scene i depends on the seed and i alone, so that a larger design continues a smaller one."""

    variables: tuple
    scenes: int
    seed: int

    def __post_init__(self):
        names = [variable.name for variable in self.variables]
        if len(set(names)) != len(names) or not names:
            raise ValueError(f"the design's variables must be there and each but once: {', '.join(names)}")
        if self.scenes < 1:
            raise ValueError(f"a design of {self.scenes} scenes is none")

    @classmethod
    def read(cls, path, scenes, seed):
        """From a CSV file with the columns name, low, high, scale."""
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            missing = {"name", "low", "high", "scale"} - set(reader.fieldnames or ())
            if missing:
                raise ValueError(f"{path} has no column {', '.join(sorted(missing))}")
            variables = []
            for row in reader:
                try:
                    low, high = float(row["low"]), float(row["high"])
                except (TypeError, ValueError):
                    raise ValueError(f"{path}, {row['name']}: low and high must be numbers") from None
                variables.append(Variable(row["name"].strip(), low, high, (row["scale"] or "").strip()))
        return cls(tuple(variables), scenes, seed)

    @property
    def names(self):
        return [variable.name for variable in self.variables]

    def rows(self):
        """All scenes: one row each, one column per variable.

        Sobol's sequence, Owen-scrambled. It is balanced over every power of two, so the whole power is drawn and the
        beginning of it used.
        """
        exponent = max(1, math.ceil(math.log2(self.scenes)))
        unit = qmc.Sobol(len(self.variables), scramble=True, seed=self.seed).random_base2(exponent)[: self.scenes]
        return self.spread(unit)

    def spread(self, unit):
        """Scenes for rows of numbers from 0 to 1."""
        return np.column_stack([variable.spread(column) for variable, column in zip(self.variables, unit.T)])

    def fingerprint(self):
        """Of everything but the number of scenes: a larger design continues a smaller one."""
        text = repr((type(self).__name__, self.variables, self.seed))
        return hashlib.sha256(text.encode()).hexdigest()


class TotalOrderDesign(Design):
    """Saltelli's design for total-order indices, by SALib: groups of one base point, one for each variable, and another base point.

    Of D variables a group has D + 2 scenes; there is a power of two of groups, the largest that `scenes` has room for.
    """

    @property
    def groups(self):
        size = len(self.variables) + 2
        if self.scenes < 2 * size:
            raise ValueError(f"total-order indices of {size - 2} variables need at least {2 * size} scenes, not {self.scenes}")
        return 2 ** math.floor(math.log2(self.scenes / size))

    def problem(self):
        """The variables as SALib takes them, as numbers from 0 to 1."""
        return {"num_vars": len(self.variables), "names": self.names, "bounds": [[0.0, 1.0]] * len(self.variables)}

    def rows(self):
        from SALib.sample import sobol

        return self.spread(sobol.sample(self.problem(), self.groups, calc_second_order=False, seed=self.seed))
