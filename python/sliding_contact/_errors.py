"""What the package raises and warns of."""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator, Union


class Error(ValueError):
    """What is wrong with a scene, a file or an argument, or why there is no result, in the words of the command line."""


class SceneWarning(UserWarning):
    """Values that are allowed but improbable, or a run that left what the model is valid for."""


class SceneNote(SceneWarning):
    """What was made of the columns of a file whose headers are no names of quantities."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C in work that keeps what is done; `result` holds it: the run or the cycles up to there, of a plan the levels that were run, of a fit
    the best values so far, of a batch its finished scenes."""

    def __init__(self, reason: str, result: Any, has: str = "") -> None:
        super().__init__(f"{reason}; `result` has {has}" if has else reason)
        self.reason, self.result = reason, result


@contextmanager
def writing(path: Union[str, "os.PathLike[str]"]) -> Iterator[None]:
    """Makes the folder of a file that is written within; raises `Error` with file and reason where either fails."""
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        raise Error(f"writing {os.fspath(path)}: {error}") from error


for _public in (Error, Interrupted, SceneNote, SceneWarning):
    _public.__module__ = "sliding_contact"
