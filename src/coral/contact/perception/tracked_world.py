"""An evaluation world in which object poses come from a camera's pictures, delayed and noisy."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.object_model import from_trial
from coral.contact.perception.symmetry import PoseDifference, compare_poses
from coral.contact.perception.tracked_cfg import TrackedCfg, make_camera
from coral.contact.perception.tracked_object import TrackedObject
from coral.contact.perception.tracker import PoseEstimate, TrackerFailed
from coral.contact.scene.geometry import (
    body_to_matrix,
    from_rpy_deg,
    inverse_transform,
    matrix_to_body,
    pose_matrix,
    quaternion_of,
    rotation_about,
    rotation_of,
)
from coral.contact.scene.observation import Array, BodyState, HandTarget, Observation, Truth
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import EvaluationWorld, WrappedWorld
from coral.contact.worlds.robot_world import WorldError
from coral.errors import InputError


class TrackedWorld(WrappedWorld):
    """Wraps a world with a simulation: object poses come from a tracker, the robot's own measurements stay unchanged.

    Of the trial, prior knowledge is used: shapes, symmetries and the task's ranges.

    Raises:
        InputError: The world has no pictures.
        TrackerFailed: The tracker's server does not answer.
    """

    def __init__(self, world: EvaluationWorld, trial: Trial, cfg: TrackedCfg, rng: np.random.Generator) -> None:
        super().__init__(world)
        self._trial, self.cfg, self._rng = trial, cfg, rng
        if world.simulation is None:
            raise InputError("--poses", "", "'tracked'", "ground-truth, in a world of which no pictures can be made")
        model, self._data = world.simulation.model, world.simulation.data
        self._choice = cfg.choice()
        self._choice.check()
        self.tracker = self._choice.name
        self._eye = make_camera(model, trial, cfg)
        self._shapes = {name: from_trial(model, trial, name) for name in trial.objects}
        self._wanted = {
            str(getattr(condition, key, ""))
            for condition in trial.task.success.conditions
            for key in ("object", "other", "thing")
        }
        """Objects that the task's conditions name."""
        self._objects: dict[str, TrackedObject] = {}
        self._unseen: set[str] = set()
        self._news: list[dict[str, Any]] = []

    def reset(self) -> Observation:
        """See `RobotWorld.reset`; the hand waits until every object is found, at most `search_s`.

        An object that is hidden then is looked for further; until it is seen its pose is a guess from the task file.

        Raises:
            WorldError: No object was found ("not-found"), there are no pictures ("camera-off"), or no poses
                ("tracker-failed").
        """
        now = self._world.reset()
        self._close_trackers()
        for name, shape in self._shapes.items():
            with _as_world_error():
                tracker = self._choice.make(shape, nominal_pose(self._trial, name))
            self._objects[name] = TrackedObject(tracker)
        self._late: deque[tuple[float, Array, dict[str, PoseEstimate]]] = deque()
        self._pictured_s, self._due_s, self._retreated_s = now.time_s, now.time_s, -np.inf
        self._news.clear()
        self._unseen.clear()
        rest = HandTarget(now.tool.position, now.tool.quaternion, now.opening_m, 600.0)
        taken = 0
        while True:
            missing = self._find(now, self._take(now))
            taken += 1
            if taken < self.cfg.first_pictures:
                continue
            self._due_s = now.time_s + self.cfg.period_s
            if not missing:
                return self._with_estimates(now)
            if now.time_s >= self.cfg.search_s - 1e-9 and len(missing) < len(self._objects):
                self._guess(missing, now.time_s)
                return self._with_estimates(now)
            if now.time_s >= self.cfg.search_s - 1e-9:
                what = ", ".join(f"{name} ({reason})" for name, reason in missing.items())
                raise WorldError("not-found", f"not found in {self.cfg.search_s:g} s: {what}")
            while now.time_s < self._due_s - 1e-9:
                now = self._world.step(rest)

    def step(self, target: HandTarget) -> Observation:
        """See `RobotWorld.step`.

        Raises:
            WorldError: The world failed, or there are no more pictures ("camera-off") or poses ("tracker-failed").
        """
        now = self._world.step(target)
        tool = body_to_matrix(now.tool)
        self._deliver(now.time_s)
        for name, one in self._objects.items():
            if name not in self._unseen:
                one.feel(self._shapes[name], tool, now.opening_m, target.opening_m, now.time_s)
        if now.time_s >= self._due_s - 1e-9:
            self._due_s += self.cfg.period_s
            frame = self._take(now)
            if frame is not None:
                estimates = {}
                with _as_world_error():
                    for name, one in self._objects.items():
                        guess = None if name in self._unseen else one.at(tool, now.time_s)
                        estimates[name] = one.tracker.track(frame, frame.mask(name), guess)
                self._late.append((now.time_s, tool, estimates))
                if self.cfg.latency_s == 0.0:
                    self._deliver(now.time_s)
        return self._with_estimates(now)

    def close(self) -> None:
        """See `RobotWorld.close`."""
        self._close_trackers()
        super().close()

    def news(self) -> list[dict[str, Any]]:
        """Return the objects lost and found since the last call, as fields of events."""
        said, self._news = self._news, []
        return said

    def retreat(self, target: HandTarget, now: Observation) -> HandTarget:
        """Replace the target by one straight above the hand while an object of the task's goal has been lost too long.

        A hand that occludes it would otherwise push on towards its last known pose. Another object of the scene may
        stay hidden behind the arm: a hand that retreats from it again and again reaches nothing.
        """
        cfg = self.cfg
        lost = [
            one.lost_since
            for name, one in self._objects.items()
            if name in self._wanted and one.lost_since is not None and not one.held and name not in self._unseen
        ]
        begun = max(min(lost, default=np.inf), self._retreated_s) + cfg.retreat_after_s
        if not cfg.retreat_after_s or now.time_s < begun:
            return target
        if now.time_s >= begun + cfg.retreat_s:
            self._retreated_s = now.time_s
            return target
        lead = np.array([0.0, 0.0, 0.2 * cfg.retreat_m_s])
        return HandTarget(now.tool.position + lead, now.tool.quaternion, target.opening_m, target.stiffness)

    def compare(self, now: Observation, truth: Truth) -> dict[str, PoseDifference]:
        """Compute the errors of the estimated poses; for the record only."""
        return {
            name: compare_poses(
                shape.symmetry, now.objects[name], truth.objects[name], self._objects[name].lost_since is not None
            )
            for name, shape in self._shapes.items()
        }

    def _guess(self, missing: Mapping[str, str], time_s: float) -> None:
        """Give objects that no picture has shown yet the pose in the middle of the task file's ranges."""
        for name, reason in missing.items():
            T = nominal_pose(self._trial, name)
            z = self._trial.task.object(name).z
            T[2, 3] = -self._trial.lowest_point(name, matrix_to_body(T)) if z is None else z
            one = self._objects[name]
            one.begin(T, time_s)
            one.lost_since = time_s
            self._unseen.add(name)
            self._news.append({"object": name, "lost": True, "reason": reason, "held": False})

    def _find(self, now: Observation, frame: RgbdFrame | None) -> dict[str, str]:
        """Update every object before the clock starts; return those not found yet, with reasons."""
        missing = {}
        for name, one in self._objects.items():
            with _as_world_error():
                estimate = None if frame is None else one.tracker.track(frame, frame.mask(name))
            if estimate is None or estimate.lost:
                if one.motion is None:
                    missing[name] = "no picture" if estimate is None else estimate.reason
            else:
                one.measure(estimate, body_to_matrix(now.tool), now.time_s)
        return missing

    def _close_trackers(self) -> None:
        for one in self._objects.values():
            one.tracker.close()
        self._objects.clear()

    def _take(self, now: Observation) -> RgbdFrame | None:
        frame = self._eye.take(self._data, self._rng)
        if frame is not None and frame.depth.any():
            self._pictured_s = now.time_s
            return frame
        if now.time_s - self._pictured_s >= self.cfg.blind_s - 1e-9:
            raise WorldError("camera-off", f"no picture since {self._pictured_s:.2f} s")
        return None

    def _deliver(self, time_s: float) -> None:
        """Update the filters with the poses whose latency has passed."""
        while self._late and self._late[0][0] + self.cfg.latency_s <= time_s + 1e-9:
            taken_s, tool, estimates = self._late.popleft()
            for name, estimate in estimates.items():
                self._measure(name, estimate, tool, taken_s, time_s)

    def _measure(self, name: str, estimate: PoseEstimate, tool: Array, taken_s: float, time_s: float) -> None:
        one = self._objects[name]
        if estimate.lost:
            if one.lost_since is None:
                one.lost_since = time_s
                self._news.append({"object": name, "lost": True, "reason": estimate.reason, "held": one.held})
                one.known.stop()
            return
        T = inverse_transform(tool) @ estimate.T_world_object if one.held else estimate.T_world_object
        if one.lost_since is not None:
            self._unseen.discard(name)
            self._news.append({"object": name, "lost": False, "after_s": round(time_s - one.lost_since, 3)})
            one.lost_since = None
            one.begin(T, taken_s)
        else:
            one.known.update(T, taken_s)

    def _with_estimates(self, now: Observation) -> Observation:
        tool = body_to_matrix(now.tool)
        objects = {name: self._body(one, now.tool, tool, now.time_s) for name, one in self._objects.items()}
        unseen = frozenset(self._unseen)
        lost = {name for name, one in self._objects.items() if one.lost_since is not None and not one.held} - unseen
        return Observation(now.time_s, now.tool, now.opening_m, now.wrench, objects, unseen, frozenset(lost))

    def _body(self, one: TrackedObject, hand: BodyState, tool: Array, time_s: float) -> BodyState:
        T = one.at(tool, time_s)
        velocity, spin = one.known.velocity, one.known.spin
        if one.held:
            lever = T[:3, 3] - hand.position
            velocity = tool[:3, :3] @ velocity + hand.velocity + np.cross(hand.angular_velocity, lever)
            spin = tool[:3, :3] @ spin + hand.angular_velocity
        return BodyState(T[:3, 3], quaternion_of(T[:3, :3]), velocity, spin)


@contextmanager
def _as_world_error() -> Iterator[None]:
    """Raise a tracker's failure as an error of the world."""
    try:
        yield
    except TrackerFailed as error:
        raise WorldError("tracker-failed", str(error)) from None


def nominal_pose(trial: Trial, name: str) -> Array:
    """Return T_world_object in the middle of the task file's ranges; of equal poses the nearest one is reported."""
    item = trial.task.object(name)
    turn = rotation_about(np.array([0.0, 0.0, 1.0]), float(np.radians(np.mean(item.yaw_deg))))
    middle = np.array([np.mean(item.x), np.mean(item.y), 0.0])
    return pose_matrix(turn @ rotation_of(from_rpy_deg(item.rpy_deg)), middle)
