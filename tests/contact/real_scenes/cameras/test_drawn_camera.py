from dataclasses import replace

import numpy as np
import pytest

from coral.contact.perception.camera import RgbdCameraCfg, look_at
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.real_scenes.cameras.drawn_camera import PICTURES, DrawnRgbdCamera, still_camera
from coral.contact.real_scenes.cameras.rgbd_camera import stream_frames
from coral.contact.real_scenes.posed_scene import scene_at_start
from coral.errors import InputError

CFG = TrackedCfg(camera=RgbdCameraCfg(width=64, height=48))


def test_the_newest_state_is_drawn_once_and_without_masks(trial):
    states = []
    camera = DrawnRgbdCamera(trial, CFG, lambda: states[-1] if states else None)
    assert camera.newest() is None
    states += [replace(scene_at_start(trial), time_s=time_s) for time_s in (1.0, 1.5)]
    frame = camera.newest()
    assert frame.time_s == pytest.approx(1.5)
    assert frame.names == ()
    assert not frame.instance.any()
    assert frame.rgb.shape == (48, 64, 3)
    assert (frame.depth > 0).mean() > 0.3
    assert camera.newest() is None


def test_the_camera_may_stand_elsewhere_than_believed(trial):
    believed = look_at((0.0, -1.0, 0.5), (0.0, 0.0, 0.0))
    camera = DrawnRgbdCamera(trial, CFG, lambda: scene_at_start(trial), believed)
    assert camera.newest().T_world_camera == pytest.approx(believed)


def test_a_still_scene_is_seen_for_some_pictures_each_with_its_own_noise():
    frames = list(stream_frames(still_camera("pick-box")))
    assert [frame.time_s for frame in frames] == pytest.approx(0.1 * np.arange(PICTURES))
    assert (frames[0].depth != frames[1].depth).any()
    with pytest.raises(InputError, match="no-such-task"):
        still_camera("no-such-task")
