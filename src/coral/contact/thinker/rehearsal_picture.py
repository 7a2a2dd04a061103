"""Pictures of a rehearsal in rows of three, drawn from the planning world: what the plan's author would see."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.advisor.question import Picture
from coral.contact.control.planning_world import PlanningWorld
from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, look_at
from coral.contact.perception.scene_geoms import hidden_geoms, instance_names
from coral.contact.perception.tracked_cfg import TrackedCfg, viewpoint
from coral.contact.plan.imagined_run import ImaginedMoment
from coral.contact.scene.trial import Trial

MOST, ACROSS = 6, 3
"""Number of pictures, and how many stand side by side."""
SIZE = (320, 240)
"""Width and height of each, pixels."""


def draw_rehearsal(world: PlanningWorld, trial: Trial, moments: Sequence[ImaginedMoment]) -> Picture:
    """Draw evenly spread moments of a rehearsal side by side, each with its time and stage.

    Args:
        world: The planning world.
        trial: The trial as the robot knows it.
        moments: At least one.
    """
    model, _ = world.placed(moments[0].now)
    camera = RayCamera(
        model,
        RgbdCameraCfg(width=SIZE[0], height=SIZE[1]),
        look_at(*viewpoint(trial, TrackedCfg())),
        instance_names(model, trial),
        colours="shaded",
        hidden=hidden_geoms(model, trial),
    )
    tiles: list[NDArray[np.uint8]] = []
    for index in np.unique(np.linspace(0, len(moments) - 1, MOST).astype(int)):
        moment = moments[int(index)]
        frame = camera.take(world.placed(moment.now)[1])
        assert frame.rgb is not None
        tile: NDArray[np.uint8] = np.ascontiguousarray(frame.rgb[..., ::-1])
        text = f"{moment.now.time_s - moments[0].now.time_s:.1f} s {moment.stage}"
        for thickness, ink in ((3, (0, 0, 0)), (1, (255, 255, 255))):
            cv2.putText(tile, text, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.45, ink, thickness, cv2.LINE_AA)
        tiles.append(tile)
    done, data = cv2.imencode(".png", _in_rows(tiles), [cv2.IMWRITE_PNG_COMPRESSION, 6])
    assert done
    return Picture(
        name="rehearsal",
        png=bytes(data),
        caption="The rehearsal in the simulation, row by row, with times and stages.",
    )


def _in_rows(tiles: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Lay pictures out in rows; the last row is filled with black."""
    filled = [*tiles, *[np.zeros_like(tiles[0])] * (-len(tiles) % ACROSS)]
    rows = [np.concatenate(filled[k : k + ACROSS], axis=1) for k in range(0, len(filled), ACROSS)]
    return np.concatenate(rows, axis=0)
