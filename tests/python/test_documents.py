"""Doc strings, the page docs/python.md and types of the package."""

import doctest
import importlib
import os
import subprocess
import sys

import pytest

from conftest import ROOT

MODULES = ("sliding_contact", "sliding_contact._units", "sliding_contact.scene", "sliding_contact.results", "sliding_contact.host", "sliding_contact.fit")
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
pytestmark = pytest.mark.filterwarnings("ignore::sliding_contact.SceneWarning")


def test_doc_strings_are_true(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    results = [doctest.testmod(importlib.import_module(name), optionflags=FLAGS) for name in MODULES]
    assert sum(result.failed for result in results) == 0
    assert sum(result.attempted for result in results) > 20


def test_the_page_is_true(tmp_path, monkeypatch):
    """Its Python is run from top to bottom, in a folder of its own; what follows `>>>` is compared."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stop.csv").write_text("time [s],sliding_velocity [km/h],normal_load [kN]\n0,36,0\n0.3,36,8\n4,0,8\n5,0,0\n")
    (tmp_path / "bench.csv").write_text("time [s],contact_temperature [degC]\n1,150\n2,140\n3,110\n")
    blocks = (ROOT / "docs" / "python.md").read_text().split("```python\n")[1:]
    code = [block.split("```")[0] for block in blocks]
    assert len(code) >= 5
    names = {}
    for block in code:
        if ">>>" in block:
            test = doctest.DocTestParser().get_doctest(block, names, "docs/python.md", None, 0)
            runner = doctest.DocTestRunner(optionflags=FLAGS)
            runner.run(test, clear_globs=False)
            assert runner.failures == 0
            names = test.globs
        else:
            exec(compile(block, "docs/python.md", "exec"), names)
    assert {"stop.pdf", "bench.png"} <= {path.name for path in tmp_path.iterdir()}


def test_types_are_consistent(tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path)]
    run = subprocess.run(command, cwd=ROOT / "python", capture_output=True, text=True, env={**os.environ, "PYTHONPATH": ""})
    assert run.returncode == 0, run.stdout
