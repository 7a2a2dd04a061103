import numpy as np
import pytest

from coral.contact.franka.double import SimulatedState
from coral.contact.franka.shared_block import SharedBlock
from coral.contact.franka.simulated_camera import SimulatedRgbdCamera
from coral.contact.perception.camera import RgbdCameraCfg, look_at
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.scene.observation import BodyState

CFG = TrackedCfg(camera=RgbdCameraCfg(width=64, height=48))
HAND = BodyState(np.array([0.0, 0.0, 0.5]), np.array([0.0, 1.0, 0.0, 0.0]))


def write(state, trial, time_s, shift=0.0):
    up = np.array([0.0, 0.0, shift])
    objects = {name: BodyState(one.pose.position + up, one.pose.quaternion) for name, one in trial.objects.items()}
    state.write(SimulatedState(time_s, HAND, 0.08, objects))


def test_the_newest_state_is_drawn_once_and_without_masks(trial):
    state = SharedBlock(None)
    camera = SimulatedRgbdCamera(trial, CFG, state)
    assert camera.newest() is None
    write(state, trial, 1.0)
    write(state, trial, 1.5, shift=0.2)
    frame = camera.newest()
    assert frame.time_s == pytest.approx(1.5)
    assert frame.names == ()
    assert not frame.instance.any()
    assert frame.rgb.shape == (48, 64, 3)
    assert (frame.depth > 0).mean() > 0.3
    assert camera.newest() is None


def test_the_camera_may_stand_elsewhere_than_believed(trial):
    believed = look_at((0.0, -1.0, 0.5), (0.0, 0.0, 0.0))
    state = SharedBlock(None)
    camera = SimulatedRgbdCamera(trial, CFG, state, believed)
    write(state, trial, 1.0)
    assert camera.newest().T_world_camera == pytest.approx(believed)
