import json
import threading

import pytest

from coral.desk import watch as module
from coral.desk.inbox import Inbox
from coral.desk.watch import InboxWatch

LONG_S = 30.0
"""Only a watch that never notices waits this long."""


@pytest.fixture
def inbox(tmp_path):
    return Inbox(tmp_path)


def put(inbox, number):
    folder = inbox.folder / f"{number:06d}-pick"
    folder.mkdir()
    (folder / "question.json").write_text(json.dumps({"kind": "pick", "prompt": "Which?", "answer_schema": {}}))


def ids(text):
    return [one["id"] for one in json.loads(text)["questions"]]


def test_the_state_is_known_at_once(inbox):
    put(inbox, 1)
    version, text = InboxWatch(inbox).wait(0, 0.0)
    assert version == 1
    assert ids(text) == ["000001-pick"]
    assert json.loads(text)["missions"] == []


def test_the_version_grows_only_with_a_change(inbox):
    watch = InboxWatch(inbox)
    first, _ = watch.wait(-1, 0.0)
    watch.look()
    assert watch.wait(first, 0.0)[0] == first
    put(inbox, 1)
    watch.look()
    second, text = watch.wait(first, 0.0)
    assert (second, ids(text)) == (first + 1, ["000001-pick"])


def test_only_the_latest_questions_are_listed(inbox, monkeypatch):
    monkeypatch.setattr(module, "RECENT", 2)
    for number in (1, 2, 3):
        put(inbox, number)
    assert ids(InboxWatch(inbox).wait(0, 0.0)[1]) == ["000002-pick", "000003-pick"]


def test_whoever_waits_is_told_of_a_question_that_arrives(inbox):
    watch = InboxWatch(inbox, period_s=0.01)
    seen, _ = watch.wait(0, 0.0)
    watch.start()
    try:
        put(inbox, 1)
        version, text = watch.wait(seen, LONG_S)
        while ids(text) != ["000001-pick"]:
            version, text = watch.wait(version, LONG_S)
        assert version > seen
    finally:
        watch.stop()


def test_whoever_waits_is_released_when_the_watch_stops(inbox):
    watch, released = InboxWatch(inbox, period_s=0.01), threading.Event()
    seen, _ = watch.wait(0, 0.0)
    watch.start()

    def wait():
        with pytest.raises(ConnectionAbortedError, match="the desk is closed"):
            watch.wait(seen, LONG_S)
        released.set()

    waiting = threading.Thread(target=wait)
    waiting.start()
    watch.stop()
    waiting.join(LONG_S)
    assert released.is_set()
    with pytest.raises(ConnectionAbortedError):
        watch.wait(0, 0.0)


def test_a_watch_that_was_not_started_can_be_stopped(inbox):
    watch = InboxWatch(inbox)
    watch.stop()
    with pytest.raises(ConnectionAbortedError):
        watch.wait(0, 0.0)
