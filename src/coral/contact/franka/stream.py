"""The stream to an arm: at every tick it reads the state, checks every reason to stop, and sends the target."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from coral.contact.franka.franky_arm import ArmError, ArmState, FrankyArm
from coral.contact.franka.hand_gaps import Gap, HandGaps
from coral.contact.franka.limits import Limits
from coral.contact.franka.object_poses import ObjectPoses
from coral.contact.scene.observation import Array, BodyState, HandTarget
from coral.contact.worlds.franka_cfg import FrankaCfg

HOLDING_N_M = 600.0
"""Stiffness with which the arm holds until the first target."""
PRESSING_S = 0.15
"""Time constant that distinguishes a contact from a blow: a pull that followed the force at once would add to it."""


class Phase(IntEnum):
    """What the stream does."""

    WATCHING = 0
    """It reads; the arm gets no command."""
    GOING = 1
    """The arm goes to its start posture."""
    TARING = 2
    """The arm rests there, and the wrench's bias is measured."""
    FOLLOWING = 3
    """The arm follows targets; without a new one it holds the last."""
    STOPPED = 4
    """The arm was stopped. Nothing but a new stream moves it again."""


class StopCause(IntEnum):
    """Why the arm was stopped."""

    NONE = 0
    END = 1
    KEYBOARD = 2
    PAGE = 3
    LIMIT = 4
    POSES = 5
    LINK = 6
    WATCHDOG = 7
    FAULT = 8


@dataclass(frozen=True)
class Orders:
    """What the program wants of the stream."""

    beat: int = 0
    """Counts up as a sign of life."""
    start: bool = False
    """Whether the arm may move: set once, after the operator's word."""
    stop: StopCause = StopCause.NONE
    quit: bool = False
    """Whether the stream ends, once the arm is stopped."""
    target: HandTarget | None = None
    """Newest target in the arm's base frame."""


@dataclass(frozen=True)
class StreamReport:
    """What the stream tells the program after a tick."""

    phase: Phase = Phase.WATCHING
    cause: StopCause = StopCause.NONE
    state: ArmState | None = None
    """What the arm measures, in its base frame; None before the first state."""
    tool: BodyState | None = None
    """The tool in the world."""
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    """Shape=(6,), filtered, without its bias."""
    objects: Mapping[str, BodyState] = field(default_factory=dict)
    """Newest pose of each object that was seen, in the world."""
    ages_s: Mapping[str, float] = field(default_factory=dict)
    """Ages of these poses."""

    @property
    def time_s(self) -> float:
        """Return the arm's clock; -1 before the first state."""
        return -1.0 if self.state is None else self.state.time_s


class Stream:
    """Runs one arm, one `tick` at a time; it never waits. `clock` returns the machine's time (s)."""

    def __init__(
        self,
        arm: FrankyArm,
        poses: ObjectPoses,
        cfg: FrankaCfg,
        clock: Callable[[], float],
        hand_gaps: HandGaps | None = None,
    ) -> None:
        self._arm, self._poses, self._cfg, self._clock = arm, poses, cfg, clock
        self._hand_gaps, self._limits = hand_gaps, Limits(cfg)
        self._readings: list[Array] = []
        self._bias = np.zeros(6)
        self.phase, self.cause, self.reason = Phase.WATCHING, StopCause.NONE, ""
        self.state: ArmState | None = None
        self.wrench = np.zeros(6)
        self.target: HandTarget | None = None
        self._beat, self._beat_at = -1, clock()
        self._fresh_at = clock()
        self._filtered: Array | None = None
        self._pressing = np.zeros(3)

    @property
    def arm_time_s(self) -> float:
        """Return the arm's clock, by which poses age: a simulated arm may be slower than the machine's."""
        return 0.0 if self.state is None else self.state.time_s

    @property
    def stopped(self) -> bool:
        """Whether the arm was stopped."""
        return self.phase is Phase.STOPPED

    def report(self) -> StreamReport:
        """Return what the program is told."""
        poses, now = self._poses.poses, self.arm_time_s
        ages = {name: self._poses.age_s(name, now) for name in poses}
        return StreamReport(self.phase, self.cause, self.state, self._tool(), self.wrench, dict(poses), ages)

    def tick(self, orders: Orders) -> None:
        """Read, check and command once."""
        now = self._clock()
        if orders.beat != self._beat:
            self._beat, self._beat_at = orders.beat, now
        self._read(now)
        self._poses.update(self.arm_time_s, self._tool())
        if self.stopped:
            return
        if orders.stop is not StopCause.NONE:
            self.stop(orders.stop, "")
        elif self.phase is not Phase.WATCHING:
            self._check(now)
        if self.stopped:
            return
        try:
            self._command(orders)
        except ArmError as error:
            self.stop(StopCause.FAULT, str(error))

    def stop(self, cause: StopCause, reason: str) -> None:
        """Stop the arm; only the first cause counts. The reason is what was found, in words."""
        if self.phase is Phase.STOPPED:
            return
        moved = self.phase is not Phase.WATCHING
        self.phase, self.cause, self.reason = Phase.STOPPED, cause, reason
        if moved:  # an arm that was only watched obeys somebody else
            self._arm.stop()

    @property
    def _bias_known(self) -> bool:
        return len(self._readings) >= self._cfg.bias_readings

    def _tool(self) -> BodyState | None:
        if (state := self.state) is None:
            return None
        position = state.position + np.asarray(self._cfg.base_m)
        return BodyState(position, state.quaternion, state.twist[:3], state.twist[3:])

    def _read(self, now: float) -> None:
        try:
            state = self._arm.read()
        except ArmError as error:
            if self.phase not in (Phase.STOPPED, Phase.WATCHING):
                self.stop(StopCause.LINK, str(error))
            return
        before = self.state
        if before is None or state.time_s != before.time_s:
            self._fresh_at = now
            passed = 0.0 if before is None else max(0.0, state.time_s - before.time_s)
            self._filter(state.wrench, passed)
        self.state = state

    def _filter(self, wrench: Array, passed_s: float) -> None:
        if self._filtered is None or self._cfg.wrench_filter_s <= 0.0:
            self._filtered = np.array(wrench)
        else:
            self._filtered += (1.0 - np.exp(-passed_s / self._cfg.wrench_filter_s)) * (wrench - self._filtered)
        self.wrench = self._filtered - self._bias
        self._pressing += (1.0 - np.exp(-passed_s / PRESSING_S)) * (self.wrench[:3] - self._pressing)

    def _check(self, now: float) -> None:
        cfg, state = self._cfg, self.state
        if state is None or now - self._fresh_at > cfg.link_timeout_s:
            self.stop(StopCause.LINK, f"no new state for {1e3 * (now - self._fresh_at):.0f} ms")
        elif state.fault:
            self.stop(StopCause.FAULT, state.fault)
        elif now - self._beat_at > cfg.watchdog_s:
            self.stop(StopCause.WATCHDOG, f"no sign of life for {now - self._beat_at:.2f} s")
        elif found := self._limits.violation(state, self.wrench if self._bias_known else np.zeros(6)):
            self.stop(StopCause.LIMIT, found)
        elif self.phase is Phase.FOLLOWING:
            name, age = self._poses.oldest(self.arm_time_s)
            if age > cfg.poses_timeout_s:
                self.stop(StopCause.POSES, f"{name} was not seen for {age:.2f} s")

    def _command(self, orders: Orders) -> None:
        cfg, state = self._cfg, self.state
        if self.phase is Phase.WATCHING:
            if orders.start and state is not None:
                self.phase = Phase.GOING
                self._arm.open_to(0.08)
                self._arm.go_to(np.asarray(cfg.start_rad))
        elif self.phase is Phase.GOING:
            if self._arm.arrived():
                self.phase = Phase.TARING
        elif self.phase is Phase.TARING:
            if self._filtered is not None:
                self._readings.append(self._filtered.copy())
            if self._bias_known and state is not None:
                # Friction and an inexact load show as a bias that changes with the posture, so it is taken here.
                self._bias = np.mean(self._readings, axis=0)
                self.phase = Phase.FOLLOWING
                self.target = HandTarget(state.position, state.quaternion, state.opening_m, HOLDING_N_M)
                self._arm.follow(self.target)
        elif state is not None:
            if orders.target is not None:
                self.target = orders.target
            if self.target is not None:
                self._arm.open_to(self.target.opening_m)
                gaps = self._gaps(state)
                self._arm.follow(self._limits.bounded(self.target, state, self.wrench, gaps, self._pressing))

    def _gaps(self, state: ArmState) -> Sequence[Gap]:
        tool = self._tool()
        if self._hand_gaps is None or tool is None:
            return ()
        return self._hand_gaps.gaps(tool, state.opening_m, self._poses.poses, self._limits.gap_m)
