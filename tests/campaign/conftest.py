import sys
from pathlib import Path

import pytest

from coral.campaign.spec import grid


@pytest.fixture
def toy(monkeypatch):
    """The module of toy episodes, importable here and in spawned workers."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    import campaign_toy

    yield campaign_toy
    sys.modules.pop("campaign_toy", None)


@pytest.fixture
def specs_of(tmp_path):
    """Makes specs whose toy episodes leave their marks in a folder of this test."""
    marks = tmp_path / "marks"
    marks.mkdir()

    def make(worlds=("w",), seeds=(0, 1, 2), variants=("a",)):
        return grid("toy", variants=variants, worlds=worlds, seeds=seeds, advisors=[str(marks)])

    make.marks = marks
    return make
