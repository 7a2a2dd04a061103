import threading

import pytest

from coral import plugins
from coral.commands.around_run import LiveFlags, mission_notice, render, watching
from coral.desk.inbox import Inbox
from coral.errors import InputError


def test_without_the_flag_nobody_watches_and_nothing_is_checked():
    flags = LiveFlags(live=False, live_port=70000, live_speed=-1.0)
    flags.check()
    with watching(flags, "reef", object()) as viewers:
        assert viewers == []


@pytest.mark.wing("coral.view")
@pytest.mark.parametrize(("port", "speed", "said"), [(70000, 1.0, "--live-port"), (0, -1.0, "--live-speed")])
def test_a_flag_out_of_range_is_refused_before_anything_is_made(port, speed, said):
    with pytest.raises(InputError, match=said):
        LiveFlags(live=True, live_port=port, live_speed=speed).check()


def test_a_missing_viewer_is_said_before_anything_is_made(monkeypatch):
    monkeypatch.setitem(plugins.OURS, "live", {"run": "coral.no_such_wing:watching"})
    with pytest.raises(InputError, match=r"--live: found 'run', expected the wing coral.no_such_wing"):
        LiveFlags(live=True, live_port=0, live_speed=1.0).check()


def test_people_are_told_of_a_mission_that_asks_them(tmp_path):
    with mission_notice(True, tmp_path, world="s1") as notice:
        assert notice.running
        assert len(list(tmp_path.glob("mission-*.json"))) == 1


def test_the_instruction_can_be_changed_there(tmp_path, monkeypatch):
    monkeypatch.setattr("coral.desk.notice.LOOK_S", 0.01)
    told, heard = [], threading.Event()

    def instruct(words, by):
        told.append((words, by))
        heard.set()
        return True

    with mission_notice(True, tmp_path, instruct, instruction="Find the net."):
        (mission,) = Inbox(tmp_path).missions()
        Inbox(tmp_path).instruct(mission["id"], "Find the tyre.", "Ana")
        assert heard.wait(60.0)
    assert told == [("Find the tyre.", "Ana at the desk")]


def test_nobody_is_told_without_people_or_without_a_desk(tmp_path, monkeypatch):
    with mission_notice(False, tmp_path, world="s1") as notice:
        assert notice is None
    monkeypatch.setitem(plugins.OURS, "notice", {"desk": "coral.no_such_wing:notice"})
    with mission_notice(True, tmp_path, world="s1") as notice:
        assert notice is None
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_made_where_nothing_is_asked_for(tmp_path):
    assert render(tmp_path, report=False, video=False) == {}


def test_without_the_views_a_run_keeps_its_folder_and_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(plugins.OURS, "rendering", {"run": "coral.no_such_wing:render"})
    assert render(tmp_path, report=True, video=False) == {}
    assert "found 'run', expected the wing coral.no_such_wing, which is not installed" in capsys.readouterr().err
