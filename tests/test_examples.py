"""The examples run, scripts and notebooks, and are all in their table."""

import re
import runpy
import sys
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"
NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))
NEEDS = {
    "dive_to_map.py": ("onnxruntime", "tifffile"),
    "dive_to_map.ipynb": ("onnxruntime", "tifffile"),
    "train_a_policy.py": ("gymnasium",),
}


@pytest.mark.slow
@pytest.mark.parametrize("script", sorted(EXAMPLES.glob("*.py")), ids=lambda script: script.stem)
def test_an_example_runs(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for package in NEEDS.get(script.name, ()):
        pytest.importorskip(package)
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setattr(sys, "argv", [str(script), str(tmp_path / "out")])
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out.strip()


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_shows_what_it_showed(path: Path, tmp_path: Path) -> None:
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    for package in ("pandas", *NEEDS.get(path.name, ())):
        pytest.importorskip(package)
    notebook = nbformat.read(path, as_version=4)
    shown = [_kinds(cell) for cell in notebook.cells]
    client = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}})
    client.execute()
    assert [_kinds(cell) for cell in notebook.cells] == shown
    assert "text/html" in {kind for kinds in shown for kind in kinds}


def _kinds(cell: Any) -> list[str]:
    """Return what a cell shows: streams by name, and the forms of its values."""
    return [kind for output in cell.get("outputs", ()) for kind in sorted(output.get("data", {output.get("name"): ""}))]


def test_no_output_tells_where_a_notebook_was_run() -> None:
    assert [path.name for path in NOTEBOOKS if re.search(r"/(tmp|home|root)/", path.read_text(encoding="utf-8"))] == []


def test_every_example_is_in_the_table() -> None:
    table = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in (*EXAMPLES.glob("*.py"), *NOTEBOOKS) if f"({path.name})" not in table] == []
    assert len(NOTEBOOKS) == 4
