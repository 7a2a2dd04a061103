"""The camera of a simulated arm: pictures drawn from the state that the simulation sends, noisy as a real camera's."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coral.contact.franka.double import SimulatedState
from coral.contact.franka.shared_block import SharedBlock
from coral.contact.perception.camera import RgbdFrame, look_at
from coral.contact.perception.tracked_cfg import TrackedCfg, viewpoint
from coral.contact.real_scenes.benchmark_motions import MotionSample
from coral.contact.real_scenes.cameras.bare_frame import bare_frame
from coral.contact.real_scenes.posed_scene import PosedScene
from coral.contact.scene.rigid_transform import body_to_matrix
from coral.contact.scene.trial import Trial

Array = NDArray[np.float64]


class SimulatedRgbdCamera:
    """Draws a picture of the newest state. The pictures hold no masks, and nobody else sees the state.

    The hand is drawn, the arm's other links are not.

    Args:
        trial: The trial, for the shapes and colours.
        cfg: The camera's size, place and noise.
        state: Where the simulation writes its state.
        T_world_camera: Shape=(4, 4), where the camera is believed to stand, as a calibration says; by default where it
            does stand.
    """

    name = "sim"
    live = True

    def __init__(
        self,
        trial: Trial,
        cfg: TrackedCfg,
        state: SharedBlock[SimulatedState | None],
        T_world_camera: Array | None = None,
    ) -> None:
        placed = look_at(*viewpoint(trial, cfg))
        self._believed = placed if T_world_camera is None else T_world_camera
        self._scene = PosedScene(trial, cfg.camera, cfg.make_noise(), placed, colours="shaded")
        self._rng = np.random.default_rng([trial.seed, 11])
        self._state, self._drawn_s = state, -1.0

    def start(self) -> None:
        """See `RgbdCamera.start`."""

    def newest(self) -> RgbdFrame | None:
        """See `RgbdCamera.newest`."""
        state = self._state.read()
        if state is None or state.time_s == self._drawn_s:
            return None
        self._drawn_s = state.time_s
        objects = {name: body_to_matrix(body) for name, body in state.objects.items()}
        moment = MotionSample(objects, body_to_matrix(state.tool), state.opening_m)
        full = self._scene.take(moment, self._rng, state.time_s)
        return bare_frame(full.depth, full.rgb, full.lens, self._believed, full.time_s)

    def close(self) -> None:
        """See `RgbdCamera.close`."""
