import numpy as np
import pytest

from coral.contact.plan.contact_regions import RegionsAnswer
from coral.contact.plan.convex_pieces import box
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.touchable_points import Scenery

TOP = {"center": [0, 0, 0.03], "normal": [0, 0, 1]}


def facts(size=(0.06, 0.06, 0.06), at=(0.0, 0.0, 0.03), **more):
    item = {
        "size_m": list(size),
        "pose": [*at, 1, 0, 0, 0],
        "shapes": ["box"],
        "solid_share": 1.0,
        "points": {},
        **more,
    }
    return {"objects": {"box": item}, "fixtures": {}, "table": {"x": [-0.4, 0.4], "y": [-0.4, 0.4]}}


def answer(*regions, name="box"):
    return RegionsAnswer.model_validate({name: {"regions": list(regions)}})


def verified(answer, facts, stages=()):
    """The verdict on regions of objects that are their bounding boxes."""
    middles = {name: np.array(item.get("middle_m", [0.0] * 3)) for name, item in facts["objects"].items()}
    boxes = {name: (box(np.array(facts["objects"][name]["size_m"]), middles[name]),) for name in middles}
    return verify_regions(answer, facts, stages, Scenery(boxes))


def test_a_sound_region_passes():
    assert verified(answer(TOP), facts()) is None


@pytest.mark.parametrize(
    ("region", "code"),
    [
        ({**TOP, "center": [0, 0, 0.06]}, "off-surface"),
        ({**TOP, "center": [0, 0, 0.0]}, "off-surface"),
        ({**TOP, "normal": [0, 0, 2]}, "normal"),
        ({**TOP, "normal": [0, 0, -1]}, "inward"),
        ({"center": [0, 0, -0.03], "normal": [0, 0, -1]}, "underside"),
        ({**TOP, "extent": 0.5}, "extent"),
        ({**TOP, "num_samples": 0}, "extent"),
        ({**TOP, "stage": "fly"}, "stage"),
        ({**TOP, "opening": 0.2}, "opening"),
    ],
)
def test_unusable_regions_are_refused_by_name(region, code):
    found = verified(answer(region), facts(), ["reach"])
    assert found.code == code
    assert "region 1 of box" in found.reason


def test_what_is_wider_than_the_hand_opens_is_not_pinched():
    found = verified(
        answer({"center": [0, 0, 0.03], "normal": [0, 0, 1], "approach": "pinch"}), facts(size=(0.1, 0.1, 0.06))
    )
    assert found.code == "too-wide"


def test_an_unknown_object_and_an_empty_answer_are_refused():
    assert verified(answer(TOP, name="cup"), facts()).code == "objects"
    assert verified(answer(), facts()).code == "none"


SIDE = {"center": [0.03, 0, 0], "normal": [1, 0, 0], "approach": "push"}


def test_a_wide_disc_on_a_small_face_keeps_what_lies_on_it():
    assert verified(answer({**TOP, "extent": 0.15, "num_samples": 64}), facts()) is None


def test_a_disc_of_which_no_point_lies_on_the_face_is_refused():
    beside = {"center": [0.034, 0, 0.03], "normal": [0, 0, 1], "extent": 0.002}
    found = verified(answer(beside), facts())
    assert found.code == "missed"
    assert "none of its 9 candidate points can be touched: 9 off the face" in found.reason


def test_what_another_thing_covers_is_refused_by_its_name():
    wall = {"wall": {"position": [0.08, 0, 0.1], "size_m": [0.1, 0.4, 0.2], "yaw_deg": 0.0}}
    found = verified(answer(SIDE), {**facts(), "fixtures": wall})
    assert found.code == "buried"
    assert "before wall" in found.reason
    away = {"wall": {**wall["wall"], "position": [0.2, 0, 0.1]}}
    assert verified(answer(SIDE), {**facts(), "fixtures": away}) is None


def test_another_object_in_the_way_counts_until_it_is_touched_before():
    scene = facts()
    scene["objects"]["cup"] = {**scene["objects"]["box"], "pose": [0.065, 0, 0.03, 1, 0, 0, 0]}
    assert verified(answer(SIDE), scene).code == "buried"
    both = RegionsAnswer.model_validate(
        {"cup": {"regions": [{**TOP, "stage": "clear"}]}, "box": {"regions": [{**SIDE, "stage": "push"}]}}
    )
    assert verified(both, scene, ["clear", "push"]) is None
    assert verified(both, scene, ["push", "clear"]).code == "buried"


def test_by_a_later_stage_the_object_itself_may_have_been_moved():
    wall = {"wall": {"position": [0.08, 0, 0.1], "size_m": [0.1, 0.4, 0.2], "yaw_deg": 0.0}}
    regions = answer({**TOP, "stage": "press"}, {**SIDE, "stage": "push"})
    assert verified(regions, {**facts(), "fixtures": wall}, ["press", "push"]) is None


def test_what_the_hand_cannot_get_to_is_refused_with_its_bounds():
    found = verified(answer(TOP), {**facts(at=(0.6, 0, 0.03)), "table": {"x": [-1, 1], "y": [-1, 1]}})
    assert found.code == "out-of-reach"
    assert "[-0.350, -0.450, -0.150] to [0.400, 0.500, 0.600]" in found.reason
