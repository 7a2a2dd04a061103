"""The live page of a contact task, for the length of one episode."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from coral.contact.worlds.franka.stream import StopCause
from coral.contact.worlds.franka.world import FrankaWorld
from coral.errors import InputError

if TYPE_CHECKING:
    from coral.contact.episode.episode import Episode
    from coral.view.live.live_task import LiveTask


@dataclass(frozen=True, kw_only=True)
class LiveFlags:
    """The flags of the page."""

    live: bool
    port: int
    speed: float

    def check(self) -> None:
        """Check the flags before anything is made.

        Raises:
            InputError: A flag is out of range, or the port is in use.
        """
        if not self.live:
            return
        from coral.view.live.page import check_free

        if not self.speed >= 0:
            raise InputError("--live-speed", "", self.speed, "a number from 0 on")
        check_free(self.port, "--live-port")


@contextmanager
def watching(episode: Episode, flags: LiveFlags) -> Iterator[list[LiveTask]]:
    """Give the observer that shows an episode in a browser; none without `--live`."""
    if not flags.live:
        yield []
        return
    from coral.view.live.live_task import LiveTask
    from coral.view.live.pace import Pace
    from coral.view.live.page import LivePage
    from coral.view.live.task_controls import TaskControls

    world = episode.world
    stop_now = (lambda: world.stream.stop(StopCause.PAGE)) if isinstance(world, FrankaWorld) else None
    pace = Pace(flags.speed)
    controls = TaskControls(pace, episode.weights, stop_now)
    with LivePage(flags.port, controls, label="CORAL task", flag="--live-port") as page:
        print(f"watch the task at {page.url}", file=sys.stderr, flush=True)
        yield [LiveTask(episode, page, pace, controls)]
