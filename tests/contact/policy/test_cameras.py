import dataclasses

import mujoco
import numpy as np
import pytest

from coral.contact.episode.policy_cfg import PolicyCamerasCfg
from coral.contact.policy.cameras import PolicyCameras, wrist_pose
from coral.contact.scene.observation import BodyState
from coral.errors import InputError

DOWN = np.array([0.0, 1.0, 0.0, 0.0])
SMALL = PolicyCamerasCfg(pixels=48)
SCENE = """
<mujoco><worldbody>
  <geom name="table" type="box" size="0.5 0.5 0.05" pos="0 0 -0.05" rgba="1 1 1 1"/>
  <geom name="left" type="sphere" size="0.04" pos="0 0.15 0.04" rgba="1 0 0 1"/>
  <body><geom name="cover" type="sphere" size="0.05" pos="0 -0.15 0.04" rgba="0 1 0 1"/>
    <geom name="pretty" type="sphere" size="0.04" pos="0 -0.15 0.04" rgba="0 0 1 1" group="1"/></body>
</worldbody></mujoco>"""


@pytest.fixture(scope="module")
def scene():
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def look(scene, cfg, tool=(0.0, 0.0, 0.3)):
    return PolicyCameras(scene[0], cfg).look(scene[1], BodyState(np.array(tool), DOWN))


def columns(picture, channel):
    """Mean column of what has mostly this colour, as a share of the width; None when nothing has."""
    others = [k for k in range(3) if k != channel]
    seen = picture[..., channel] > 2.0 * picture[..., others].max(axis=-1)
    return None if not seen.any() else float(np.flatnonzero(seen.any(axis=0)).mean() / picture.shape[1])


def test_pictures_have_the_shape_and_type_that_policies_take(scene):
    for picture in look(scene, SMALL):
        assert (picture.shape, picture.dtype, picture.flags.c_contiguous) == ((48, 48, 3), np.uint8, True)


def test_the_outer_camera_faces_the_robot_and_mirrors(scene):
    """It looks along -x, so that +y is on its right, and in the mirrored picture on the left."""
    outside, _ = look(scene, SMALL)
    plain, _ = look(scene, dataclasses.replace(SMALL, mirrored=False))
    assert columns(outside, 0) < 0.5 < columns(plain, 0)
    np.testing.assert_array_equal(outside, plain[:, ::-1])


def test_collision_shapes_do_not_cover_pretty_ones(scene):
    outside, _ = look(scene, SMALL)
    assert columns(outside, 1) is None
    assert columns(outside, 2) is not None


def test_the_wrist_camera_looks_out_of_the_palm_and_moves_with_the_hand(scene):
    _, here = look(scene, SMALL)
    _, aside = look(scene, SMALL, (-0.05, 0.15, 0.3))  # the camera is 5 cm ahead: straight above the red ball
    assert columns(aside, 0) == pytest.approx(0.5, abs=0.05)
    assert abs(columns(here, 0) - 0.5) > 0.15


def test_the_wrist_camera_is_robosuites():
    """Its place on the Panda's hand: 5 cm along x, at the flange; its top towards the hand's x."""
    pose = wrist_pose(BodyState(np.zeros(3), np.array([1.0, 0, 0, 0])), np.array(SMALL.wrist_m))
    np.testing.assert_allclose(pose[:3, 3], [0.05, 0, -0.097])
    np.testing.assert_allclose(pose[:3, 1], [-1, 0, 0])  # down in the picture
    np.testing.assert_allclose(pose[:3, 2], [0, 0, 1])
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)


def test_a_camera_that_looks_straight_down_has_no_upright(scene):
    with pytest.raises(InputError, match="target_m"):
        PolicyCameras(scene[0], PolicyCamerasCfg(eye_m=(0, 0, 1), target_m=(0, 0, 0)))
