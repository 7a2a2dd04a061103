import pytest

from coral.errors import InputError
from coral.reef.decide.own_trigger import FunctionTrigger, trigger_maker
from coral.reef.decide.trigger import SmartTrigger, TriggerCfg


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


def test_a_class_is_made_with_the_configuration_and_a_function_is_wrapped():
    assert isinstance(trigger_maker(SmartTrigger)(TriggerCfg()), SmartTrigger)
    assert isinstance(trigger_maker(lambda now: True)(TriggerCfg()), FunctionTrigger)


@pytest.mark.parametrize("trigger", ["no-such-trigger", 3])
def test_what_is_no_trigger_is_refused(trigger):
    with pytest.raises(InputError, match="--trigger: found"):
        trigger_maker(trigger)
