from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.control.reactive import Reactive, ReactiveCfg
from coral.contact.episode.plan_under_way import PlanUnderWay
from coral.contact.scene.observation import BodyState, HandTarget, Observation

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
