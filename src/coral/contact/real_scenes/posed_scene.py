"""A trial's scene with objects and hand at given poses, drawn by a camera."""

from __future__ import annotations

import mujoco
import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M, HandCfg, add_hand
from coral.contact.control.planning_world import put_state
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.tracked_cfg import TrackedCfg, make_camera
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.observation import BodyState, Observation
from coral.contact.scene.trial import Trial


class PosedScene:
    """A scene whose poses are set, not simulated."""

    def __init__(self, trial: Trial, cfg: TrackedCfg) -> None:
        self._trial = trial
        spec = mujoco.MjSpec()
        add_scene(spec, trial)
        add_hand(spec, HandCfg())
        self.model = spec.compile()
        self._data = mujoco.MjData(self.model)
        self.camera = make_camera(self.model, trial, cfg, colours=True)

    def take(self, state: Observation, rng: np.random.Generator) -> RgbdFrame:
        """Take a picture of the hand and the objects in a state."""
        put_state(self.model, self._data, state, self._trial)
        self._data.time = state.time_s
        mujoco.mj_kinematics(self.model, self._data)
        return self.camera.take(self._data, rng)


def scene_at_start(trial: Trial) -> Observation:
    """Return the state in which a trial begins, with an open hand out of the way."""
    hand = BodyState(np.array([-0.5, 0.4, 0.5]), np.array([0.0, 1.0, 0.0, 0.0]))
    return Observation(0.0, hand, MAX_OPENING_M, np.zeros(6), {name: one.pose for name, one in trial.objects.items()})
