"""What is written after a run, with the views and without them."""

from coral import plugins
from coral.commands.render import render


def test_nothing_is_made_where_nothing_is_asked_for(tmp_path):
    assert render(tmp_path, report=False, video=False) == {}


def test_without_the_views_a_run_keeps_its_folder_and_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(plugins.OURS, "rendering", {"run": "coral.no_such_wing:render"})
    assert render(tmp_path, report=True, video=False) == {}
    assert "found 'run', expected the wing coral.no_such_wing, which is not installed" in capsys.readouterr().err
