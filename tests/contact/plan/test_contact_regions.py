import numpy as np
import pytest

from coral.contact.plan.contact_regions import Region, candidates, guide, tangents
from coral.contact.scene.geometry import rotate, rotation_of


def test_few_candidates_lie_on_the_rim_of_eq_3():
    region = Region(center=(0.1, 0.2, 0.3), normal=(0, 0.6, 0.8), extent=0.02, num_samples=4)
    points = candidates(region)
    assert points.shape == (5, 3)
    assert np.allclose(points[0], region.center)
    off = points[1:] - points[0]
    assert np.allclose(np.linalg.norm(off, axis=1), 0.02)
    assert np.allclose(off @ np.array([0, 0.6, 0.8]), 0, atol=1e-12)
    assert np.allclose(off.mean(axis=0), 0, atol=1e-12)


def test_many_candidates_fill_the_disc_of_a_10_evenly():
    region = Region(center=(0.1, 0.2, 0.3), normal=(0, 0.6, 0.8), extent=0.02, num_samples=64)
    points = candidates(region)
    assert points.shape == (65, 3)
    off = points - points[0]
    assert np.allclose(off @ np.array([0, 0.6, 0.8]), 0, atol=1e-12)
    rho = np.linalg.norm(off, axis=1) / 0.02
    assert rho.max() == pytest.approx(1.0)
    # of a disc, the inner half by area holds half of the points
    assert 0.35 < float((rho < np.sqrt(0.5)).mean()) < 0.55
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)[~np.eye(65, dtype=bool)]
    assert apart.min() > 0.08 * 0.02


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0.6, 0.0, 0.8)])
def test_tangents_are_orthonormal(normal):
    first, second = tangents(np.array(normal, dtype=float))
    frame = np.stack([first, second, np.array(normal)])
    assert np.allclose(frame @ frame.T, np.eye(3), atol=1e-12)


def test_guides_follow_the_object_and_keep_the_fingers_off_the_table(scene):
    one = scene("pick-box", 3)
    size = one.sizes["box"]
    state = one.world.present(one.now)
    body = one.now.objects["box"]
    side = Region(center=(-size[0] / 2, 0.0, 0.0), normal=(-1.0, 0.0, 0.0), extent=0.0, num_samples=1, approach="push")
    made = guide("box", side, size, candidates(side))
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
    tool = guide("box", top, size, candidates(top)).quaternion(one.world.present(one.now))
    narrow = int(np.argmin(size[:2]))
    across = rotation_of(one.now.objects["box"].quaternion)[:, narrow]
    assert abs(float(rotation_of(tool)[:, 1] @ across)) > 0.999
