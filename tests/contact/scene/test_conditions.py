"""The order of events, and what conditions read."""

import inspect
import re

import pytest
from contact_bench import body, make_trial, plain, touch, truth, written

from coral.contact.scene.condition import BaseCondition
from coral.contact.scene.conditions import EventSequence
from coral.errors import InputError

TOUCHED = [{"kind": "touching", "object": "box", "thing": "hand"}]
MOVED = [{"kind": "at", "object": "box", "place": "goal", "tolerance_m": 0.02}, {"kind": "released", "object": "box"}]
HERE, THERE = body(), body((0.1, 0, 0.03))


def states(*events):
    """Each event lasts 0.2 s."""
    return [(0.1 * (2 * k + half), *event) for k, event in enumerate(events) for half in (0, 1)]


@pytest.mark.parametrize(
    ("events", "holds"),
    [
        ([(HERE, touch("box", "left")), (THERE,)], True),
        ([(THERE,), (HERE, touch("box", "left"))], False),  # the other way round
        ([(HERE,), (THERE,)], False),
        ([(HERE, touch("box", "left")), (THERE, touch("box", "left"))], False),  # not yet released
        ([(HERE, touch("box", "left")), (THERE,), (HERE,)], True),  # what has happened has happened
    ],
)
def test_events_happen_in_order(events, holds):
    trial = make_trial({"kind": "sequence", "events": [TOUCHED, MOVED]})
    judge = trial.task.success.conditions[0].monitor(trial)
    said = [judge(truth(*state)) for state in states(*events)]
    assert said[-1] is holds


def test_a_moment_is_no_event():
    trial = make_trial({"kind": "sequence", "events": [TOUCHED, MOVED], "for_s": 0.15})
    judge = trial.task.success.conditions[0].monitor(trial)
    assert not [judge(truth(*state)) for state in states((HERE, touch("box", "left")), (THERE,))][-1]


def test_conditions_with_a_history_know_it_from_the_start():
    trial = make_trial({"kind": "sequence", "events": [MOVED, [{"kind": "never-touched", "object": "box"}]]})
    judge = trial.task.success.conditions[0].monitor(trial)
    assert not [judge(truth(*state)) for state in states((HERE, touch("box", "left")), (THERE,), (THERE,))][-1]


@pytest.mark.parametrize(
    ("events", "field", "expected"),
    [
        ([TOUCHED], "events", "at least 2"),
        ([TOUCHED, []], "events[1]", "at least 1"),
        ([TOUCHED, [{"kind": "released", "object": "bax"}]], "events[1][0].object", "did you mean 'box'?"),
        ([TOUCHED, [{"kind": "sequence", "object": "box"}]], "events[1][0].kind", "released, touching"),
    ],
)
def test_refuses(tmp_path, events, field, expected):
    one = {"kind": "sequence", "object": "box", "events": events}
    with pytest.raises(InputError) as caught:
        written(tmp_path, plain() | {"success": {"conditions": [one]}})
    assert caught.value.field == f"success.conditions[0].{field}"
    assert expected in str(caught.value)


def test_a_sequence_is_not_among_its_own_events():
    kinds = EventSequence.model_json_schema()["$defs"]
    assert "EventSequence" not in kinds


def test_conditions_that_read_contacts_say_so():
    for one in (cls for cls in BaseCondition.__subclasses__() if cls.__module__.startswith("coral.")):
        if one is EventSequence:
            continue
        reads = bool(re.search(r"touches\(|\.contacts|hand_force", inspect.getsource(one)))
        assert one.needs_poses_only != reads, one
