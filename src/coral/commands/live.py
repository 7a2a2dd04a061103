"""`--live`: the viewer of a run, from before its first step until Ctrl-C after its end."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from coral.errors import InputError

if TYPE_CHECKING:
    from coral.contact.episode.episode import Episode
    from coral.reef.mission.mission import Mission
    from coral.view.live.controls import Controls
    from coral.view.live.pace import Pace
    from coral.view.live.viewer import Sketch
    from coral.view.live.watching import WatchedRun


@dataclass(frozen=True, kw_only=True)
class LiveFlags:
    """The flags of the page."""

    live: bool
    port: int
    speed: float
    wait: bool = True
    """Whether the run waits for the first viewer, and the page stays after its end."""

    def check(self) -> None:
        """Check the flags before anything is made.

        Raises:
            InputError: A flag is out of range, or the port is in use.
        """
        if not self.live:
            return
        from coral.web import check_free

        if not self.speed >= 0:
            raise InputError("--live-speed", "", self.speed, "a number from 0 on")
        check_free(self.port, "--live-port")


@contextmanager
def watching(
    flags: LiveFlags,
    folder: Path,
    what: str,
    sketch: Sketch,
    controls: Callable[[Pace], Controls],
    *,
    real_time: bool = False,
) -> Iterator[list[WatchedRun]]:
    """Give the observer that shows a run in a browser; none without `--live`.

    Args:
        flags: The flags.
        folder: Run folder.
        what: Name of the run for the terminal: mission or task.
        sketch: Draws its plan.
        controls: Makes the buttons.
        real_time: Whether it keeps its own time.
    """
    if not flags.live:
        yield []
        return
    from coral.view.live.pace import Pace
    from coral.view.live.viewer import Viewer
    from coral.view.live.watching import WatchedRun

    pace = Pace(flags.speed)
    with Viewer(folder, controls(pace), port=flags.port, flag="--live-port") as viewer:
        if flags.wait:
            viewer.wait_for_viewer(what)
        else:
            print(f"watch the {what} at {viewer.url}", file=sys.stderr, flush=True)
        yield [WatchedRun(viewer, pace, sketch, real_time=real_time)]
        if flags.wait:
            viewer.stay()


def watching_mission(flags: LiveFlags, mission: Mission) -> AbstractContextManager[list[WatchedRun]]:
    """Give the observer that shows a mission in a browser; none without `--live`."""
    from coral.view.live.controls import RunControls
    from coral.view.live.watching import reef_sketch

    return watching(flags, mission.writer.folder, "mission", reef_sketch, RunControls)


def watching_task(flags: LiveFlags, episode: Episode) -> AbstractContextManager[list[WatchedRun]]:
    """Give the observer that shows a contact task in a browser; none without `--live`."""
    from coral.contact.worlds.franka.stream import StopCause
    from coral.contact.worlds.franka.world import FrankaWorld
    from coral.contact.worlds.robot_world import in_real_time
    from coral.view.live.controls import RunControls
    from coral.view.live.watching import task_sketch

    world = episode.world
    stop_now = (lambda: world.stream.stop(StopCause.PAGE)) if isinstance(world, FrankaWorld) else None
    buttons = partial(RunControls, what="task", weights=episode.weights, stop_now=stop_now)
    return watching(flags, episode.writer.folder, "task", task_sketch, buttons, real_time=in_real_time(world))
