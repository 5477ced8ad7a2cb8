"""Quantities over time, as the native library takes them."""

from __future__ import annotations

import csv
import io
import os
from typing import TYPE_CHECKING, Any, Mapping, Optional, Union

import numpy as np

from ._errors import Error
from ._numbers import plain

if TYPE_CHECKING:
    import pandas

#: Quantities over time: columns by name with a unit, a table of pandas, or a CSV or Parquet file.
Table = Union[Mapping[str, Any], "pandas.DataFrame", str, "os.PathLike[str]"]


def source(table: Optional[Table], name: str) -> Optional[dict[str, Any]]:
    """A table as the native library takes it: the path of a file, or the same text as in one."""
    if table is None:
        return None
    accepted = "accepted are CSV and Parquet files, dictionaries and tables of pandas, with columns as in `time [s],contact_temperature [degC]`"
    if isinstance(table, (str, os.PathLike)):
        return {"path": os.fspath(table)}
    if not hasattr(table, "keys"):
        raise Error(f"{name}: {type(table).__name__} is no table; {accepted}")
    columns = {str(header): table[header] for header in table.keys()}
    count = max((len(values) for values in columns.values() if np.ndim(values) == 1), default=1)
    cells = []
    for header, values in columns.items():
        place = f"{name}: the column {header!r}"
        column = [values] * count if np.ndim(values) == 0 else list(values)
        if len(column) != count:
            raise Error(f"{place} has {len(column)} rows, others have {count}")
        column = [plain(place, cell) for cell in column]
        cells.append([repr(float(cell)) if isinstance(cell, (int, float, np.number)) else str(cell) for cell in column])
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*cells))
    return {"text": text.getvalue(), "name": name}
