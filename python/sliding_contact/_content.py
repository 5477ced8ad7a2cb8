"""Draws what `cargo fmu` has computed.

    python -m sliding_contact._content FILE FORMAT < content.json
"""

from __future__ import annotations

import json
import sys
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from . import _figure
from .results import Cycles, SteadyState


def drawn(kind: str, content: dict[str, Any]) -> Figure:
    if kind == "simulation":
        return _figure.figure_of(content)
    if kind == "panels":
        return _figure.panels(content)
    record = content | {"table": ""}
    return _figure.steady(SteadyState(record)) if kind == "steady" else _figure.cycles(Cycles(record))


def main() -> None:
    path, kind = sys.argv[1:3]
    plt.switch_backend("Agg")
    given = json.load(sys.stdin)
    with plt.rc_context(_figure.STYLE):
        _figure.save(drawn(given["kind"], given["content"]), path, kind)


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{error}")
