"""One contact episode driven by a served policy: same trial, world, judge, limits and run folder, no planner."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from coral.config import to_mapping
from coral.contact.control.reactive import Reactive
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.metrics import compute_metrics
from coral.contact.episode.recorder import EpisodeRecorder, columns, numbers
from coral.contact.episode.referee import make_referee
from coral.contact.episode.trial_log import conditions_not_held, start_fields, write_head
from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, covered_geoms, look_at
from coral.contact.policy import libero_convention as libero
from coral.contact.policy.address import Address
from coral.contact.policy.client import PolicyClient, PolicyError, printable
from coral.contact.scene.geometry import pose_matrix, rotation_of
from coral.contact.scene.observation import Array, BodyState, HandTarget, Observation
from coral.contact.scene.trial import Trial
from coral.contact.worlds.registry import make_world
from coral.contact.worlds.robot_world import WorldError
from coral.errors import InputError
from coral.interrupts import interruptible
from coral.run_files import RunFiles, TaskFiles
from coral.run_loop import Observer, run_to_end, stoppable, timing_of
from coral.runs import RunWriter

Image = NDArray[np.uint8]
EYE_M, TARGET_M = (0.8186, 0.0, 0.7104), (-0.0615, 0.0, 0.0)
"""Position and target of the camera across the table: LIBERO's "agentview" in our frame."""
VFOV_DEG = 45.0
"""Its field of view (MuJoCo's default, which LIBERO keeps)."""
WRIST_M = np.array([0.05, 0.0, -0.097])
"""Position of the wrist camera in the tool frame; it looks out of the palm, its top towards the hand's x."""
WRIST_VFOV_DEG = 75.0
"""Its field of view (robosuite's "eye_in_hand")."""


class PolicyEpisode:
    """Couples an evaluation world with a policy and records what happens.

    The world is paused while the policy computes, as in LIBERO. Of the planner's configuration only the workspace is
    used.

    Raises:
        InputError: The world has no pictures, or the folder is not empty.
    """

    stage = "policy"

    def __init__(
        self, trial: Trial, world: str, policy: PolicyClient, cfg: EpisodeCfg, folder: Path, address: Address
    ) -> None:
        self.trial, self.policy, self.cfg, self.address = trial, policy, cfg, address
        self.time_limit_s = trial.task.time_limit_s
        self.step, self.t, self.end_reason, self.detail = 0, 0.0, "", ""
        self.calls = 0
        means = cfg.policy.libero
        if cfg.judged_by != "truth":
            raise InputError("--cfg", "judged-by", cfg.judged_by, "truth, for a served policy")
        if means.tick_s < 0.002:
            raise InputError("--cfg", "policy.libero.ticks", means.ticks, "at most 500 ticks a second in all")
        self.world = make_world(world, trial, means.tick_s)
        if self.world.simulation is None:
            raise InputError("--world", "", repr(world), "a simulated world, of which pictures can be made")
        self.referee = make_referee("truth", self.world, trial)
        self._data = self.world.simulation.data
        self.eyes = PolicyCameras(self.world.simulation.model, means.pixels)
        # Without rollouts there is no feedback; only the limits of the reactive control remain.
        low, high = np.asarray(cfg.controller.workspace_low_m), np.asarray(cfg.controller.workspace_high_m)
        self.reactive = Reactive(replace(cfg.reactive, enabled=False), means.tick_s, low, high)
        objects = [item.name for item in trial.task.objects]
        self.writer = RunWriter(folder, columns(objects))
        self.recorder = EpisodeRecorder(self.writer, cfg.record, objects)
        self.now: Observation
        self._opening = 0.0
        self._look_ms: list[float] = []
        self._ask_ms: list[float] = []

    def run(self, observers: Sequence[Observer[PolicyEpisode]] = ()) -> dict[str, Any]:
        """Run to the end and return metrics and timing together."""
        started = time.perf_counter()
        try:
            with stoppable(self):
                self._begin()
                run_to_end(self, observers)
        except WorldError as fault:
            self.end_reason, self.detail = fault.code, str(fault)
        except PolicyError as error:
            self.end_reason, self.detail = f"policy: {error.code}", str(error)
        finally:
            self._end()
        return self._finish(time.perf_counter() - started)

    def advance(self) -> None:
        """Ask once, and execute the first actions of the answer.

        Raises:
            PolicyError: The answer has no valid actions.
            WorldError: The world failed.
        """
        means = self.cfg.policy.libero
        actions = self._ask()[: means.execute]
        for action in actions:
            wanted = libero.target(self.now, action, means)
            for _ in range(means.ticks):
                self._opening = libero.opened(self._opening, action, means)
                self._act(replace(wanted, opening_m=self._opening))
                if self.end_reason:
                    return

    def emit(self, event: str, **fields: Any) -> None:
        """Append an event at the present step."""
        self.writer.event(self.step, self.t, event, **fields)

    def _ask(self) -> Array:
        begun = time.perf_counter()
        outside, wrist = self.eyes.look(self._data, self.now.tool)
        if not self.calls:
            both = np.concatenate([outside, wrist], axis=1)
            self.writer.bytes(TaskFiles.SEEN, cv2.imencode(".png", both[..., ::-1])[1].tobytes())
        looked = time.perf_counter()
        state = libero.state(self.now, self.cfg.policy.libero)
        seen = dict(zip(libero.OBSERVATION, (outside, wrist, state, self.trial.task.instruction), strict=True))
        with interruptible():
            answer = self.policy.infer(seen)
        self.calls += 1
        self._look_ms.append(1e3 * (looked - begun))
        self._ask_ms.append(1e3 * (time.perf_counter() - looked))
        actions = libero.actions_of(answer)
        self.emit(
            "policy",
            call=self.calls,
            chunk=len(actions),
            actions=[numbers(action, 5) for action in actions[: self.cfg.policy.libero.execute]],
        )
        return actions

    def _act(self, target: HandTarget) -> None:
        command = self.reactive.command(target, self.now)
        self.now = self.world.step(command)
        truth = self.referee.judged_state(self.now)
        self.step += 1
        self.t = self.now.time_s
        self.recorder.record(self.step, self.world, self.now, truth, command)
        self.end_reason = self.referee.end_reason(truth, self.t < self.time_limit_s - 1e-9)
        if self.end_reason == "timeout":
            self.detail = conditions_not_held(self.trial, self.referee.holding, truth)

    def _begin(self) -> None:
        self.now = self.world.reset()
        self.t, self._opening = self.now.time_s, self.now.opening_m
        about = {"world": self.world.name, "variant": self.address.name, "advisor": "none", "seed": self.trial.seed}
        server = {"policy": self.address.url, "server": printable(repr(self.policy.metadata), 2000)}
        write_head(self.writer, self.trial, {**about, **server}, to_mapping(self.cfg))
        self.emit("start", **start_fields(self.trial, **about, poses="pictures"))
        self.emit("strategy", name=self.address.name, stages=[self.stage], beliefs=[])
        self.emit("stage", before=None, stage=self.stage, index=0)
        truth = self.referee.judged_state(self.now)
        rest = HandTarget(
            self.now.tool.position, self.now.tool.quaternion, self.now.opening_m, self.cfg.policy.libero.stiffness_n_m
        )
        self.recorder.record(0, self.world, self.now, truth, rest)

    def _end(self) -> None:
        self.world.stop()
        self.recorder.state(self.step, self.t, self.world, last=True)
        self.recorder.close(self.step)
        self.emit("end", reason=self.end_reason or "failed", detail=self.detail)
        self.writer.close()
        self.world.close()

    def _finish(self, wall_s: float) -> dict[str, Any]:
        timing = timing_of(wall_s, self.t, plan_ms=self._ask_ms, pictures_ms=self._look_ms)
        metrics = compute_metrics(self.writer.folder)
        self.writer.json(RunFiles.METRICS, metrics)
        self.writer.json(RunFiles.TIMING, timing)
        return {**metrics, **timing}


class PolicyCameras:
    """Takes both pictures of a simulated world, whose model is not changed; `pixels` wide and high.

    Raises:
        InputError: The scene cannot be drawn.
    """

    def __init__(self, model: mujoco.MjModel, pixels: int) -> None:
        hidden = covered_geoms(model)

        def camera(vfov_deg: float, near_m: float, pose: Array) -> RayCamera:
            lens = RgbdCameraCfg(width=pixels, height=pixels, vfov_deg=vfov_deg, near_m=near_m)
            return RayCamera(model, lens, pose, {}, colours=True, hidden=hidden)

        self._outside = camera(VFOV_DEG, 0.05, look_at(EYE_M, TARGET_M))
        self._wrist = camera(WRIST_VFOV_DEG, 0.005, np.eye(4))

    def look(self, data: mujoco.MjData, tool: BodyState) -> tuple[Image, Image]:
        """Take the pictures from across the table and from the wrist, each Shape=(H, W, 3), RGB, mirrored.

        LIBERO mirrors them: it turns OpenGL's bottom-up rows by half a turn. The state's kinematics are up to date.
        """
        self._wrist.T_world_camera = wrist_pose(tool)
        return _mirrored(self._outside, data), _mirrored(self._wrist, data)


def _mirrored(camera: RayCamera, data: mujoco.MjData) -> Image:
    picture = camera.take(data).rgb
    assert picture is not None
    return np.ascontiguousarray(picture[:, ::-1])


def wrist_pose(tool: BodyState) -> Array:
    """Return T_world_camera, Shape=(4, 4), of the wrist's camera (x right, y down, z forward)."""
    turn = rotation_of(tool.quaternion)
    axes = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    return pose_matrix(turn @ axes, tool.position + turn @ WRIST_M)
