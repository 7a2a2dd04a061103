"""The pictures of a reef question: map, segmentation and depth."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from coral.advisor.question import Picture
from coral.reef.decide.outlook import Outlook
from coral.reef.map.chain import spanning_tree
from coral.reef.pictures.cameraview import camera_picture
from coral.reef.pictures.floor_mosaic import seen_floor
from coral.reef.pictures.mapview import MapScene, draw_map, png
from coral.reef.pictures.things import things_picture


def map_scene(outlook: Outlook) -> MapScene:
    """Return the robot's own map, chain, trajectory and goal as a scene to draw."""
    belief, arrival = outlook.belief, outlook.arrival.pose
    chain = belief.tracker.chain()
    places = np.array([[t.x, t.y] for t in chain]).reshape(-1, 2)
    by_sight = belief.cfg.inspect.enabled
    return MapScene(
        cells=belief.map.cells(),
        cell_m=belief.map.cfg.cell_m,
        pose=belief.pose,
        trajectory=belief.trajectory,
        centroids=places,
        links=spanning_tree(places),
        seen=[None if t.far else t.inspected for t in chain] if by_sight else None,
        arrival=arrival if arrival != belief.pose else None,
        border=(0.0, 0.0, *belief.map.size_m),
        indices=[t.index for t in chain],
        visited=[outlook.done(t) for t in chain],
        clusters=belief.cfg.centroids,
        idle=outlook.idle,
        doubtful=[t.doubtful for t in chain],
        goal=belief.goal,
    )


def question_pictures(outlook: Outlook) -> tuple[Picture, ...]:
    """Draw map, segmentation and depth, as PNG; for a mission in words, what was seen in colour, too."""
    drawn = draw_map(map_scene(outlook))
    belief = outlook.belief
    pictures = [
        Picture(
            name="map",
            png=png(drawn.rgb),
            caption="occupancy map with the centroid chain, the robot and its trajectory",
            pixel_from_world=((drawn.scale, 0.0, drawn.left_px), (0.0, -drawn.scale, drawn.bottom_px)),
        )
    ]
    if belief.frame is not None:
        pictures += [
            Picture(
                name="segmentation",
                png=png(camera_picture(belief.frame, "segmentation")),
                caption="front camera, segmented",
            ),
            Picture(
                name="depth", png=png(camera_picture(belief.frame, "depth")), caption="front camera, depth in metres"
            ),
        ]
    frame = belief.frame
    if outlook.colours and frame is not None and (frame.still is not None or frame.rgb is not None):
        whole = frame.rgb if frame.still is None else frame.still()
        colour = cv2.resize(np.asarray(whole, np.uint8), (800, 600), interpolation=cv2.INTER_AREA)
        pictures.append(
            Picture(name="colour", png=png(np.asarray(colour, np.uint8)), caption="front camera, in colour")
        )
        if (things := things_picture(belief)) is not None:
            pictures.append(Picture(name="things", png=png(things), caption="the best colour picture of each dot"))
        if (floor := seen_floor(belief)) is not None:
            scene = replace(map_scene(outlook), floor=floor, links=(), trajectory=np.zeros((0, 2)))
            above = draw_map(scene, legend=False)
            pictures.append(Picture(name="mosaic", png=png(above.rgb), caption="what was seen, from above, in colour"))
    return tuple(pictures)
