"""How far a plan came in its rehearsal."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from coral.contact.plan.imagined_outcome import ImaginedOutcome, imagined_outcome, imagined_truth
from coral.contact.plan.imagined_run import ImaginedMoment
from coral.contact.scene.observation import BodyState, Observation

NAMES = ["reach", "close", "lift"]


def moment(one, time_s, stage, height_m=0.0, touching=()):
    box = one.now.objects["box"]
    raised = BodyState(box.position + np.array([0, 0, height_m]), box.quaternion)
    now = Observation(time_s, one.now.tool, one.now.opening_m, one.now.wrench, {"box": raised})
    state = {f"box_{part}_contact": np.full((1, 1), part in touching) for part in ("hand", "left", "right", "table")}
    return ImaginedMoment(now, stage, stage, SimpleNamespace(now=state))


def test_without_any_moment_nothing_was_reached(scene):
    assert imagined_outcome(scene("pick-box").trial, [], NAMES) == ImaginedOutcome(False, 0.0, 0.0, 0.0)


def test_the_farthest_stage_and_the_time_after_it_count(scene):
    one = scene("pick-box")
    stages = ["reach", "reach", "close", "reach"]
    moments = [moment(one, 0.1 * k, stage, touching=("table",)) for k, stage in enumerate(stages)]
    found = imagined_outcome(one.trial, moments, NAMES)
    assert (found.succeeded, found.stages, found.conditions) == (False, pytest.approx(2 / 3), 0.5)  # upright and still
    assert found.spare_s == pytest.approx(0.1)


def test_a_box_held_up_long_enough_is_a_success(scene):
    one = scene("pick-box")
    moments = [moment(one, 0.1 * k, "lift", 0.12, ("hand", "left", "right")) for k in range(10)]
    found = imagined_outcome(one.trial, moments, NAMES)
    assert (found.succeeded, found.stages) == (True, 1.0)
    assert found.spare_s == pytest.approx(0.4)
    let_go = [moment(one, 0.1 * k, "lift", 0.12, ("hand", "left")) for k in range(10)]
    assert not imagined_outcome(one.trial, let_go, NAMES).succeeded


def test_imagined_contacts_are_those_of_the_planning_world(scene):
    one = scene("pick-box")
    truth = imagined_truth(one.trial, moment(one, 0.3, "lift", touching=("left", "table")))
    assert [(each.first, each.second) for each in truth.contacts] == [("box", "left"), ("box", "table")]
    assert truth.time_s == 0.3


def test_success_comes_before_stages_stages_before_conditions_and_these_before_time():
    order = [
        ImaginedOutcome(False, 0.3, 0.9, 5.0),
        ImaginedOutcome(False, 0.6, 0.2, 1.0),
        ImaginedOutcome(False, 0.6, 0.4, 0.5),
        ImaginedOutcome(False, 0.6, 0.4, 0.7),
        ImaginedOutcome(True, 1.0, 1.0, 0.1),
    ]
    assert all(worse < better for worse, better in pairwise(order))
