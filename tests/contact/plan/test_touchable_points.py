import numpy as np
import pytest

from coral.contact.plan.contact_regions import Region, RegionsAnswer, candidates, guide
from coral.contact.plan.region_validation import verify_regions
from coral.contact.plan.touchable_points import Scenery, candidates_of, off_surface, project
from coral.contact.scene.task import Task
from coral.contact.scene.trial import sample_trial


def thing(*parts, **more):
    task = Task.model_validate(
        {
            "name": "new",
            "title": "New",
            "instruction": "Do it.",
            "time_limit_s": 20,
            "objects": [
                {"name": "thing", "parts": list(parts), "mass_kg": 0.2, "friction": 0.5, "x": 0, "y": 0, **more}
            ],
            "success": {"conditions": [{"kind": "lifted", "object": "thing", "height_m": 0.1}]},
        }
    )
    return Scenery.of(sample_trial(task, 0)).objects["thing"]


def projected(solids, **region):
    made = Region.model_validate({"num_samples": 64, **region})
    found = project(candidates(made), np.asarray(made.normal), solids, np.asarray(made.center))
    return found[np.isfinite(found).all(axis=1)], len(found)


CAN = {"shape": "cylinder", "size": [0.06, 0.06, 0.1]}


def test_points_well_inside_a_flat_face_stay_bit_for_bit():
    brick = thing({"shape": "box", "size": [0.1, 0.1, 0.1]})
    region = {"center": [0.01, 0.02, 0.05], "normal": [0, 0, 1], "extent": 0.02}
    found, _ = projected(brick, **region)
    assert np.array_equal(found, candidates(Region.model_validate({**region, "num_samples": 64})))


def test_points_beside_a_small_face_are_dropped():
    brick = thing({"shape": "box", "size": [0.1, 0.04, 0.1]})
    found, count = projected(brick, center=[0, 0, 0.05], normal=[0, 0, 1], extent=0.15)
    assert 3 < len(found) < 20 < count
    assert (np.abs(found[:, :2]) <= [0.05, 0.02]).all()


def test_points_on_a_round_side_follow_it_and_end_where_it_turns_away():
    found, count = projected(thing(CAN), center=[0.03, 0, 0], normal=[1, 0, 0], extent=0.03)
    assert np.allclose(np.linalg.norm(found[:, :2], axis=1), 0.03, atol=2e-4)
    assert found[:, 0].min() >= 0.5 * 0.03 - 1e-4
    assert len(found) < count


def test_a_step_down_is_not_the_face():
    stairs = thing(
        {"shape": "box", "size": [0.1, 0.1, 0.1]},
        {"shape": "box", "size": [0.1, 0.1, 0.02], "position": [0.1, 0, -0.04]},
    )
    found, _ = projected(stairs, center=[0.045, 0, 0.05], normal=[0, 0, 1], extent=0.03)
    assert np.allclose(found[:, 2], 0.05)
    assert found[:, 0].max() <= 0.05


def test_a_seam_between_two_parts_is_no_surface():
    two = thing(
        {"shape": "box", "size": [0.1, 0.1, 0.1]}, {"shape": "box", "size": [0.1, 0.1, 0.1], "position": [0.1, 0, 0]}
    )
    assert off_surface(np.array([0.05, 0.0, 0.0]), two) == pytest.approx(0.05)
    assert len(projected(two, center=[0.05, 0, 0], normal=[1, 0, 0], extent=0.01)[0]) == 0


@pytest.mark.parametrize(
    ("center", "code"),
    [((0.028, 0.028, 0.0), "off-surface"), ((0.0, 0.0, 0.0), "off-surface"), ((0.0, 0.0, 0.05), None)],
)
def test_of_what_is_no_box_a_centre_must_lie_on_the_true_surface(scene, center, code):
    one = scene("pick-clutter")
    size = one.facts["objects"]["can"]["size_m"]
    scaled = [c * s / d for c, s, d in zip(center, size, (0.06, 0.06, 0.1), strict=True)]
    found = verify_regions(
        RegionsAnswer.model_validate({"can": {"regions": [{"center": scaled, "normal": [0, 0, 1], "extent": 0.002}]}}),
        one.facts,
        (),
        Scenery.of(one.trial),
    )
    assert (found.code if found else None) == code


def test_lost_candidates_are_counted_by_their_reason_and_guides_use_the_others(scene):
    one = scene("pick-box", 3)
    size = one.sizes["box"]
    region = Region(center=(0, 0, size[2] / 2), normal=(0, 0, 1), extent=0.15, num_samples=64, approach="press")
    answer = RegionsAnswer.model_validate({"box": {"regions": [region]}})
    (found,) = candidates_of(answer, one.facts, (), Scenery.of(one.trial))
    assert found.lost == {"off the face": 65 - len(found.points)}
    points = guide("box", region, size, local=found.points).points(one.world.present(one.now))
    assert len(points) == 2 * len(found.points)
    assert np.linalg.norm(points[:, :2] - one.now.objects["box"].position[:2], axis=1).max() < np.linalg.norm(size[:2])
