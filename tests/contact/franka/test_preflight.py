"""The list before an arm may move."""

import dataclasses

import numpy as np
import pytest
from arms import arm_state

from coral.check_line import blocking, list_text
from coral.contact.franka.preflight import MARKS, preflight_arm
from coral.contact.franka.stream import StreamReport
from coral.contact.scene.observation import BodyState
from coral.contact.worlds.franka_cfg import FrankaCfg

BOX = BodyState(np.array([0.1, 0.0, 0.03]), np.array([1.0, 0, 0, 0]))
GOOD = StreamReport(state=arm_state(7.0), objects={"box": BOX}, ages_s={"box": 0.01})


def wrong(**changes):
    checks = preflight_arm(dataclasses.replace(GOOD, **changes), FrankaCfg(), ("box",))
    return [line.subject for line in blocking(checks)]


def test_all_is_in_order():
    assert wrong() == []


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"state": None}, "the arm sends its state"),
        ({"state": arm_state(7.0, joint_speeds=np.full(7, 0.1))}, "the arm is at rest"),
        ({"state": arm_state(7.0, joints=np.array([0.0, -1.75, 0.0, -2.3, 0.0, 2.2, 0.7]))}, "within all limits"),
        ({"wrench": np.array([0.0, 0, 31.0, 0, 0, 0])}, "nothing pulls at the hand"),
        ({"objects": {}, "ages_s": {}}, "box is seen within reach"),
        ({"ages_s": {"box": 1.0}}, "box is seen within reach"),
        ({"objects": {"box": dataclasses.replace(BOX, position=np.array([0.6, 0, 0]))}}, "box is seen within reach"),
    ],
)
def test_a_line_that_is_not_in_order_is_named(changes, name):
    assert wrong(**changes) == [name]


def test_the_list_reads_well():
    lines = list_text(preflight_arm(GOOD, FrankaCfg(), ("box",)), MARKS).splitlines()
    assert lines[-1] == "ok   box is seen within reach: at +0.100 +0.000 +0.030 m"
