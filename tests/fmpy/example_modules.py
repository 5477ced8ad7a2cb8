"""Imports an example's modules. Examples are programs, not packages: several have a `report` or a `plots` of their own,
so each is loaded with its folder in front of the path and leaves no names behind."""

import importlib
import sys
from pathlib import Path
from types import SimpleNamespace

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def load(example, *names):
    """Modules of examples/`example` by name."""
    folder = EXAMPLES / example
    own = {path.stem for path in folder.glob("*.py")}
    others = {name: sys.modules.pop(name) for name in own if name in sys.modules}
    sys.path.insert(0, str(folder))
    try:
        return SimpleNamespace(**{name: importlib.import_module(name) for name in names})
    finally:
        sys.path.remove(str(folder))
        for name in own:
            sys.modules.pop(name, None)
        sys.modules.update(others)
