"""Conditions on two things, judged on worlds made by hand."""

import numpy as np
import pytest
from contact_bench import body, make_trial, plain, truth, written

from coral.contact.scene.trial import move_joint
from coral.errors import InputError

BOX = plain()["objects"][0]
LID = BOX | {"name": "lid", "x": 0.2, "z": 0.1, "points": {"mouth": [0, 0, 0.03]}}
HINGED = LID | {"joint": {"kind": "hinge", "axis": [0, 1, 0], "point": [0.03, 0, 0], "range": [-10, 120], "start": 30}}
SLIDING = LID | {"joint": {"kind": "slide", "axis": [1, 0, 0], "range": [-0.2, 0]}}


def watch(condition, lid=LID):
    trial = make_trial(condition, objects=[BOX, lid])
    return trial, trial.task.success.conditions[0].monitor(trial)


@pytest.mark.parametrize(
    ("box", "lid", "options", "holds"),
    [
        ((0.2, 0, 0.16), {}, {}, True),
        ((0.2, 0.011, 0.16), {}, {}, False),
        ((0.2, 0, 0.16), {"axes": "xyz"}, {}, False),
        ((0.2, 0, 0.16), {"axes": "xyz", "offset": (0, 0, 0.06)}, {}, True),
        ((0.3, 0, 0.1), {"offset": (0, -0.1, 0)}, {"rpy_deg": (0, 0, 90)}, True),  # in the other's frame
        ((0.3, 0, 0.1), {"offset": (0.1, 0, 0)}, {"rpy_deg": (0, 0, 90)}, False),
        ((0.2, 0, 0.16), {"tolerance_deg": 5}, {"rpy_deg": (0, 10, 0)}, False),
        ((0.17, -0.03, 0.13), {"point": "corner", "other_point": "mouth"}, {}, True),
    ],
)
def test_at_object(box, lid, options, holds):
    _, judge = watch({"kind": "at-object", "other": "lid", "tolerance_m": 0.01} | lid)
    assert judge(truth(0, body(box), lid=body((0.2, 0, 0.1), **options))) is holds


@pytest.mark.parametrize(
    ("point", "turned", "holds"),
    [
        ((0.2, 0, 0.09), 0, True),  # 4 cm below the mouth
        ((0.2, 0, 0.101), 0, False),
        ((0.2, 0.021, 0.09), 0, False),
        ((0.16, 0, 0.1), 90, True),  # the mouth looks along x
        ((0.24, 0, 0.1), 90, False),
    ],
)
def test_inserted(point, turned, holds):
    condition = {"kind": "inserted", "point": "corner", "other": "lid", "other_point": "mouth", "depth_m": 0.03}
    _, judge = watch(condition)
    at = np.array(point) - [0.03, 0.03, 0.03]
    assert judge(truth(0, body(at), lid=body((0.2, 0, 0.1), (0, turned, 0)))) is holds


def test_inserted_at_a_place_of_the_task():
    _, judge = watch({"kind": "inserted", "point": "corner", "place": "goal", "into": "x", "depth_m": 0.03})
    assert judge(truth(0, body((0.102, -0.03, 0.0)), lid=body()))
    assert not judge(truth(0, body((0.098, -0.03, 0.0)), lid=body()))


@pytest.mark.parametrize(
    ("lid", "by", "options", "holds"),
    [
        (HINGED, 0, {"between_deg": (29, 31)}, True),
        (HINGED, 15, {"between_deg": (29, 31)}, False),
        (HINGED, 15, {"between_deg": (44, 46)}, True),
        (SLIDING, -0.1, {"between_m": (-0.2, -0.09)}, True),
        (SLIDING, -0.08, {"between_m": (-0.2, -0.09)}, False),
    ],
)
def test_opened(lid, by, options, holds):
    trial, judge = watch({"kind": "opened", "object": "lid"} | options, lid)
    joint = trial.task.object("lid").joint
    moved = move_joint(joint, trial.objects["lid"].pose, np.radians(by) if joint.kind == "hinge" else by)
    assert judge(truth(0, None, lid=moved)) is holds


@pytest.mark.parametrize(
    ("condition", "field", "expected"),
    [
        ({"kind": "at", "place": "lid", "tolerance_m": 0.1}, ".place", "at-object"),
        ({"kind": "at-object", "other": "box", "tolerance_m": 0.1}, ".other", "one of lid"),
        ({"kind": "at-object", "other": "lid", "other_point": "rim", "tolerance_m": 0.1}, ".other_point", "mouth"),
        ({"kind": "inserted", "point": "corner", "depth_m": 0.1}, "", "a place, or an other object"),
        ({"kind": "inserted", "point": "corner", "other": "lid", "depth_m": 0.1}, ".other_point", "the mouth"),
        (
            {"kind": "inserted", "point": "corner", "place": "goal", "other_point": "mouth", "depth_m": 0.1},
            ".other_point",
            "none",
        ),
        ({"kind": "opened", "between_deg": [0, 1]}, ".object", "an object with a joint"),
        ({"kind": "opened", "object": "lid", "between_m": [0, 1]}, ".between_m", "between_deg"),
        ({"kind": "opened", "object": "lid"}, ".between_m", "between_deg"),
        ({"kind": "resting", "object": "lid", "thing": "table"}, ".thing", "an object"),
    ],
)
def test_refuses(tmp_path, condition, field, expected):
    content = plain() | {"objects": [BOX, HINGED], "success": {"conditions": [{"object": "box"} | condition]}}
    with pytest.raises(InputError) as caught:
        written(tmp_path, content)
    assert caught.value.field == f"success.conditions[0]{field}"
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    ("condition", "lid", "found"),
    [
        ({"kind": "at-object", "other": "lid", "tolerance_m": 0.01}, LID, "5 cm, allowed 1 cm"),
        (
            {"kind": "at-object", "other": "lid", "tolerance_m": 0.01, "tolerance_deg": 5},
            LID,
            "5 cm, allowed 1 cm, and 0°, allowed 5°",
        ),
        ({"kind": "opened", "object": "lid", "between_deg": (60, 90)}, HINGED, "0°, allowed 60° to 90°"),
        ({"kind": "opened", "object": "lid", "between_m": (-0.2, -0.1)}, SLIDING, "0 cm, allowed -20 cm to -10 cm"),
    ],
)
def test_what_was_found_is_told_beside_what_is_allowed(condition, lid, found):
    trial, _ = watch(condition, lid)
    there = body((0.2, 0, 0.1))
    assert trial.task.success.conditions[0].found(trial, truth(0, body((0.2, 0.05, 0.1)), lid=there)) == found
