import numpy as np
import pytest
from skills import Skill, bricks

from coral.contact.rules.scene_reading import SkillAdjustment, Thing
from coral.contact.rules.skill_pivot import add_pivot, nearest_face

FLAT = [("brick", (0.12, 0.08, 0.04), (0.0, 0.0))]
WALL = {"name": "wall", "size": [0.02, 0.4, 0.2], "position": [0.2, 0.0, 0.1]}


def fixture(x, y, yaw_deg=0.0, size=(0.02, 0.4, 0.2)):
    return {"position": [x, y, 0.1], "size_m": list(size), "yaw_deg": yaw_deg}


@pytest.mark.parametrize(
    ("item", "point", "way"),
    [
        (fixture(0.2, 0.0), (0.19, 0.0), (1.0, 0.0)),
        (fixture(0.2, 0.1, size=(0.1, 0.1, 0.2)), (0.2, 0.05), (0.0, 1.0)),
        (fixture(-0.3, 0.0), (-0.29, 0.0), (-1.0, 0.0)),
        (fixture(0.0, 0.2, 90.0), (0.0, 0.19), (0.0, 1.0)),
        (fixture(0.2, 0.2, 45.0, (0.1, 0.1, 0.2)), (0.2 - 0.05 * np.sqrt(0.5),) * 2, (np.sqrt(0.5),) * 2),
    ],
)
def test_the_nearest_face_looks_at_the_object(scene, item, point, way):
    found, into = nearest_face(Thing("brick", scene(bricks(*FLAT)).facts), item)
    np.testing.assert_allclose(found, point, atol=1e-9)
    np.testing.assert_allclose(into, way, atol=1e-9)


def test_inside_a_fixture_there_is_no_face_and_some_way_is_taken(scene):
    found, into = nearest_face(Thing("brick", scene(bricks(*FLAT)).facts), fixture(0.0, 0.0, size=(1.0, 1.0, 0.2)))
    np.testing.assert_allclose(found, [0.0, 0.0])
    np.testing.assert_allclose(into, [1.0, 0.0])


@pytest.fixture
def pivot(scene):
    return Skill(scene(bricks(*FLAT, fixtures=[WALL])), add_pivot, "wall")


def standing(degrees):
    """Its far end stays down at the wall, its near end is raised."""
    half = np.radians(degrees) / 2
    return [np.cos(half), 0.0, np.sin(half), 0.0]


def test_it_is_touched_low_on_the_side_away_from_the_wall(pivot):
    assert [region.stage for region in pivot.regions] == ["reach", "push"]
    assert [region.normal for region in pivot.regions] == [(-1.0, 0.0, 0.0)] * 2
    assert pivot.regions[1].center[2] == pytest.approx(-0.8 * 0.02)


def test_pushing_is_done_at_the_wall_and_not_before(pivot):
    assert not pivot.done("push", brick_pos=[0.1, 0.0, 0.02])
    assert pivot.done("push", brick_pos=[0.19 - 0.06 - 0.004, 0.0, 0.02])


def test_raising_its_near_end_costs_less_until_it_stands(pivot):
    costs = [pivot.terms("raise", brick_quat=standing(degrees))["raise"] for degrees in (0, 30, 60, 90)]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] == pytest.approx(0.0, abs=1e-6)
    assert [pivot.done("raise", brick_quat=standing(degrees)) for degrees in (60, 88)] == [False, True]
    assert pivot.terms("raise", brick_quat=standing(-90))["raise"] > costs[0]


def test_a_repair_that_presses_harder_asks_for_more_force(scene):
    one = scene(bricks(*FLAT, fixtures=[WALL]))
    first, harder = (Skill(one, add_pivot, "wall", adjustment=SkillAdjustment(press=by)) for by in (1.0, 2.0))
    force = [skill.terms("raise", brick_hand_force=[12.0, 0.0, 0.0])["press"] for skill in (first, harder)]
    assert force == pytest.approx([0.3, 0.0], abs=0.01)


def test_one_that_falls_back_is_raised_again(pivot):
    stage = pivot.stage("let go")
    assert stage.back_to == "reach"
    assert pivot.terms("let go", brick_quat=standing(90))["leave standing"] < 1e-6
    assert pivot.terms("let go", brick_quat=standing(20))["leave standing"] > 4.0
