import functools
import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from coral.contact.scene.observation import BodyState, Observation
from coral.contact.thinker.diagnosis import TEXTS

spec = importlib.util.spec_from_file_location(
    "contact_planted", Path(__file__).parents[2] / "benchmarks" / "contact_planted.py"
)
planted = importlib.util.module_from_spec(spec)
sys.modules[spec.name] = planted  # dataclasses look their module up
spec.loader.exec_module(planted)


@functools.cache
def rules_plan(task):
    """The plan that a fault is planted in, and the object."""
    trial = planted.sample_trial(planted.load_task(task), 3)
    first, beliefs = planted.HandWorld(trial, planted.HandWorldCfg()).reset(), planted.stated_beliefs(trial)
    return planted.compose(planted.scene_facts(trial, first, beliefs)).plan, next(iter(trial.objects))


@pytest.mark.parametrize("kind", planted.FAULTS)
def test_every_kind_changes_something_and_is_described_by_a_diagnosis(kind):
    fault = planted.FAULTS[kind]
    assert set(fault.right) <= set(TEXTS)
    plan, name = rules_plan(fault.task)
    world = (fault.mass, fault.friction, fault.shift_m, fault.turn_rad) != (1.0, 1.0, (0.0, 0.0, 0.0), 0.0)
    assert world or fault.plan(plan, name) != plan


def test_a_wrong_pose_shifts_and_turns_what_is_observed():
    body = BodyState(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    seen = planted.misplaced(Observation(0.0, body, 0.08, np.zeros(6), {"box": body}), planted.FAULTS["pose turned"])
    np.testing.assert_allclose(seen.objects["box"].position, [0.011, 0.0, 0.0])
    np.testing.assert_allclose(seen.objects["box"].quaternion, [np.cos(0.34), 0.0, 0.0, np.sin(0.34)])
    np.testing.assert_array_equal(seen.tool.position, body.position)


def test_the_summary_counts_what_did_not_succeed_and_blames_of_right_poses():
    sign, shifted = planted.FAULTS["wrong sign"], planted.FAULTS["pose shifted"]
    told = [(sign, "led-away", 4.0), (sign, "pose-wrong", 6.0), (shifted, "pose-wrong", 9.0), (shifted, "", 20.0)]
    results = [(fault, planted.PlantedResult(word, False, time_s)) for fault, word, time_s in told]
    lines = planted.summary([*results, (sign, planted.PlantedResult("", True, 3.0))])
    assert lines[0].startswith("right: 2 of 4 (50 %)")
    assert lines[1:] == [
        "always saying led-away: 2 of 4 (50 %)",
        "a pose blamed that was right: 1 of 2 (50 %)",
        "the end of a stage blamed that was right: 0 of 4 (0 %)",
        "noticed after 4.0 to 9.0 s, median 6.0 s",
    ]
