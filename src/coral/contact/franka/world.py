"""A Franka arm as a robot's world: an episode's targets go to the stream, its reports come back as observations."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from coral.contact.franka.double import Double
from coral.contact.franka.stream import Phase, StopCause
from coral.contact.franka.stream_record import StreamReport
from coral.contact.scene.observation import BodyState, HandTarget, Observation, Truth
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.contact.worlds.robot_world import WorldError
from coral.errors import RunError

CODES = {
    StopCause.END: "stopped by the operator",
    StopCause.KEYBOARD: "stopped by the operator",
    StopCause.PAGE: "stopped by the operator",
    StopCause.LIMIT: "limit",
    StopCause.POSES: "poses-lost",
    StopCause.LINK: "link-lost",
    StopCause.WATCHDOG: "watchdog",
    StopCause.FAULT: "arm-fault",
}
"""The end reason of an episode for each cause of a stop."""
POLL_S = 0.002
LINE_EVERY_S = 0.2
"""Time between the lines of a dry run; the run folder has every command."""
_START_TIMEOUT_S = 300.0
_SILENCE_S = 5.0


class StreamHandle(Protocol):
    """What the world needs of a stream; see `StreamProcess`."""

    def start(self) -> None:
        """Let the arm move."""
        ...

    def follow(self, target: HandTarget) -> None:
        """Set the target, in the arm's base frame."""
        ...

    def stop(self, cause: StopCause) -> None:
        """Ask for a stop."""
        ...

    def report(self) -> StreamReport:
        """Return the newest report."""
        ...

    def reason(self) -> str:
        """Return why the arm was stopped, in words."""
        ...

    def close(self) -> None:
        """Stop the arm and end the stream."""
        ...


class FrankaWorld:
    """An arm, real or simulated, as its sensors show it. Its time passes between steps.

    Args:
        stream: The stream to the arm.
        cfg: Configuration of the arm.
        control_period_s: Duration of one step, by the arm's clock.
        objects: The objects of the task.
        dry_run: Commands are shown and not sent; the arm is only read.
        show: Receives a line for the command that is not sent, five times a second.
        sleep: Waits for a number of seconds; for tests.
    """

    name = "franka"
    in_real_time = True

    def __init__(
        self,
        stream: StreamHandle,
        cfg: FrankaCfg,
        control_period_s: float,
        objects: Sequence[str],
        *,
        dry_run: bool = False,
        show: Callable[[str], None] | None = None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.control_period_s, self.stream = control_period_s, stream
        self._objects, self._dry_run, self._show, self._sleep = tuple(objects), dry_run, show, sleep
        self._base = np.asarray(cfg.base_m)
        self._began_s = self._due_s = self._seen_s = self._next_line_s = 0.0

    def reset(self) -> Observation:
        """See `RobotWorld.reset`.

        Raises:
            WorldError: The arm was stopped on its way, or an object is not seen.
        """
        if not self._dry_run:
            self.stream.start()
        wanted = Phase.WATCHING if self._dry_run else Phase.FOLLOWING
        report = self._wait(lambda found: found.phase is wanted and found.time_s >= 0.0, _START_TIMEOUT_S)
        unseen = [name for name in self._objects if name not in report.objects]
        if unseen:
            raise WorldError("not-found", f"no pose of {', '.join(unseen)} has arrived")
        self._began_s = self._due_s = self._seen_s = self._next_line_s = report.time_s
        return self._observe(report)

    def step(self, target: HandTarget) -> Observation:
        """See `RobotWorld.step`.

        Raises:
            WorldError: The arm was stopped.
        """
        local = replace(target, position=target.position - self._base)
        if self._dry_run:
            self._tell(target)
        else:
            self.stream.follow(local)
        before = self._wait(lambda found: True, _SILENCE_S).time_s
        # After a pause, in which the arm has held its target, steps are not made up for.
        self._due_s = max(self._due_s, before - self.control_period_s) + self.control_period_s
        # Where states come less often than steps, each step waits for a new one.
        report = self._wait(
            lambda found: found.time_s >= self._due_s - 1e-9 and found.time_s > self._seen_s, _SILENCE_S
        )
        self._seen_s = report.time_s
        return self._observe(report)

    def stop(self) -> None:
        """See `RobotWorld.stop`."""
        self.stream.stop(StopCause.END)

    def stop_now(self) -> None:
        """Stop the arm at once: the button of the live page."""
        self.stream.stop(StopCause.PAGE)

    def close(self) -> None:
        """See `RobotWorld.close`."""
        self.stream.close()

    def _wait(self, ready: Callable[[StreamReport], bool], silence_s: float) -> StreamReport:
        """Return the first report that is ready.

        Raises:
            WorldError: The arm was stopped, or nothing came for this long (s, machine's time).
        """
        waited = 0.0
        while True:
            try:
                report = self.stream.report()
            except RunError as error:
                raise WorldError("link-lost", str(error)) from None
            if report.phase is Phase.STOPPED:
                raise WorldError(CODES[report.cause], self.stream.reason() or report.cause.name.lower())
            if ready(report):
                return report
            if waited > silence_s:
                self.stream.stop(StopCause.LINK)
                raise WorldError("link-lost", f"the arm's clock stood still for {silence_s:.0f} s")
            self._sleep(POLL_S)
            waited += POLL_S

    def _tell(self, target: HandTarget) -> None:
        if self._show is not None and self._due_s >= self._next_line_s:
            self._next_line_s = self._due_s + LINE_EVERY_S
            x, y, z = target.position
            self._show(
                f"{self._due_s - self._began_s:6.2f} s: tool to {x:+.3f} {y:+.3f} {z:+.3f} m, "
                f"opening {1e3 * target.opening_m:.0f} mm, {target.stiffness:.0f} N/m (not sent)"
            )

    def _observe(self, report: StreamReport) -> Observation:
        tool = replace(report.tool, position=report.tool.position + self._base)
        objects: dict[str, BodyState] = {name: report.objects[name] for name in self._objects}
        return Observation(report.time_s - self._began_s, tool, report.opening_m, report.wrench, objects)


class FrankaDoubleWorld(FrankaWorld):
    """A simulated arm, whose truth the judge may ask for.

    Args:
        stream, cfg, control_period_s, objects: See `FrankaWorld`.
        double: The simulated arm.
        dry_run, show, sleep: See `FrankaWorld`.
    """

    def __init__(
        self,
        stream: StreamHandle,
        cfg: FrankaCfg,
        control_period_s: float,
        objects: Sequence[str],
        double: Double,
        *,
        dry_run: bool = False,
        show: Callable[[str], None] | None = None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        super().__init__(stream, cfg, control_period_s, objects, dry_run=dry_run, show=show, sleep=sleep)
        self.double = double

    def truth(self) -> Truth:
        """Return the true state, by which success is judged; its time is that of the last observation."""
        found = self.double.truth()
        return replace(found, time_s=self._seen_s - self._began_s)

    def close(self) -> None:
        """See `RobotWorld.close`."""
        super().close()
        self.double.close()
