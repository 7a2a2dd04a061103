import mujoco
import numpy as np
import pytest
from solid_object import solid

from coral.contact.perception.object_model import from_body, from_trial
from coral.contact.perception.surface_kernels import distance
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.posed_scene import PosedScene
from coral.errors import InputError


def test_points_lie_on_the_surface_and_not_inside_another_part():
    model = solid(("box", (0.05, 0.04, 0.03)), ("cylinder", (0.02, 0.04), (0.0, 0.0, 0.04)))
    inside = (np.abs(model.points) < np.array([0.05, 0.04, 0.03]) - 1e-6).all(1)
    assert not inside.any()
    assert distance(model.points, model.triangles).max() < 1e-9


@pytest.mark.parametrize(
    ("kind", "size", "area"),
    [
        ("sphere", (0.05,), 4 * np.pi * 0.05**2),
        ("capsule", (0.03, 0.05), 4 * np.pi * 0.03**2 + 2 * np.pi * 0.03 * 0.1),
        ("cylinder", (0.03, 0.05), 2 * np.pi * 0.03**2 + 2 * np.pi * 0.03 * 0.1),
        ("box", (0.1, 0.2, 0.3), 8 * 0.11),
    ],
)
def test_surfaces_have_their_area_and_face_outward(kind, size, area):
    t = solid((kind, size)).triangles
    cross = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    assert np.linalg.norm(cross, axis=1).sum() / 2 == pytest.approx(area, rel=0.01)
    assert ((cross * t.mean(1)).sum(1) > 0).all()


def test_a_body_s_mesh_keeps_its_frame(mug):
    corners = np.concatenate(mug.triangles)
    np.testing.assert_allclose((corners.min(0), corners.max(0))[0][2], -0.05, atol=1e-4)
    np.testing.assert_allclose(mug.pivot, [(0.074 - 0.04) / 2, 0.0, 0.0], atol=1e-3)


def test_a_body_that_is_not_there_is_named():
    with pytest.raises(InputError, match="cup"):
        from_body(mujoco.MjModel.from_xml_string("<mujoco/>"), "cup")


def test_the_size_of_a_box_is_its_diagonal_and_its_pivot_its_middle():
    model = solid(("box", (0.03, 0.04, 0.12), (0.1, 0.0, 0.0)))
    assert model.diameter == pytest.approx(0.26)
    np.testing.assert_allclose(model.pivot, [0.1, 0.0, 0.0], atol=1e-12)


def test_points_are_spread_evenly_by_area():
    model = solid(("box", (0.1, 0.1, 0.05)))
    on_top = (model.points[:, 2] > 0.05 - 1e-9).mean()
    assert on_top == pytest.approx(0.04 / 0.16, abs=0.01)


def test_an_object_of_a_trial_has_its_own_shape_and_the_larger_symmetry(trial):
    model = PosedScene(trial, TrackedCfg()).model
    box, can = (from_trial(model, trial, name) for name in ("box", "can"))
    assert box.diameter == pytest.approx(np.linalg.norm([0.12, 0.08, 0.06]))
    assert (len(box.symmetry.rotations), can.symmetry.axis is not None) == (4, True)


def test_a_body_without_drawn_geoms_is_refused():
    scene = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body name="ghost"><geom size=".1" rgba="1 1 1 0"/></body></worldbody></mujoco>'
    )
    with pytest.raises(InputError, match="body ghost: found no drawn geoms"):
        from_body(scene, "ghost")
