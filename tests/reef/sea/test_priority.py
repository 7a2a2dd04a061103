"""Priority where the system allows it."""

import os

import pytest

from coral.reef.sea.priority import describe_priority, prefer_process, prefer_thread


def refuse(*_):
    raise PermissionError("not allowed")


@pytest.mark.parametrize(
    ("process", "thread", "words"),
    [
        (True, True, "real time"),
        (True, False, "nice -10"),
        (False, True, "real time for control alone"),
        (False, False, "ordinary"),
    ],
)
def test_what_was_allowed_is_told(process, thread, words):
    assert describe_priority(process, thread) == words


def test_a_system_that_refuses_is_no_error(monkeypatch):
    monkeypatch.setattr(os, "setpriority", refuse, raising=False)
    monkeypatch.setattr(os, "sched_setscheduler", refuse, raising=False)
    assert not prefer_process()
    assert not prefer_thread()


def test_the_priorities_are_asked_for(monkeypatch):
    asked = []
    monkeypatch.setattr(os, "setpriority", lambda *words: asked.append(words[2]))
    monkeypatch.setattr(os, "sched_setscheduler", lambda pid, policy, param: asked.append(param.sched_priority))
    assert prefer_process()
    assert prefer_thread()
    assert asked == [-10, 10]
