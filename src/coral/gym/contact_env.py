"""A contact task as a Gymnasium environment: the robot's measurements in, a moved hand target out."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from coral.config import checked
from coral.contact.control.hand_model import MAX_OPENING_M, SQUEEZE_M
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.perception.camera import RayCamera
from coral.contact.perception.tracked_world import TrackedWorld
from coral.contact.scene.geometry import conjugate, from_rotvec, multiply, to_rotvec
from coral.contact.scene.judge import Judge
from coral.contact.scene.observation import BodyState, HandTarget, Observation, Truth
from coral.contact.scene.task import Task
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.evaluation_world import EvaluationWorld, simulation_of
from coral.contact.worlds.registry import check_world, make_world
from coral.contact.worlds.robot_world import WorldError
from coral.errors import InputError
from coral.view.contact.replay import overview, scene_camera

Array = NDArray[np.float64]
Seen = dict[str, NDArray[np.float32]]
FARTHEST_M, MOST_N = 5.0, 500.0
"""Bounds of observed positions, and of forces and torques."""
PICTURE_PX, ROOM_M = (640, 480), 0.15
"""Size of the pictures of `render`, and how far around hand and objects they reach."""


class ContactEnv(gymnasium.Env[Seen, NDArray[np.float32]]):
    """Move a hand so that a task succeeds.

    Observation: `tool` (position in m, quaternion w, x, y, z), `opening` (m), `wrench` on the hand (N, N m), `target`
    (the present target: position, quaternion, opening), and for each object its pose under `object_NAME`, all in the
    world frame. Action: velocity of the target (x, y, z in the world; rotation about x, y, z of the hand; opening), -1
    to 1 of the limits that the planner has. One step is one control period.

    Poses come from a tracker in a simulated depth camera, so that they are late and err. Reward: 1 when the judge, who
    knows the true state, says that the task is done, else 0. `info["truth"]` tells which conditions hold.

    Args:
        task: A shipped task by name, a task file, or a `Task`.
        world: "hand", the free-flying hand; "panda" needs robosuite.
        poses: "tracked", or "ground-truth": then the observation holds true poses.
        cfg: Control period, limits of the target's speed, camera and tracker.
        render_mode: "rgb_array": `render` returns a picture of the scene; None: it returns nothing.

    Raises:
        InputError: There is no such task or world.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 50}  # noqa: RUF012

    def __init__(
        self,
        task: str | Path | Task = "pick-box",
        world: str = "hand",
        poses: Literal["tracked", "ground-truth"] = "tracked",
        cfg: EpisodeCfg | None = None,
        render_mode: Literal["rgb_array"] | None = None,
    ) -> None:
        check_world(world, "world")
        if poses not in ("tracked", "ground-truth"):
            raise InputError("poses", "", repr(poses), "'tracked' or 'ground-truth'")
        self.task = task if isinstance(task, Task) else load_task(task)
        self.cfg = checked(cfg or EpisodeCfg(), "cfg")
        self.render_mode = render_mode
        self.metadata = {**self.metadata, "render_fps": round(1.0 / self.cfg.planning.step_s)}
        self._world_name, self._poses = world, poses
        pose = spaces.Box(-FARTHEST_M, FARTHEST_M, (7,), np.float32)
        self._boxes: dict[str, spaces.Box[Any]] = {
            "tool": pose,
            "opening": spaces.Box(-0.1, 0.2, (1,), np.float32),
            "wrench": spaces.Box(-MOST_N, MOST_N, (6,), np.float32),
            "target": spaces.Box(-FARTHEST_M, FARTHEST_M, (8,), np.float32),
            **{f"object_{item.name}": pose for item in self.task.objects},
        }
        self.observation_space = spaces.Dict({**self._boxes})  # type: ignore[assignment]
        self.action_space = spaces.Box(-1.0, 1.0, (7,), np.float32)
        self._world: EvaluationWorld | None = None
        self._camera: RayCamera | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Seen, dict[str, Any]]:
        """Sample a trial: poses, sizes, masses, frictions. The option `trial` is the seed of a given one.

        Raises:
            InputError: The option is not a number of 0 or more.
        """
        super().reset(seed=seed)
        chosen = (options or {}).get("trial")
        number = int(self.np_random.integers(2**31)) if chosen is None else chosen
        if not isinstance(number, int) or number < 0:
            raise InputError("options", "trial", repr(number), "a number of 0 or more")
        self.close()
        trial = sample_trial(self.task, number)
        world = make_world(self._world_name, trial, self.cfg.planning.step_s)
        if self._poses == "tracked":
            world = TrackedWorld(world, trial, self.cfg.tracked, np.random.default_rng([number, 4]))
        self._world, self._judge, self._trial = world, Judge(trial), number
        self._now = world.reset()
        tool = self._now.tool
        stiffness = self.cfg.planning.hand.stiffness_n_m
        self._target = HandTarget(tool.position.copy(), tool.quaternion.copy(), self._now.opening_m, stiffness)
        truth = world.truth()
        self._judge.success(truth)
        self._camera = None if self.render_mode is None else self._overview(world, trial, truth)
        return self._observe(), self._info(truth, "")

    def step(self, action: NDArray[np.float32]) -> tuple[Seen, float, bool, bool, dict[str, Any]]:
        """Move the target, and the hand towards it, for one control period."""
        world = self._world
        if world is None:
            raise gymnasium.error.ResetNeeded("call reset before step")
        self._target = self._moved(np.clip(np.asarray(action, float), -1.0, 1.0))
        try:
            self._now = world.step(self._target)
            truth = world.truth()
        except WorldError as fault:
            return self._observe(), 0.0, True, False, self._info(None, fault.code)
        success = self._judge.success(truth)
        failure = self._judge.failure(truth) or ""
        done = bool(success or failure)
        late = self._now.time_s >= self.task.time_limit_s - 1e-9
        reward = float(success and not failure)
        return self._observe(), reward, done, late and not done, self._info(truth, failure)

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override]
        """Return a picture of the scene, Shape=(480, 640, 3); None without a render mode or before the first reset."""
        simulation = None if self._world is None else simulation_of(self._world)
        return None if simulation is None or self._camera is None else self._camera.take(simulation.data).rgb

    def _overview(self, world: EvaluationWorld, trial: Trial, truth: Truth) -> RayCamera | None:
        """Make a camera that shows the hand and all objects where they begin, and some room around them."""
        simulation = simulation_of(world)
        if simulation is None:
            return None
        points = np.array([self._now.tool.position, *(body.position for body in truth.objects.values())])
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        radius = float(np.linalg.norm(points - middle, axis=1).max()) + ROOM_M
        return scene_camera(simulation.model, trial, overview(middle, radius), PICTURE_PX)

    def close(self) -> None:
        """Release the world."""
        if self._world is not None:
            self._world.close()
            self._world = None

    def _moved(self, action: Array) -> HandTarget:
        """Move the target within the workspace and at most the allowed lead ahead of the hand."""
        cfg, dt, last, tool = self.cfg.controller, self.cfg.planning.step_s, self._target, self._now.tool
        position = last.position + action[:3] * cfg.speed_m_s * dt
        position = tool.position + _shortened(position - tool.position, cfg.lead_m)
        position = np.clip(position, cfg.workspace_low_m, cfg.workspace_high_m)
        turned = multiply(last.quaternion, from_rotvec(action[3:6] * cfg.turn_rad_s * dt))
        ahead = to_rotvec(multiply(conjugate(tool.quaternion), turned))
        quaternion = multiply(tool.quaternion, from_rotvec(_shortened(ahead, cfg.lead_rad)))
        opening = float(np.clip(last.opening_m + action[6] * cfg.opening_m_s * dt, SQUEEZE_M, MAX_OPENING_M))
        return HandTarget(position, quaternion, opening, last.stiffness)

    def _observe(self) -> Seen:
        now: Observation = self._now
        target = [*self._target.position, *self._target.quaternion, self._target.opening_m]
        values: dict[str, Any] = {
            "tool": _pose(now.tool),
            "opening": [now.opening_m],
            "wrench": now.wrench,
            "target": target,
            **{f"object_{name}": _pose(body) for name, body in now.objects.items()},
        }
        return {
            name: np.clip(np.asarray(values[name], np.float32), box.low, box.high) for name, box in self._boxes.items()
        }

    def _info(self, truth: Truth | None, failure: str) -> dict[str, Any]:
        """Return time and trial, and under `truth` what only the judge knows."""
        known: dict[str, Any] = {"holding": self._judge.holding, "failure": failure}
        if truth is not None:
            known |= {f"object_{name}": np.array(_pose(body)) for name, body in truth.objects.items()}
        return {"time_s": self._now.time_s, "trial": self._trial, "truth": known}


def _shortened(vector: Array, longest: float) -> Array:
    return np.asarray(vector * min(1.0, longest / max(float(np.linalg.norm(vector)), 1e-9)))


def _pose(body: BodyState) -> list[float]:
    return [*map(float, body.position), *map(float, body.quaternion)]
