"""A design of experiments: variables with their distributions, filled evenly by Sobol's sequence."""

import csv
import math
from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.stats import qmc

from sliding_contact._units import quantity, split

FACTOR = ".factor"

# Distributions by their usual names and those of scipy.stats, with the parameters that each may be given by: the usual ones or scipy's.
# A parameter that is a distance between values has no zero (a scale of a temperature is in K, never in degC).
DISTRIBUTIONS = {
    "uniform": {
        ("low", "high"): lambda low, high: stats.uniform(low, high - low),
        ("loc", "scale"): stats.uniform,
    },
    "loguniform": {
        ("low", "high"): stats.loguniform,
        ("a", "b"): stats.loguniform,
    },
    "triangular": {
        ("low", "mode", "high"): lambda low, mode, high: stats.triang((mode - low) / (high - low), low, high - low),
        ("c", "loc", "scale"): stats.triang,
    },
    "normal": {
        ("mean", "standard_deviation"): stats.norm,
        ("loc", "scale"): stats.norm,
    },
    "lognormal": {
        ("median", "s"): lambda median, s: stats.lognorm(s, scale=median),
        ("s", "scale"): lambda s, scale: stats.lognorm(s, scale=scale),
        ("s", "loc", "scale"): stats.lognorm,
    },
}
SYNONYMS = {"norm": "normal", "lognorm": "lognormal", "triang": "triangular", "reciprocal": "loguniform"}
PARAMETERS = tuple(dict.fromkeys(name for ways in DISTRIBUTIONS.values() for names in ways for name in names))
DIFFERENCES = ("scale", "standard_deviation")
NUMBERS = ("s", "c")
# Sobol's sequence has 30 bits: the ends of the last one's interval, where unbounded distributions are infinite, are left out.
LEAST = 2.0**-31


def accepted(distribution):
    """The parameters of a distribution, for messages."""
    return " or ".join(", ".join(names) for names in DISTRIBUTIONS[distribution])


@dataclass(frozen=True)
class Variable:
    """A parameter, or the factor on an input's column of the schedule (`normal_load.factor`), and its distribution."""

    name: str
    distribution: str  # one of DISTRIBUTIONS
    parameters: tuple  # pairs of name and value, in the SI unit

    def __post_init__(self):
        own = SYNONYMS.get(self.distribution, self.distribution)
        object.__setattr__(self, "distribution", own)
        if own not in DISTRIBUTIONS:
            raise ValueError(f"{self.name}: there is no distribution {own!r}; accepted are {', '.join((*DISTRIBUTIONS, *SYNONYMS))}")
        given = dict(self.parameters)
        if set(given) not in [set(names) for names in DISTRIBUTIONS[own]]:
            raise ValueError(f"{self.name}: {own} is given by {', '.join(given) or 'nothing'}, but takes {accepted(own)}")
        for name, value in given.items():
            if not math.isfinite(value):
                raise ValueError(f"{self.name}: {name} = {value:g} must be finite")
            if name in ("scale", "standard_deviation", "s", "a", "median") and value <= 0.0:
                raise ValueError(f"{self.name}: {name} = {value:g} must be above 0")
        low, high = given.get("low", given.get("a")), given.get("high", given.get("b"))
        if low is not None and not low < high:
            raise ValueError(f"{self.name}: low = {low:g} must be below high = {high:g}")
        if own == "loguniform" and low <= 0.0:
            raise ValueError(f"{self.name}: low = {low:g} of loguniform must be above 0")
        if "mode" in given and not low <= given["mode"] <= high:
            raise ValueError(f"{self.name}: mode = {given['mode']:g} must be from low = {low:g} to high = {high:g}")
        if not 0.0 <= given.get("c", 0.0) <= 1.0:
            raise ValueError(f"{self.name}: c = {given['c']:g} must be from 0 to 1")

    @property
    def is_factor(self):
        return self.name.endswith(FACTOR)

    def text(self):
        """Distribution and parameters, to every digit."""
        return f"{self.distribution}, " + ", ".join(f"{name} {value!r}" for name, value in self.parameters)

    def frozen(self):
        """The distribution as scipy has it."""
        given = dict(self.parameters)
        ways = DISTRIBUTIONS[self.distribution]
        (names,) = [names for names in ways if set(names) == set(given)]
        return ways[names](*(given[name] for name in names))

    def spread(self, unit):
        """Values for numbers from 0 to 1: the quantiles."""
        return self.frozen().ppf(np.clip(unit, LEAST, 1.0 - LEAST))


def read_variable(row):
    """A variable from the cells of its row, by column; the cells of parameters may have units."""
    name, symbol = split((row.get("name") or "").strip())
    if not name:
        raise ValueError("the cell of name is empty")
    parameters = []
    is_factor = name.endswith(FACTOR)
    for column in PARAMETERS:
        cell = (row.get(column) or "").strip()
        if not cell:
            continue
        text = f"{cell} {symbol}" if symbol and column not in NUMBERS and is_plain(cell) else cell
        try:
            value = ratio(text) if is_factor or column in NUMBERS else quantity(name, text, column in DIFFERENCES)
        except ValueError as error:
            raise ValueError(f"{name}, {column}: {error}") from None
        parameters.append((column, value))
    return Variable(name, (row.get("distribution") or "").strip(), tuple(parameters))


def ratio(text):
    """A number without a unit, plain or in per cent."""
    number = text.removesuffix("%")
    if not is_plain(number):
        raise ValueError(f"{text!r} is no number; accepted are numbers without a unit and per cent, as 0.5 or 50 %")
    return float(number) / (1.0 if number == text else 100.0)


def is_plain(cell):
    """Whether a cell is a number without a unit."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


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
        """From a CSV file with the columns name, distribution, and the parameters of the distributions."""
        with open(path, newline="", encoding="utf-8") as file:
            lines = [(number, line) for number, line in enumerate(file, 1) if line.strip() and not line.startswith("#")]
            reader = csv.DictReader((line for _, line in lines), skipinitialspace=True)
            header = [column.strip() for column in reader.fieldnames or ()]
            reader.fieldnames = header
            missing = [name for name in ("name", "distribution") if name not in header]
            unknown = [name for name in header if name not in ("name", "distribution", *PARAMETERS)]
            if missing or unknown:
                wrong = f"has no column {', '.join(missing)}" if missing else f"has a column {unknown[0]!r}"
                raise ValueError(f"{path}, line 1: it {wrong}; accepted are name, distribution, {', '.join(PARAMETERS)}")
            variables = []
            for row in reader:
                try:
                    if None in row or None in row.values():
                        raise ValueError(f"the row has not {len(header)} cells as the header")
                    variables.append(read_variable(row))
                except ValueError as error:
                    raise ValueError(f"{path}, line {lines[reader.line_num - 1][0]}: {error}") from None
        if not variables:
            raise ValueError(f"{path} has no row below its header")
        twice = [variable.name for at, variable in enumerate(variables) if variable.name in [own.name for own in variables[:at]]]
        if twice:
            raise ValueError(f"{path}: {twice[0]} stands in two rows")
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

    def identity(self):
        """What the scenes depend on, by name, but for their number: a larger design continues a smaller one."""
        variables = {f"design of {own.name}": own.text() for own in self.variables}
        return {"total-order": isinstance(self, TotalOrderDesign), "seed": self.seed, **variables}


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
