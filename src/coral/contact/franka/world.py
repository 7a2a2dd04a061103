"""A Franka arm as a robot's world: an episode's targets go to the stream, its reports come back as observations."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from coral.contact.franka.double import Double
from coral.contact.franka.stream import Phase, StopCause, StreamReport
from coral.contact.franka.stream_process import StreamProcess
from coral.contact.real_scenes.hand_mask import HandReading
from coral.contact.scene.geometry import body_to_matrix
from coral.contact.scene.observation import HandTarget, Observation, Truth
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.contact.worlds.robot_world import WorldError
from coral.errors import RunError

if TYPE_CHECKING:
    from coral.contact.franka.camera_process import CameraProcess

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


class FrankaWorld:
    """An arm, real or simulated, as its sensors show it. Its time passes between steps.

    The simulated arm (`double`) and a camera of ours, which is told where the hand is, end with the stream. In a dry
    run the arm is only read: commands are not sent, and `show` receives a line for them five times a second.
    """

    name = "franka"
    in_real_time = True

    def __init__(
        self,
        stream: StreamProcess,
        cfg: FrankaCfg,
        control_period_s: float,
        objects: Sequence[str],
        *,
        double: Double | None = None,
        camera: CameraProcess | None = None,
        dry_run: bool = False,
        show: Callable[[str], None] | None = None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.control_period_s, self.stream, self.double, self._camera = control_period_s, stream, double, camera
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
        report = self._wait(lambda found: found.phase is wanted and found.state is not None, _START_TIMEOUT_S)
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
        if self._dry_run:
            self._tell(target)
        else:
            self.stream.follow(replace(target, position=target.position - self._base))
        now = self._wait(lambda found: True, _SILENCE_S)
        if self._camera is not None and not self._dry_run and now.state is not None and now.tool is not None:
            self._camera.tell_hand(HandReading(body_to_matrix(now.tool), now.state.opening_m, target.opening_m))
        # After a pause, in which the arm has held its target, steps are not made up for.
        self._due_s = max(self._due_s, now.time_s - self.control_period_s) + self.control_period_s
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
        for part in (self.stream, self._camera, self.double):
            if part is not None:
                part.close()

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
                reason = self.stream.reason() or report.cause.name.lower()
                failure = "" if self._camera is None else self._camera.failure()
                raise WorldError(CODES[report.cause], f"{reason}: {failure}" if failure else reason)
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
        assert report.state is not None
        assert report.tool is not None
        objects = {name: report.objects[name] for name in self._objects}
        time_s, opening_m = report.time_s - self._began_s, report.state.opening_m
        return Observation(time_s, report.tool, opening_m, report.wrench, objects)


class FrankaDoubleWorld(FrankaWorld):
    """A simulated arm, whose truth the judge may ask for."""

    def truth(self) -> Truth:
        """Return the true state, by which success is judged; its time is that of the last observation."""
        assert self.double is not None
        return replace(self.double.truth(), time_s=self._seen_s - self._began_s)
