"""Quantities over time, as the native library takes them."""

from __future__ import annotations

import csv
import io
import os
import warnings
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence, Union

import numpy as np

from ._errors import Error, SceneNote
from ._numbers import flag, plain

if TYPE_CHECKING:
    import pandas

#: Quantities over time: columns by name with a unit, a table of pandas, or a CSV or Parquet file.
Table = Union[Mapping[str, Any], "pandas.DataFrame", str, "os.PathLike[str]"]


#: What columns of a file are, as {"COF": "friction_coefficient"}; an empty name leaves one out.
Columns = Mapping[str, str]


def source(table: Optional[Table], name: str, columns: Optional[Columns] = None, strict: bool = False) -> Optional[dict[str, Any]]:
    """A table as the native library takes it: the path of a file, or the same text as in one."""
    if table is None:
        return None
    accepted = "accepted are CSV and Parquet files, dictionaries and tables of pandas, with columns as in `time [s],contact_temperature [degC]`"
    if not (columns is None or isinstance(columns, Mapping) and all(isinstance(own, str) for pair in columns.items() for own in pair)):
        raise Error(f'columns = {columns!r}: accepted is a dictionary of headers and variables, as {{"COF": "friction_coefficient"}}')
    reading = {"columns": [f"{header}={variable}" for header, variable in (columns or {}).items()], "strict": flag("strict", strict)}
    if isinstance(table, (str, os.PathLike)):
        return {"path": os.fspath(table), "text": None, **reading}
    if not hasattr(table, "keys"):
        raise Error(f"{name}: {type(table).__name__} is no table; {accepted}")
    given = {str(header): table[header] for header in table.keys()}
    count = max((len(values) for values in given.values() if np.ndim(values) == 1), default=1)
    cells = []
    for header, values in given.items():
        place = f"{name}: the column {header!r}"
        column = [values] * count if np.ndim(values) == 0 else list(values)
        if len(column) != count:
            raise Error(f"{place} has {len(column)} rows, others have {count}")
        column = [plain(place, cell) for cell in column]
        cells.append([repr(float(cell)) if isinstance(cell, (int, float, np.number)) else str(cell) for cell in column])
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(given)
    writer.writerows(zip(*cells))
    return {"path": name, "text": text.getvalue(), **reading}


def tell(notes: Sequence[str], depth: int = 3) -> None:
    """Tells what was made of headers that are no names of quantities, in the line of the user."""
    for note in notes:
        warnings.warn(note, SceneNote, stacklevel=depth)
