"""Every notebook runs from top to bottom in a fresh kernel, and shows what the stored copy shows."""

from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat", reason="notebooks need Jupyter: pip install 'kreisel[oracle]'")
nbclient = pytest.importorskip("nbclient", reason="notebooks need Jupyter: pip install 'kreisel[oracle]'")
pytest.importorskip("ipykernel", reason="notebooks need Jupyter: pip install 'kreisel[oracle]'")

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))


def kinds(notebook):
    """What each cell shows: tables, pictures, text."""
    return [
        [sorted(output.get("data", {"stream": ""})) for output in cell.get("outputs", [])]
        for cell in notebook.cells
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=[path.stem for path in NOTEBOOKS])
def test_notebook_runs_and_shows_what_its_stored_copy_shows(path, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "src"))
    stored = nbformat.read(path, as_version=4)
    fresh = nbformat.read(path, as_version=4)
    client = nbclient.NotebookClient(fresh, timeout=300, resources={"metadata": {"path": str(tmp_path)}})
    client.execute()  # raises with the cell and its traceback
    assert kinds(fresh) == kinds(stored)
    assert any("text/html" in shown for cell in kinds(fresh) for shown in cell), "nouns show themselves"
    assert any("image/png" in shown for cell in kinds(fresh) for shown in cell)
