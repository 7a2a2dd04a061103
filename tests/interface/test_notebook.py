"""The code of the page about Python runs in a real notebook kernel, whose event loop is running."""

import re
from pathlib import Path

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
PAGE = Path(__file__).parents[2] / "docs/guide/python.md"
CELLS = re.findall(r"^```python run\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
LOOP_RUNS = "import asyncio\nassert asyncio.get_running_loop().is_running()"


@pytest.mark.slow
def test_every_cell_runs_where_an_event_loop_is_running(tmp_path):
    cells = [nbformat.v4.new_code_cell(text) for text in (LOOP_RUNS, *CELLS)]
    notebook = nbformat.v4.new_notebook(cells=cells)
    client = nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}})
    client.execute()
    said = ["".join(part.get("text", "") for part in cell.outputs) for cell in notebook.cells]
    assert [text.partition("(")[0] for text in said[1:3]] == ["MissionResult", "TaskResult"]
    assert len(CELLS) == 4
    assert not list(tmp_path.iterdir())
