import numpy as np
import pytest

from coral.contact.geometry import rotate, rotation_of
from coral.contact.thinking.regions import Region, RegionsAnswer, candidates, guide, tangents, verify_regions

TOP = {"center": [0, 0, 0.03], "normal": [0, 0, 1]}


def facts(size=(0.06, 0.06, 0.06), at=(0.0, 0.0, 0.03), **more):
    item = {"size_m": list(size), "pose": [*at, 1, 0, 0, 0], "shapes": ["box"], "solid_share": 1.0, "points": {},
            **more}
    return {"objects": {"box": item}, "table": {"x": [-0.4, 0.4], "y": [-0.4, 0.4]}}


def answer(*regions, name="box"):
    return RegionsAnswer.model_validate({name: {"regions": list(regions)}})


def test_candidates_lie_on_the_rim_of_eq_3():
    region = Region(center=(0.1, 0.2, 0.3), normal=(0, 0.6, 0.8), extent=0.02, num_samples=12)
    points = candidates(region)
    assert points.shape == (13, 3)
    off = points[1:] - points[0]
    assert np.allclose(np.linalg.norm(off, axis=1), 0.02)
    assert np.allclose(off @ np.array([0, 0.6, 0.8]), 0, atol=1e-12)
    assert np.allclose(off.mean(axis=0), 0, atol=1e-12)


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0.6, 0.0, 0.8)])
def test_tangents_are_orthonormal(normal):
    first, second = tangents(np.array(normal, dtype=float))
    frame = np.stack([first, second, np.array(normal)])
    assert np.allclose(frame @ frame.T, np.eye(3), atol=1e-12)


def test_a_sound_region_passes():
    assert verify_regions(answer(TOP), facts()) is None


@pytest.mark.parametrize(("region", "code"), [
    ({**TOP, "center": [0, 0, 0.06]}, "off-surface"),
    ({**TOP, "center": [0, 0, 0.0]}, "off-surface"),
    ({**TOP, "normal": [0, 0, 2]}, "normal"),
    ({**TOP, "normal": [0, 0, -1]}, "inward"),
    ({"center": [0, 0, -0.03], "normal": [0, 0, -1]}, "underside"),
    ({**TOP, "extent": 0.5}, "extent"),
    ({**TOP, "num_samples": 0}, "extent"),
    ({**TOP, "stage": "fly"}, "stage"),
    ({**TOP, "opening": 0.2}, "opening"),
])
def test_unusable_regions_are_refused_by_name(region, code):
    found = verify_regions(answer(region), facts(), ["reach"])
    assert found.code == code
    assert "region 1 of box" in found.reason


def test_what_is_wider_than_the_hand_opens_is_not_pinched():
    found = verify_regions(answer({"center": [0, 0, 0.03], "normal": [0, 0, 1], "approach": "pinch"}),
                           facts(size=(0.1, 0.1, 0.06)))
    assert found.code == "too-wide"


def test_an_unknown_object_and_an_empty_answer_are_refused():
    assert verify_regions(answer(TOP, name="cup"), facts()).code == "objects"
    assert verify_regions(answer(), facts()).code == "none"


def test_guides_follow_the_object_and_keep_the_fingers_off_the_table(scene):
    one = scene("pick-box", 3)
    size = one.sizes["box"]
    state = one.world.present(one.now)
    body = one.now.objects["box"]
    side = Region(center=(-size[0] / 2, 0.0, 0.0), normal=(-1.0, 0.0, 0.0), extent=0.0, num_samples=1, approach="push")
    made = guide("box", side, size)
    points, tool = made.points(state), made.quaternion(state)
    outward = rotate(body.quaternion, [-1.0, 0, 0])
    assert np.allclose(points[0], body.position + outward * (size[0] / 2 + 0.010), atol=1e-3)
    assert points[:, 2].min() >= 0.012 - 1e-9
    assert np.allclose(rotation_of(tool)[:, 2], [0, 0, -1], atol=1e-6)
    assert abs(float(rotation_of(tool)[:, 1] @ outward)) < 1e-6


def test_a_pinch_closes_across_the_narrow_side(scene):
    one = scene("pick-box", 3)
    size = one.sizes["box"]
    top = Region(center=(0, 0, size[2] / 2), normal=(0, 0, 1), approach="pinch")
    tool = guide("box", top, size).quaternion(one.world.present(one.now))
    narrow = int(np.argmin(size[:2]))
    across = rotation_of(one.now.objects["box"].quaternion)[:, narrow]
    assert abs(float(rotation_of(tool)[:, 1] @ across)) > 0.999
