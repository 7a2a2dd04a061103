import importlib.util
import sys
from pathlib import Path

import numpy as np

from coral.contact.plan.cost_plan import PlanAnswer, StageAnswer
from coral.contact.scene.observation import BodyState, Observation
from coral.contact.thinker.diagnosis import TEXTS

spec = importlib.util.spec_from_file_location(
    "contact_planted", Path(__file__).parents[2] / "benchmarks" / "contact_planted.py"
)
planted = importlib.util.module_from_spec(spec)
sys.modules[spec.name] = planted  # dataclasses look their module up
spec.loader.exec_module(planted)

PLAN = PlanAnswer(
    stages=[
        StageAnswer(name="reach", code="x", done="norm(self.ee_pos) < 0.02"),
        StageAnswer(name="close", code="y", done="self.box_pos[2] > 0.1"),
        StageAnswer(name="lift", code="20 * self.gripper_target"),
    ]
)


def test_every_kind_changes_something_and_is_described_by_a_diagnosis():
    assert len(planted.FAULTS) >= 12
    for fault in planted.FAULTS.values():
        assert set(fault.right) <= set(TEXTS)
        world = (fault.mass, fault.friction, fault.shift_m, fault.turn_rad) != (1.0, 1.0, (0.0, 0.0, 0.0), 0.0)
        assert world or fault.plan(PLAN, "box") != PLAN


def test_a_wrong_pose_shifts_and_turns_what_is_observed():
    body = BodyState(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    seen = planted.misplaced(Observation(0.0, body, 0.08, np.zeros(6), {"box": body}), planted.FAULTS["pose turned"])
    np.testing.assert_allclose(seen.objects["box"].position, [0.011, 0.0, 0.0])
    np.testing.assert_allclose(seen.objects["box"].quaternion, [np.cos(0.34), 0.0, 0.0, np.sin(0.34)])
    np.testing.assert_array_equal(seen.tool.position, body.position)
