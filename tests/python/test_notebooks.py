"""The notebooks of examples/notebooks run from top to bottom, and are committed as they were run."""

import nbformat
import pytest
from nbclient import NotebookClient

from conftest import ROOT

FOLDER = ROOT / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def test_there_are_notebooks():
    assert len(NOTEBOOKS) == 3


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_it_runs_and_draws_what_it_shows(path, monkeypatch):
    # The kernel's own backend, which keeps figures in the outputs.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    committed = nbformat.read(path, as_version=4)
    run = nbformat.from_dict(committed)
    NotebookClient(run, timeout=300, resources={"metadata": {"path": str(FOLDER)}}).execute()
    for before, after in zip(committed.cells, run.cells):
        if before.cell_type == "code":
            assert pictures(before) == pictures(after), before.source
            assert before.execution_count is not None, "commit it as it was run"
            assert not any("ename" in output for output in before.outputs)


def pictures(cell):
    return sum("image/png" in output.get("data", {}) for output in cell.outputs)
