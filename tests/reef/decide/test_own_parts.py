import pytest

from coral.advisor.question import Rejection
from coral.errors import InputError
from coral.reef.decide.own_parts import FunctionTrigger, find_trigger, find_verifier
from coral.reef.decide.trigger import TriggerCfg


def at(trigger, t, x=0.0, target=(9.0, 0.0), pending=False, speed=0.5):
    return trigger.update(t, x, 0.0, speed, target, pending, None)


def test_the_function_decides_and_its_cause_is_its_own():
    trigger = FunctionTrigger(lambda now: now.x > 1.0)
    assert at(trigger, 0.0, x=0.5) is None
    firing = at(trigger, 0.1, x=1.5)
    assert (firing.cause, firing.fired) == ("own", True)


def test_the_cooldown_and_an_open_question_hold_it_back():
    trigger = FunctionTrigger(lambda now: True, TriggerCfg(cooldown_s=5.0))
    trigger.asked(0.0)
    assert at(trigger, 1.0).held_by == "cooldown"
    assert at(trigger, 6.0).fired
    assert at(trigger, 6.0, pending=True).held_by == "pending"


def test_without_a_goal_or_with_a_failing_planner_it_asks_whatever_the_function_says():
    trigger = FunctionTrigger(lambda now: False, TriggerCfg(max_failures=1))
    assert at(trigger, 0.0, target=None).cause == "first"
    trigger.planner(ok=False)
    assert at(trigger, 0.1).cause == "failure"


def test_the_function_sees_the_time_since_the_last_question():
    seen = []
    trigger = FunctionTrigger(lambda now: seen.append(now.since_asked_s) or False)
    at(trigger, 1.0)
    trigger.asked(2.0)
    at(trigger, 5.0)
    assert seen == [float("inf"), 3.0]


def test_a_text_becomes_a_refusal_and_none_passes():
    verify = find_verifier(lambda question, answer: "too deep" if answer > 3 else None)
    assert verify(None, 4) == Rejection(code="own", reason="too deep")
    assert verify(None, 3) is None


def test_a_rejection_keeps_its_code():
    mine = Rejection(code="mine", reason="no")
    assert find_verifier(lambda question, answer: mine)(None, 0) is mine


@pytest.mark.parametrize("find", [find_trigger, find_verifier])
@pytest.mark.parametrize("given", ["no-such-part", 3])
def test_what_is_no_function_is_refused(find, given):
    assert find(None) is None
    with pytest.raises(InputError, match=f"--{find.__name__.removeprefix('find_')}: found"):
        find(given)
