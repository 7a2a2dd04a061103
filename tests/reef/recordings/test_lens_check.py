"""Pictures of a textured floor, taken with a known lens, told with another one."""

import cv2
import numpy as np
import pytest

from coral.reef.recordings.lens_check import check_lens, check_run_lens, fit_lens, floor_error
from coral.reef.recordings.recorded_pictures import NO_OBJECTS
from coral.reef.recordings.recording import PosedFrame, Recording
from coral.reef.vehicle.camera import CameraCfg, T_world_camera
from coral.reef.world.geometry import Frame, Pose

TRUE = CameraCfg(width=160, height=120, hfov_deg=90.0, pitch_down_deg=40.0)
FLOOR_M = 0.02


def taken(pose, texture):
    """A picture of the floor. Above the horizon it is blue."""
    focal, _, cx, cy = TRUE.intrinsics
    v, u = np.mgrid[: TRUE.height, : TRUE.width]
    transform = T_world_camera(pose, TRUE)
    ways = transform[:3, :3] @ np.stack([(u - cx) / focal, (v - cy) / focal, np.ones(u.shape)]).reshape(3, -1)
    length = transform[2, 3] / np.maximum(-ways[2], 1e-3)
    x, y = ((transform[k, 3] + length * ways[k]).reshape(u.shape) for k in (0, 1))
    seen = cv2.remap(texture, (x / FLOOR_M).astype(np.float32), (y / FLOOR_M).astype(np.float32), cv2.INTER_LINEAR)
    return np.repeat(seen[:, :, None], 3, axis=2)


@pytest.fixture(scope="module")
def dive():
    rng = np.random.default_rng(4)
    texture = cv2.GaussianBlur(rng.integers(0, 255, (800, 800)).astype(np.uint8), (0, 0), 2.0)
    texture = cv2.normalize(texture, None, 0, 255, cv2.NORM_MINMAX)
    nothing, far = np.zeros((120, 160), np.uint8), np.full((120, 160), np.inf, np.float32)
    frames = []
    for k in range(14):
        pose = Pose(4.0 + 0.3 * k, 8.0 + 0.1 * (k % 3), 0.05 * k)
        frames.append(
            PosedFrame(t=float(k), pose=pose, height_m=1.0, frame=Frame(far, nothing, NO_OBJECTS, taken(pose, texture)))
        )
    return frames


def told_with(frames, hfov_deg):
    camera = CameraCfg(width=160, height=120, hfov_deg=hfov_deg, pitch_down_deg=40.0)
    return Recording(name="d", source="d", camera=camera, keyframes=lambda: iter(frames))


def test_a_point_of_the_floor_lies_where_the_next_picture_has_it():
    first, second = (
        PosedFrame(t=0.0, pose=pose, height_m=1.0, frame=None) for pose in (Pose(0, 0, 0), Pose(0.3, 0.1, 0.2))
    )
    focal, _, cx, cy = TRUE.intrinsics
    point = np.array([1.2, 0.1, 0.0])
    uv = []
    for one in (first, second):
        transform = T_world_camera(one.pose, TRUE)
        x, y, z = transform[:3, :3].T @ (point - transform[:3, 3])
        uv += [focal * x / z + cx, focal * y / z + cy]
    assert floor_error(np.array([uv]), first, second, TRUE, 1.0)[0] == pytest.approx(0.0, abs=1e-9)
    assert floor_error(np.array([uv]), first, second, TRUE, 0.6)[0] > 3.0
    assert floor_error(np.array([[80.0, -200.0, 0, 0]]), first, second, TRUE, 1.0)[0] == np.inf


def test_the_right_lens_is_not_complained_of(dive):
    assert fit_lens(told_with(dive, 90.0)).ratio == pytest.approx(1.0, abs=0.05)
    assert check_lens(told_with(dive, 90.0)) == ""


@pytest.mark.parametrize("stated", [60.0, 120.0])
def test_a_wrong_lens_is_told_with_the_one_that_fits(dive, stated):
    told = check_lens(told_with(dive, stated))
    assert f"not {stated:.0f}°" in told
    better = float(told.split("field of view of ")[1].split("°")[0])
    assert better == pytest.approx(90.0, abs=4.0)
    assert "\n" not in told


def test_pictures_that_do_not_tell_say_nothing(dive, tmp_path):
    assert fit_lens(told_with(dive[:3], 120.0)) is None
    still = [PosedFrame(t=one.t, pose=dive[0].pose, height_m=1.0, frame=one.frame) for one in dive]
    assert check_lens(told_with(still, 120.0)) == ""
    assert check_run_lens(tmp_path) == ""
