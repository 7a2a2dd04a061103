"""A reef as a Gymnasium environment: the vehicle's sensors in, speed and turn out, coverage as reward."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from coral.config import checked
from coral.errors import InputError
from coral.reef.map.localization import LocalizationCfg, Localizer
from coral.reef.simulation.simulator import ReefSimulator, SimulatorCfg
from coral.reef.world.find_world import find_world
from coral.reef.world.geometry import Frame
from coral.reef.world.world import ReefWorld

Observation = dict[str, NDArray[Any]]
COLLISION_COST = 0.1
"""Reward lost by a new contact: as much as a tenth of all clusters."""
COLORS = np.array([[10, 40, 70], [240, 150, 60], [150, 60, 60], [200, 190, 150]], np.uint8)
"""RGB of water, oyster, obstacle and seabed in rendered pictures."""
MOST_SPEED = 3.0
"""Bound of observed velocities (m/s, rad/s), several times the vehicle's limits."""


class ReefEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """Survey a reef.

    Observation: `depth` (m, range of the camera where nothing is seen), `labels` (0 water, 1 oyster, 2 obstacle,
    3 seabed), `pose` (x, y in m, heading in rad, as the robot estimates it), `velocity` (surge, sway in m/s, yaw rate
    in rad/s, body frame). Action: forward speed and yaw rate, -1 to 1 of their limits. One step is one control period.

    Reward: the increase of coverage, by clusters from 0 to 1 in all, less 0.1 for each new contact. It comes from the
    true state, like `info["truth"]`; the observation does not.

    Args:
        world: A shipped or generated reef by name, a world file, or a `ReefWorld`.
        cfg: Vehicle and sensors.
        localization: How odometry is corrected.
        control_period_s: Duration of a step.
        time_limit_s: Simulated time after which an episode is truncated.
        render_mode: None, or "rgb_array": what the camera's classes look like.

    Raises:
        InputError: There is no such world, or a value is out of range.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012

    def __init__(
        self,
        world: str | Path | ReefWorld = "s1",
        cfg: SimulatorCfg | None = None,
        localization: LocalizationCfg | None = None,
        control_period_s: float = 0.1,
        time_limit_s: float = 600.0,
        render_mode: str | None = None,
    ) -> None:
        self.world = world if isinstance(world, ReefWorld) else find_world(world)
        self.cfg = checked(cfg or SimulatorCfg(), "cfg")
        self._localization = checked(localization or LocalizationCfg(), "localization")
        if not 0.001 <= control_period_s <= 1 or not time_limit_s > 0:
            found = (control_period_s, time_limit_s)
            raise InputError("control_period_s, time_limit_s", "", found, "0.001 to 1, above 0")
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise InputError("render_mode", "", repr(render_mode), "None or 'rgb_array'")
        self.render_mode = render_mode
        self._period_s, self._limit = control_period_s, math.ceil(time_limit_s / control_period_s - 1e-9)
        camera = self.cfg.camera
        shape, (width, height) = (camera.height, camera.width), self.world.size_m
        low = np.array([-width, -height, -math.pi], np.float32)
        self._boxes: dict[str, spaces.Box[Any]] = {
            "depth": spaces.Box(0.0, camera.range_m, shape, np.float32),
            "labels": spaces.Box(0, 3, shape, np.uint8),
            "pose": spaces.Box(low, np.array([2 * width, 2 * height, math.pi], np.float32), dtype=np.float32),
            "velocity": spaces.Box(-MOST_SPEED, MOST_SPEED, (3,), np.float32),
        }
        self.observation_space = spaces.Dict({**self._boxes})  # type: ignore[assignment]
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self._frame: Frame | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Put the vehicle at its start; `seed` sets the sensors' noise. There are no options."""
        super().reset(seed=seed)
        self._simulator = ReefSimulator(self.world, self.cfg, self.np_random)
        self._localizer = Localizer(self.cfg.camera, self._localization)
        self._steps = self._collisions = 0
        self._covered = self._coverage()
        return self._observe(0.0), self._info()

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive for one control period.

        Raises:
            ValueError: The action is not two finite numbers; the pose would be nan for ever after.
        """
        asked = np.asarray(action, float)
        if asked.shape != (2,) or not np.isfinite(asked).all():
            raise ValueError(f"action: found {asked.tolist()}, expected two finite numbers")
        forward, turn = np.clip(asked, -1.0, 1.0)
        vehicle = self.cfg.vehicle
        command = float(forward) * vehicle.max_speed_m_s, float(turn) * vehicle.max_yaw_rate_rad_s
        contacts = len(self._simulator.act(command, self._period_s))
        self._steps, self._collisions = self._steps + 1, self._collisions + contacts
        before, self._covered = self._covered, self._coverage()
        done = self._simulator.coverage.coverage == 1.0
        reward = self._covered - before - COLLISION_COST * contacts
        return self._observe(self._period_s), reward, done, self._steps >= self._limit, self._info()

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override]
        """Return the camera's classes as a picture, Shape=(H, W, 3); None without a render mode."""
        frame = self._frame
        if self.render_mode is None or frame is None:
            return None
        return np.asarray(COLORS[frame.labels]) if frame.rgb is None else frame.rgb

    def _coverage(self) -> float:
        """Return the mean of the clusters' shares seen, of what counts as covered; 0 to 1."""
        meter = self._simulator.coverage
        shares = np.where(meter.covered(), 1.0, np.minimum(meter.fractions / meter.cfg.threshold, 1.0))
        return float(shares.sum()) / max(len(shares), 1)

    def _observe(self, dt: float) -> Observation:
        seen = self._simulator.sense(self._steps * self._period_s, dt)
        assert seen.frame is not None
        assert seen.pose is not None
        assert seen.velocity is not None
        frame = self._frame = seen.frame.value
        pose = np.array(self._localizer.update(frame, seen.pose.value, dt))
        pose[2] = math.remainder(pose[2], 2 * math.pi)
        depth = np.where(np.isfinite(frame.depth), frame.depth, self.cfg.camera.range_m)
        return {
            "depth": np.clip(depth, 0.0, self.cfg.camera.range_m).astype(np.float32),
            "labels": frame.labels.astype(np.uint8),
            "pose": self._within("pose", pose),
            "velocity": self._within("velocity", np.array(seen.velocity.value)),
        }

    def _within(self, name: str, values: NDArray[np.float64]) -> NDArray[np.float32]:
        space = self._boxes[name]
        return np.asarray(np.clip(values.astype(np.float32), space.low, space.high))

    def _info(self) -> dict[str, Any]:
        """Return time, and under `truth` what only the experimenter knows."""
        covered = self._simulator.coverage.covered()
        truth = {
            "pose": np.array(self._simulator.pose),
            "clusters_covered": int(covered.sum()),
            "clusters_total": len(covered),
            "collisions": self._collisions,
        }
        return {"time_s": round(self._steps * self._period_s, 9), "truth": truth}
