"""Each cost term against values computed by hand."""

import math
from dataclasses import fields

import numpy as np
import pytest

from coral.reef.drive.cost_terms import (
    COSTS,
    GOAL,
    HEADING,
    OBSTACLE,
    PATH,
    SMOOTH,
    SPEED,
    CostCfg,
    Scales,
    Step,
    add_step,
    finish,
)

SCALES = Scales(soft_m=0.4, body_m=0.3, reach_m=3.0, speed_m_s=0.6, yaw_rate_rad_s=0.6)


def terms(*steps, driven_m=0.0, now=5.0):
    sums = np.zeros(len(COSTS))
    for step in steps:
        add_step(sums, step, SCALES)
    finish(sums, sum(step.dt for step in steps), len(steps), driven_m, steps[-1].value, now, SCALES)
    return sums


def step(dt=1.0, speed=0.6, heading=0.0, value=5.0, gradient=(-1.0, 0.0), nearest=9.0, change=0.0):
    return Step(dt, speed, math.cos(heading), math.sin(heading), value, *gradient, nearest, change)


def test_full_speed_down_the_cost_to_go_costs_nothing_but_counts_as_progress():
    found = terms(step(value=4.4), step(value=3.8), driven_m=1.2)
    assert found[GOAL] == pytest.approx((0.5 * (3.8 + 4.1) - 5.0) / 3.0)
    assert found[[OBSTACLE, SPEED, PATH, HEADING, SMOOTH]] == pytest.approx(np.zeros(5), abs=1e-12)


def test_each_term_measures_one_thing():
    assert terms(step(nearest=0.5))[OBSTACLE] == pytest.approx(0.25)
    assert terms(step(nearest=0.5, dt=3.0), step())[OBSTACLE] == pytest.approx(0.75 * 0.25)
    assert terms(step(speed=0.15))[SPEED] == pytest.approx(0.75)
    assert terms(step(speed=-0.3))[SPEED] == pytest.approx(1.0)
    assert terms(step(heading=math.pi))[HEADING] == pytest.approx(1.0)
    assert terms(step(heading=math.pi / 2, gradient=(0.0, 0.0)))[HEADING] == 0.0
    assert terms(step(value=4.4), driven_m=1.5)[PATH] == pytest.approx(0.9 / 3.0)
    assert terms(step(change=0.5), step(change=0.1))[SMOOTH] == pytest.approx(0.3)


def test_within_a_metre_of_the_goal_speed_and_heading_fade():
    assert terms(step(speed=0.0, heading=math.pi, value=0.25))[[SPEED, HEADING]] == pytest.approx([0.25, 0.25])


def test_every_term_has_a_weight_and_an_index():
    assert list(range(len(COSTS))) == [GOAL, OBSTACLE, SPEED, PATH, HEADING, SMOOTH]
    assert [field.name for field in fields(CostCfg)][: len(COSTS)] == list(COSTS)
    assert CostCfg(path=0.7).weights[PATH] == 0.7
