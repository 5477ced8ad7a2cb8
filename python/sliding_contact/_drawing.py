"""Figures: their style, and the files that they are written to."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Sequence, Union

from ._errors import Error, writing

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def drawn(draw: Callable[[Any], "Figure"], path: Union[str, "os.PathLike[str]", None]) -> "Figure":
    """Draws by `draw`, which is given `_figure`, and writes the figure; the ending of the path says the format."""
    endings: Sequence[str] = ("svg", "pdf", "png")
    ending = os.path.splitext(os.fspath(path))[1].lower().lstrip(".") or "svg" if path is not None else "svg"
    if ending not in endings:
        raise Error(f"{path}: .{', .'.join(endings)} are drawn, not .{ending}")
    try:
        import matplotlib
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise ImportError("figures need matplotlib: pip install matplotlib") from error
    from . import _figure

    with plt.rc_context(_figure.STYLE):
        figure = draw(_figure)
        interactive = matplotlib.is_interactive()
    # A notebook's backend turns this on when it is first used, which the end of the context undoes.
    matplotlib.interactive(interactive)
    if path is not None:
        with writing(path):
            _figure.save(figure, os.fspath(path), ending)
    return figure
