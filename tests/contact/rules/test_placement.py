import numpy as np
import pytest
from written_facts import brick, fixture, written

from coral.contact.rules.goals import NoRule
from coral.contact.rules.placement import CLEAR_M, placement_of
from coral.contact.rules.scene_reading import Thing

SHELF = {"shelf": fixture([0.2, 0.1, 0.08], [0.1, 0.2, 0.04])}
TURNED = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
"""By 90 degrees about z."""


def at(**more):
    return {"object": "brick", "kind": "at", "place": "there", "tolerance_m": 0.03, "axes": "xy", "point": None, **more}


def inside(name="brick", low=(-0.1, 0.0, 0.0), high=(0.1, 0.1, 0.1)):
    return {"object": name, "kind": "inside", "low": list(low), "high": list(high)}


def onto(thing):
    return {"object": "brick", "kind": "resting", "thing": thing}


def placed(goal, fixtures=None, others=None, goals=(), **item):
    """The placement of a brick of 6 x 4 x 2 cm."""
    objects = {"brick": brick(**item), **(others or {})}
    facts = written(objects, fixtures, {"there": [0.1, 0.15, 0.05]}, goals or [goal])
    return placement_of(Thing("brick", facts), facts, goal)


def test_where_the_height_is_not_asked_for_the_object_is_put_on_the_place():
    assert placed(at()).height_m == pytest.approx(0.05 + 0.01)
    assert placed(at(axes="xyz")).height_m == pytest.approx(0.05)
    assert placed(at()).where == "self.there_pos"


def test_it_is_lowered_nearer_over_a_place_of_small_tolerance():
    assert placed(at(tolerance_m=0.03)).near_m == pytest.approx(0.015)
    assert placed(at(tolerance_m=0.3)).near_m == pytest.approx(0.02)


def test_a_named_point_is_put_there_as_the_object_lies():
    found = placed(at(point="tip"), points={"tip": [0.03, 0.0, 0.0]}, quat=TURNED)
    np.testing.assert_allclose(found.shift, [0.0, 0.03, 0.0], atol=1e-9)


def test_in_a_region_it_is_let_go_in_the_middle_of_what_lies_below():
    found = placed(inside())
    assert found.where == "np.array([0, 0.05, 0])"
    assert found.height_m == pytest.approx(0.01)
    tray = {"tray": fixture([0.3, 0.3, 0.02], [0.0, 0.0, 0.01])}
    assert placed(inside(), tray).height_m == pytest.approx(0.03)


def test_objects_that_share_a_region_are_put_side_by_side_along_it():
    goals = [inside("cup"), inside("brick"), inside("can", high=(0.1, 0.1, 0.2))]
    others = {name: brick(at=(-0.3, y, 0.01)) for name, y in (("cup", -0.3), ("can", -0.2))}
    assert placed(inside(), others=others, goals=goals).where == "np.array([0.05, 0.05, 0])"


def test_the_palm_stays_over_what_is_near_the_place():
    post = {"post": fixture([0.02, 0.02, 0.2], [0.0, 0.15, 0.1])}
    found = placed(inside(), post)
    assert found.top_m == pytest.approx(0.2)
    assert found.palm_m == pytest.approx(0.2 + CLEAR_M)
    far = {"post": fixture([0.02, 0.02, 0.2], [0.0, 0.3, 0.1])}
    assert (placed(inside(), far).top_m, placed(inside(), far).palm_m) == (0.0, 0.0)


def test_on_top_of_a_fixture_it_is_put_in_the_middle_of_it():
    found = placed(onto("shelf"), SHELF)
    assert found.where == "np.array([0.1, 0.2, 0.08])"
    assert found.height_m == pytest.approx(0.09)
    assert found.near_m == pytest.approx(0.02)
    narrow = {"shelf": fixture([0.2, 0.04, 0.08], [0.1, 0.2, 0.04])}
    assert placed(onto("shelf"), narrow).near_m == pytest.approx(0.008)


def test_on_top_of_another_object_it_follows_that_object():
    base = {"base": brick(size=(0.1, 0.1, 0.06), at=(0.1, 0.2, 0.03), middle_m=[0.02, 0.0, 0.0])}
    found = placed(onto("base"), others=base)
    assert found.where == "(self.base_pos + np.array([0.02, 0, 0]))"
    assert found.height_m == pytest.approx(0.06 + 0.01)


@pytest.mark.parametrize(
    ("goal", "fixtures", "words"),
    [
        (onto("table"), None, "no goal says where on the table the brick is to be put"),
        (inside(low=(1.0, 1.0, 0.0), high=(1.2, 1.2, 0.2)), None, "nothing is there for the brick to lie on"),
        (inside(low=(-0.1, 0.0, 0.2), high=(0.1, 0.1, 0.3)), None, "comes to rest at a height of 0.010 m"),
        (onto("shelf"), {"shelf": fixture([0.2, 0.1, 0.5], [0.1, 0.2, 0.25])}, "carried over a height of 0.50 m"),
    ],
)
def test_where_nothing_can_come_to_rest_there_is_no_placement(goal, fixtures, words):
    with pytest.raises(NoRule, match=words):
        placed(goal, fixtures)


def test_a_ring_has_no_top_in_its_middle():
    parts = [{"size_m": [0.02, 0.1, 0.02], "position": [x, 0.0, 0.0]} for x in (-0.04, 0.04)]
    ring = {"ring": brick(size=(0.1, 0.1, 0.02), at=(0.1, 0.2, 0.01), parts=parts)}
    with pytest.raises(NoRule, match="the ring has no top in its middle to put the brick on"):
        placed(onto("ring"), others=ring)
