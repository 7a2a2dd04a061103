import io
import subprocess
import sys
from types import SimpleNamespace

import pytest

from coral.commands.progress import EpisodeProgress, MissionProgress


class Running:
    """What the bar of a mission reads."""

    t, coverage, collisions, calls = 0.0, 0.254, 2, 3
    cfg = SimpleNamespace(time_limit_s=10.0)

    def __init__(self, name="s1", step=0, end_reason=""):
        self.world = SimpleNamespace(name=name)
        self.step, self.end_reason = step, end_reason


@pytest.fixture
def shown():
    """The text of a bar after its ticks."""

    def show(progress, *ticks):
        progress._bar.console.file, progress._bar.console.width = io.StringIO(), 200
        for tick in ticks:
            progress.tick(tick)
        progress.close()
        assert progress.stop_requested() == ""
        return progress._bar.console.file.getvalue()

    return show


def test_a_mission_shows_coverage_collisions_and_calls(shown):
    assert "25 % covered · 2 collisions · 3 calls" in shown(MissionProgress(), Running())


def test_a_bar_moves_once_a_second_and_at_the_end(shown):
    ticks = Running("first", step=10), Running("between", step=15)
    assert "first" in (text := shown(MissionProgress(), *ticks))
    assert "between" not in text
    assert "last" in shown(MissionProgress(), *ticks, Running("last", step=17, end_reason="done"))


def test_names_are_no_markup(shown):
    """A world may be named after a tag, which the bar would otherwise take for its own."""
    assert "[/bold]\ufffd[2J" in shown(MissionProgress(), Running("[/bold]\x1b[2J"))


def test_an_episode_shows_its_stage_and_the_conditions_that_hold(shown):
    episode = SimpleNamespace(
        t=1.0,
        time_limit_s=9.0,
        stage="reach [/red]" + "x" * 40,
        trial=SimpleNamespace(task=SimpleNamespace(name="pick-box")),
        referee=SimpleNamespace(holding=[True, False, True]),
    )
    text = shown(EpisodeProgress(), episode)
    assert "pick-box" in text
    assert "reach [/red]xxxxxxxxxxxxxxxxx… · 2 of 3 conditions" in text


def test_a_reefs_command_does_not_load_the_contact_system():
    words = "import sys, coral.commands.reef_run; print([m for m in sys.modules if m in ('coral.contact', 'mujoco')])"
    assert subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True).stdout == "[]\n"
