"""The notice for the people at the desk."""

import threading

from coral import plugins
from coral.commands.notice import mission_notice
from coral.desk.inbox import Inbox


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
