import pytest

from coral.reef.decide.trigger import SmartTrigger, TriggerCfg, separated

FAR = (50.0, 0.0)


def drive(trigger, seconds, *, speed=0.4, target=FAR, start=0.0, pending=False, move=True):
    """Firings while driving along x at 10 Hz, with their times."""
    fired = []
    for k in range(round(seconds * 10)):
        t = start + k / 10
        firing = trigger.update(t, speed * t if move else 0.0, 0.0, speed, target, pending)
        if firing:
            fired.append((t, firing))
    return fired


def test_the_first_question_is_asked_at_once():
    firing = SmartTrigger().update(0.0, 0.0, 0.0, 0.0, None, False)
    assert firing is not None
    assert (firing.cause, firing.fired) == ("first", True)


def test_distance_fires_inside_d_trig_only():
    trigger = SmartTrigger()
    assert trigger.update(10.0, 0.0, 0.0, 0.4, (2.51, 0.0), False) is None
    firing = trigger.update(10.1, 0.0, 0.0, 0.4, (2.49, 0.0), False)
    assert firing is not None
    assert firing.cause == "distance"


def test_cooldown_holds_the_next_question_back():
    trigger = SmartTrigger(TriggerCfg(cooldown_s=5.0))
    trigger.asked(10.0)
    held = trigger.update(14.9, 0.0, 0.0, 0.4, (1.0, 0.0), False)
    assert held is not None
    assert held.held_by == "cooldown"
    asked = trigger.update(15.0, 0.0, 0.0, 0.4, (1.0, 0.0), False)
    assert asked is not None
    assert asked.fired


def test_an_open_question_holds_back():
    firing = SmartTrigger().update(10.0, 0.0, 0.0, 0.4, (1.0, 0.0), True)
    assert firing is not None
    assert firing.held_by == "pending"


def test_stuck_needs_20_seconds_of_standing_and_bypasses_the_cooldown():
    trigger = SmartTrigger(TriggerCfg(cooldown_s=1000.0))
    trigger.asked(0.0)
    fired = drive(trigger, 25.0, speed=0.0, move=False)
    assert fired[0][0] == pytest.approx(20.0)
    assert (fired[0][1].cause, fired[0][1].fired) == ("stuck", True)


def test_slow_but_steady_progress_is_not_stuck():
    assert drive(SmartTrigger(), 40.0, speed=0.05) == []


def test_two_failures_in_a_row_fire_and_a_success_resets():
    trigger = SmartTrigger()
    trigger.planner(False)
    trigger.planner(True)
    trigger.planner(False)
    assert trigger.update(10.0, 0.0, 0.0, 0.4, FAR, False) is None
    trigger.planner(False)
    firing = trigger.update(10.1, 0.0, 0.0, 0.4, FAR, False)
    assert firing is not None
    assert firing.cause == "failure"


def test_a_hopeless_path_asks_for_another_goal():
    trigger = SmartTrigger()
    trigger.deviation()
    firing = trigger.update(10.0, 0.0, 0.0, 0.4, FAR, False)
    assert firing is not None
    assert firing.cause == "deviation"
    trigger.asked(10.0)
    assert trigger.update(30.0, 9.0, 0.0, 0.4, FAR, False) is None


def test_without_smart_trigger_every_cooldown_asks():
    trigger = SmartTrigger(TriggerCfg(always=True, cooldown_s=5.0))
    asked = []
    for k in range(200):
        firing = trigger.update(k / 10, 0.04 * k, 0.0, 0.4, FAR, False)
        if firing and firing.fired:
            asked.append(k / 10)
            trigger.asked(k / 10)
    assert asked == [0.0, 5.0, 10.0, 15.0]


def test_standing_still_for_a_slow_answer_is_not_being_stuck_afterwards():
    trigger = SmartTrigger()
    trigger.asked(0.0)
    assert drive(trigger, 25.0, speed=0.0, move=False, pending=True)[-1][1].held_by == "pending"
    trigger.new_goal()
    assert drive(trigger, 19.0, speed=0.0, move=False, start=25.0) == []


def test_minimum_separation():
    assert separated((1.0, 0.0), None, 1.0)
    assert separated((1.0, 0.0), (0.0, 0.0), 1.0)
    assert not separated((0.9, 0.0), (0.0, 0.0), 1.0)


def at(trigger, t, x=0.0, target=(9.0, 0.0), pending=False, speed=0.5):
    return trigger.update(t, x, 0.0, speed, target, pending, None)


def test_the_function_decides_and_its_cause_is_its_own():
    trigger = SmartTrigger(wanted=lambda now: now.x > 1.0)
    assert at(trigger, 0.0, x=0.5) is None
    firing = at(trigger, 0.1, x=1.5)
    assert (firing.cause, firing.fired) == ("own", True)


def test_the_cooldown_and_an_open_question_hold_it_back():
    trigger = SmartTrigger(TriggerCfg(cooldown_s=5.0), lambda now: True)
    trigger.asked(0.0)
    assert at(trigger, 1.0).held_by == "cooldown"
    assert at(trigger, 6.0).fired
    assert at(trigger, 6.0, pending=True).held_by == "pending"


def test_without_a_goal_or_with_a_failing_planner_it_asks_whatever_the_function_says():
    trigger = SmartTrigger(TriggerCfg(max_failures=1), lambda now: False)
    assert at(trigger, 0.0, target=None).cause == "first"
    trigger.planner(ok=False)
    assert at(trigger, 0.1).cause == "failure"


def test_the_function_sees_the_time_since_the_last_question():
    seen = []
    trigger = SmartTrigger(wanted=lambda now: seen.append(now.since_asked_s) or False)
    at(trigger, 1.0)
    trigger.asked(2.0)
    at(trigger, 5.0)
    assert seen == [float("inf"), 3.0]
