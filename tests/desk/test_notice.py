import json
import os
import socket
import subprocess
import sys

import pytest

from coral.desk.inbox import Inbox
from coral.desk.notice import MissionNotice, is_alive, mission_notice


@pytest.fixture
def inbox(tmp_path):
    return Inbox(tmp_path / "inbox")


@pytest.fixture(scope="module")
def dead_pid():
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def test_a_mission_tells_how_it_ended(inbox):
    with mission_notice(inbox.folder, world="s1", run="runs/s1-001") as notice:
        assert inbox.missions()[0]["state"] == "running"
        notice.hear({"event": "state", "state": "holding", "reason": "pose stale"})
        assert inbox.missions()[0]["doing"] == "holding - pose stale"
        notice.finished("8 of 8 oyster clusters covered")
    (kept,) = inbox.missions()
    assert (kept["state"], kept["outcome"], kept["world"]) == ("finished", "8 of 8 oyster clusters covered", "s1")


def test_events_tell_what_the_robot_does_and_is_to_do(inbox):
    with mission_notice(inbox.folder, instruction="Find the net.") as notice:
        notice.hear({"event": "awaited", "state": "holding", "reason": "pose stale", "ends_when": "a pose"})
        notice.hear({"event": "instruction", "text": "Find the tyre.", "by": "page"})
        (mission,) = inbox.missions()
        assert (mission["doing"], mission["instruction"]) == ("holding - pose stale - a pose", "Find the tyre.")


def test_other_words_are_taken_once(inbox):
    told = []
    with mission_notice(inbox.folder, instruction="Find the net."):
        (path,) = inbox.folder.glob("mission-*.json")
        inbox.instruct(inbox.missions()[0]["id"], "Find the tyre.")
        notice = MissionNotice(path, {}, lambda words, by: told.append((words, by)))
        notice.take_instruction()
        notice.take_instruction()
    assert told == [("Find the tyre.", "somebody at the desk")]


@pytest.mark.parametrize("text", ["", "[]", "{", '{"instruction": 7}', '{"words": "Find it."}'])
def test_what_is_no_instruction_is_none(inbox, text):
    notice = MissionNotice(inbox.folder / "mission-here-1.json", {}, lambda words, by: pytest.fail(words))
    (inbox.folder / "instruction-here-1.json").write_text(text)
    notice.take_instruction()
    assert not (inbox.folder / "instruction-here-1.json").exists()


def test_words_for_an_earlier_mission_of_the_same_process_number_are_thrown_away(inbox):
    left = inbox.folder / f"instruction-{socket.gethostname()}-{os.getpid()}.json"
    left.write_text('{"instruction": "Find it."}')
    with mission_notice(inbox.folder):
        assert not left.exists()


def test_a_mission_that_leaves_without_an_outcome_has_failed(inbox):
    with pytest.raises(ZeroDivisionError), mission_notice(inbox.folder):
        raise ZeroDivisionError
    assert inbox.missions()[0]["state"] == "failed"


def test_a_killed_mission_has_stopped(inbox, dead_pid):
    with mission_notice(inbox.folder):
        (file,) = inbox.folder.glob("mission-*.json")
        notice = json.loads(file.read_text())
        file.write_text(json.dumps({**notice, "pid": dead_pid}))
        assert inbox.missions()[0]["state"] == "stopped"


def test_a_notice_is_named_after_the_process_and_written_whole(tmp_path):
    folder = tmp_path / "a" / "inbox"
    with mission_notice(folder, run=tmp_path):
        assert [path.name for path in folder.iterdir()] == [f"mission-{socket.gethostname()}-{os.getpid()}.json"]
    (file,) = folder.iterdir()
    assert json.loads(file.read_text())["run"] == str(tmp_path)


def test_a_notice_never_stops_a_mission(tmp_path):
    (tmp_path / "file").write_text("")
    with mission_notice(tmp_path / "file") as notice:
        notice.finished("done")
    assert (tmp_path / "file").read_text() == ""


def test_a_process_is_alive_until_it_has_ended(dead_pid):
    here = socket.gethostname()
    assert is_alive(here, os.getpid())
    assert not is_alive(here, dead_pid)


def test_what_cannot_be_checked_counts_as_alive(dead_pid):
    assert is_alive("some-other-machine", dead_pid)
    assert is_alive(socket.gethostname(), 10**30)
