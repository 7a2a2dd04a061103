"""`coral` alone in a terminal."""

import json
import re
import shlex

import pytest

from coral.cli import COMMANDS, _parse, main
from coral.commands.front_page import front_page


@pytest.fixture
def runs(tmp_path):
    """A survey that ended, and an attempt that was killed, later."""
    (tmp_path / "s1-001").mkdir()
    (tmp_path / "s1-001/config.yaml").write_text("system: reef\nworld: s1\nadvisor: heuristic\n")
    metrics = {"end_reason": "surveyed", "coverage": 1.0, "inspected": 0.98, "collisions": 0, "sim_time_s": 219.0}
    (tmp_path / "s1-001/metrics.json").write_text(json.dumps(metrics))
    (tmp_path / "s1-001/report.html").write_text("")
    return tmp_path


def test_it_names_reefs_tasks_and_what_each_run_reached(runs):
    page = front_page(runs)
    assert " s1 " in page
    assert " pick-box " in page
    assert "  s1-001  100 % covered, 98 % inspected, 0 collisions, 219 s  (s1, heuristic)" in page
    assert f"xdg-open {runs}/s1-001/report.html" in page


def test_a_run_without_an_end_and_a_folder_without_runs_are_told(runs):
    (runs / "s1-001/metrics.json").unlink()
    (runs / "s1-001/report.html").unlink()
    assert "s1-001  no end: it is running, or was killed" in front_page(runs)
    assert "xdg-open" not in front_page(runs)
    assert "no run is recorded in" in front_page(runs / "none")


def test_every_command_on_it_can_be_typed(runs):
    typed = re.findall(r"^  (coral (?!--).*?)  ", front_page(runs), re.MULTILINE)
    assert len(typed) >= 5
    for line in typed:
        words = shlex.split(line)[1:]
        name = next(" ".join(words[:n]) for n in (2, 1) if " ".join(words[:n]) in COMMANDS)
        _parse(name, words[len(name.split()) :])


def test_a_terminal_gets_it_and_a_pipe_gets_the_help(capsys, monkeypatch):
    assert main([]) == 0
    assert capsys.readouterr().out.startswith("usage: coral COMMAND")
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert main([]) == 0
    assert capsys.readouterr().out.startswith("CORAL (reef) surveys")
