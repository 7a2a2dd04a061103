"""Tasks of force: what the instruction asks for passes, and what comes near to it does not."""

import pytest
from judged_trial import JudgedTrial, at_rest, slid, still, touches

from coral.contact.scene.observation import BodyState
from coral.contact.scene.task_names import suite_tasks

EDGE = (0.0, 0.02)
"""A point of the step's edge."""


@pytest.mark.parametrize(
    ("how", "succeeds"),
    [
        ({}, True),
        ({"force": 12.0}, False),  # what a stiff hand presses with on a surface higher than it knows
        ({"force": 4.0}, False),
        ({"down": 15.0}, False),  # right on the step, too hard below it
        ({"blow": 45.0}, False),
        ({"below": ("hand",)}, False),  # lifted down
        ({"to": (0.03, 0.0)}, False),
        ({"end": ("table", "hand")}, False),
    ],
)
def test_wipe_over_step(how, succeeds):
    one = JudgedTrial("wipe-over-step")
    given = {"force": 8.0, "below": ("hand", "table"), "to": (0.08, -0.06), "end": ("table",)} | how
    above = slid(one, EDGE, ("hand",), given["force"])
    last = above[-1][0]
    if "blow" in given:
        above += [(last, touches("sponge", "hand"), given["blow"])] * 3
    one.start = BodyState(last.position - [0.0, 0.0, 0.008], last.quaternion)
    below = slid(one, given["to"], given["below"], given.get("down", given["force"]))
    assert one.succeeds([*above, *below, *still(at_rest(below[-1][0]), touches("sponge", *given["end"]))]) is succeeds


def test_every_task_has_a_near_miss():
    assert suite_tasks("force") == ("wipe-over-step",)
