import threading
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.control.reactive import Reactive, ReactiveCfg
from coral.contact.episode.late_plans import Meanwhile, PlanLatency, PlanUnderWay
from coral.contact.scene.observation import BodyState, HandTarget, Observation
from coral.errors import InputError

LEVEL = np.array([1.0, 0, 0, 0])


def seen(x):
    return Observation(0.0, BodyState(np.array([x, 0.0, 0.2]), LEVEL), 0.04, np.zeros(6), {})


def plan(steps=4):
    """Moves by 1 cm a step from x = 0.1."""
    where = np.array([[0.1 + 0.01 * (k + 1), 0.0, 0.2] for k in range(steps)])
    return SimpleNamespace(
        targets=tuple(HandTarget(place, LEVEL, 0.04, 600.0) for place in where),
        expected_position=where,
        expected_force=np.zeros((steps, 3)),
    )


def feedback():
    return Reactive(ReactiveCfg(), 0.02, np.full(3, -1.0), np.full(3, 1.0))


def test_the_last_target_stays_when_the_plan_is_at_its_end():
    under_way = PlanUnderWay(plan())
    under_way.next = 2
    assert [round(float(target.position[0]), 6) for target in under_way.coming(4)] == [0.13, 0.14, 0.14, 0.14]


def test_errors_count_from_where_the_plan_began():
    """The tool was 3 cm off the prediction when the plan began, and goes on as planned."""
    under_way, reactive = PlanUnderWay.beginning(plan(), 0, seen(0.1), seen(0.13)), feedback()
    under_way.compare(0, seen(0.14), reactive)
    assert reactive.position_error == pytest.approx(np.zeros(3), abs=1e-12)
    under_way.compare(1, seen(0.145), reactive)
    assert reactive.position_error == pytest.approx([0.005, 0, 0], abs=1e-12)


def test_a_late_plan_is_used_from_where_it_still_holds():
    under_way, reactive = PlanUnderWay.beginning(plan(), 2, seen(0.1), seen(0.12)), feedback()
    assert under_way.next == 2
    assert float(under_way.coming(1)[0].position[0]) == pytest.approx(0.13)
    under_way.compare(2, seen(0.125), reactive)
    assert reactive.position_error == pytest.approx([0.005, 0, 0], abs=1e-12)


def test_a_robot_that_outruns_a_plan_goes_on_at_its_end():
    now = seen(0.15)
    under_way = PlanUnderWay.beginning(plan(), 12, seen(0.1), now)
    assert under_way.moved == pytest.approx([0.01, 0.0, 0.0])


def test_a_fixed_latency_passes_in_whole_control_steps_whatever_the_machine():
    latency = PlanLatency("fixed:0.11", 0.02, 2, 50)
    assert latency.charged
    assert latency.expected_steps() == latency.taken_steps(9.0) == 6
    assert PlanLatency("fixed:0.01", 0.02, 2, 50).expected_steps() == 2  # no sooner than plans are asked for


def test_without_latency_nothing_is_charged():
    assert not PlanLatency("0", 0.02, 2, 50).charged
    assert not PlanLatency("fixed:0", 0.02, 2, 50).charged


def test_a_measured_latency_is_expected_from_the_plans_before():
    latency = PlanLatency("measured", 0.02, 2, 50)
    assert latency.charged
    assert latency.expected_steps() == 2
    assert [latency.taken_steps(seconds) for seconds in (0.1, 0.1, 0.5)] == [5, 5, 25]
    assert latency.expected_steps() == 6  # a tenth above the median
    assert latency.taken_steps(60.0) == 49  # something of the plan is left


@pytest.mark.parametrize("spec", ["soon", "fixed:", "recorded", "fixed:-1", "fixed:nan", "fixed:1.0", "measured:1"])
def test_other_texts_and_latencies_as_long_as_a_plan_are_refused(spec):
    with pytest.raises(InputError, match=r"planning\.latency"):
        PlanLatency(spec, 0.02, 2, 50)


def test_steps_are_taken_until_the_block_ends():
    three = threading.Event()
    taken = []

    def step():
        taken.append(1)
        if len(taken) >= 3:
            three.set()
        return True

    meanwhile = Meanwhile(step)
    with meanwhile:
        assert three.wait(10.0)
    assert meanwhile.steps == len(taken) >= 3
    with meanwhile:
        pass
    assert meanwhile.steps <= len(taken) - 3


def test_a_step_that_says_so_is_the_last():
    ended, taken = threading.Event(), []

    def step():
        taken.append(1)
        ended.set()
        return False

    meanwhile = Meanwhile(step)
    with meanwhile:
        assert ended.wait(10.0)
    assert len(taken) == 1
    assert meanwhile.steps == 0


def test_what_a_step_raises_is_raised_at_the_end_of_the_block():
    raised = threading.Event()

    def step():
        raised.set()
        raise ValueError("no arm")

    with pytest.raises(ValueError, match="no arm"), Meanwhile(step):
        assert raised.wait(10.0)


def test_an_error_of_the_block_takes_precedence():
    def step():
        raise ValueError("no arm")

    with pytest.raises(KeyError, match="plan"), Meanwhile(step):
        raise KeyError("plan")
