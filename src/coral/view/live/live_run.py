"""The viewer of a run, from before its first step until Ctrl-C after its end."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path

from coral.contact.episode.episode import Episode
from coral.contact.worlds.robot_world import in_real_time
from coral.reef.mission.mission import Mission
from coral.view.live.controls import Controls, RunControls
from coral.view.live.pace import Pace
from coral.view.live.viewer import Sketch, Viewer
from coral.view.live.watching import WatchedRun, reef_sketch, task_sketch


@contextmanager
def watching_run(
    folder: Path,
    what: str,
    sketch: Sketch,
    controls: Callable[[Pace], Controls],
    *,
    port: int,
    speed: float,
    wait: bool,
    real_time: bool = False,
) -> Iterator[list[WatchedRun]]:
    """Give the observer that shows a run in a browser.

    Args:
        folder: Run folder.
        what: Name of the run for the terminal: mission or task.
        sketch: Draws its plan.
        controls: Makes the buttons.
        port: Port of the page; 0 chooses one.
        speed: Speed limit, in multiples of real time; 0 for none.
        wait: Whether the run waits for the first viewer, and the page stays after its end.
        real_time: Whether it keeps its own time.
    """
    pace = Pace(speed)
    with Viewer(folder, controls(pace), port=port, flag="--live-port") as viewer:
        if wait:
            viewer.wait_for_viewer(what)
        else:
            print(f"watch the {what} at {viewer.url}", file=sys.stderr, flush=True)
        yield [WatchedRun(viewer, pace, sketch, real_time=real_time)]
        if wait:
            viewer.stay()


def watching_mission(
    mission: Mission, *, port: int, speed: float, wait: bool
) -> AbstractContextManager[list[WatchedRun]]:
    """Give the observer that shows a mission; see `watching_run`."""
    buttons = partial(RunControls, instruct=mission.instructing)
    return watching_run(mission.writer.folder, "mission", reef_sketch, buttons, port=port, speed=speed, wait=wait)


def watching_task(episode: Episode, *, port: int, speed: float, wait: bool) -> AbstractContextManager[list[WatchedRun]]:
    """Give the observer that shows a contact task; see `watching_run`."""
    world = episode.world
    buttons = partial(RunControls, what="task", weights=episode.weights, stop_now=getattr(world, "stop_now", None))
    return watching_run(
        episode.writer.folder,
        "task",
        task_sketch,
        buttons,
        port=port,
        speed=speed,
        wait=wait,
        real_time=in_real_time(world),
    )
