"""A survey map, the robot and the true reef, as elements of the live page."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.scene import RECTANGLE, Footprints, Scene
from coral.reef.world.world import ReefWorld
from coral.view.cameraview import camera_picture
from coral.view.live.state import Ground, Line, LiveBody, LivePart, Marker, Number, Tone
from coral.view.live.story import Story
from coral.view.live.strokes import NONE, arrow, bundle, crosshair, oval, path, rectangle, ring
from coral.view.mapframe import BLUE, CELL_COLORS, MAGENTA, OBSTACLE, ORANGE, OYSTER, PALE_ORANGE, RED, YELLOW
from coral.view.mapview import MapScene
from coral.view.pictures import RGB, Image

PLAN, ROLLOUT, REFERENCE, TRUTH = (0, 170, 190), (150, 120, 200), (120, 60, 160), (214, 52, 44)
HEIGHTS: dict[int, tuple[float, RGB]] = {OBSTACLE: (0.45, (58, 60, 68)), OYSTER: (0.10, (30, 148, 66))}
DEPTH_OF_HULL_M = 0.55
"""Height of the drawn robot above the seabed (m): low, so that it does not look shifted against the map."""
HULL_M = 0.3
PICTURE = (320, 240)
LEGEND: tuple[tuple[RGB, str], ...] = (
    ((190, 193, 197), "explored"),
    ((58, 60, 68), "obstacle"),
    ((38, 166, 76), "oysters"),
    (YELLOW, "path travelled"),
    (RED, "robot, forward"),
    (BLUE, "chain, robot's left"),
    (ORANGE, "cluster"),
    (PALE_ORANGE, "cluster, visited"),
    (MAGENTA, "goal"),
    (TRUTH, "truth, if shown"),
)
PLANNED: tuple[tuple[RGB, str], ...] = ((PLAN, "plan"), (ROLLOUT, "rollouts"), (REFERENCE, "path to the goal"))


def _rov() -> tuple[LivePart, ...]:
    """Draw a BlueROV2 from boxes: blue floats on black side plates, a clear dome in front, thrusters; m, body FLU."""
    blue, black, gray = (28, 110, 190), (34, 36, 40), (120, 126, 134)
    parts = [
        LivePart(shape="box", center=(0.0, 0.0, 0.0), size=(0.34, 0.12, 0.11), color=(225, 228, 232)),
        LivePart(shape="ball", center=(0.19, 0.0, 0.0), size=(0.11, 0.11, 0.11), color=(150, 205, 235)),
    ]
    for side in (1.0, -1.0):
        parts += [
            LivePart(shape="box", center=(0.0, 0.12 * side, 0.10), size=(0.44, 0.11, 0.09), color=blue),
            LivePart(shape="box", center=(0.0, 0.18 * side, -0.02), size=(0.457, 0.015, 0.24), color=black),
            LivePart(shape="cylinder", center=(0.0, 0.12 * side, 0.15), size=(0.10, 0.10, 0.03), color=black),
        ]
        parts += [
            LivePart(shape="cylinder", center=(0.16 * end, 0.13 * side, -0.08), size=(0.09, 0.09, 0.07), color=gray)
            for end in (1.0, -1.0)
        ]
    return tuple(parts)


ROV = _rov()
_LOW = 0.17 - DEPTH_OF_HULL_M
HEADING = (
    Line(name="hull", segments=ring(0.0, 0.0, HULL_M, _LOW), color=RED, width_px=3),
    Line(name="forward", segments=arrow(np.zeros(2), np.array([1.2, 0.0]), _LOW), color=RED, width_px=4),
    Line(name="left", segments=arrow(np.zeros(2), np.array([0.0, 0.9]), _LOW), color=BLUE, width_px=3),
)
"""Lines below the vehicle on the map: its hull, its +X and its +Y, as in the paper."""


def ground(scene: MapScene) -> Ground:
    """Draw the map in the paper's colours, with slightly raised obstacles and oysters."""
    return Ground(cells=scene.cells, palette=CELL_COLORS, cell_m=scene.cell_m, origin=scene.origin, heights=HEIGHTS)


def robot(pose: Pose | None) -> tuple[LiveBody, ...]:
    """Draw the vehicle in its present pose."""
    if pose is None:
        return ()
    half = 0.5 * pose.theta
    return (
        LiveBody(
            name="robot",
            parts=ROV,
            lines=HEADING,
            position=(pose.x, pose.y, DEPTH_OF_HULL_M),
            wxyz=(math.cos(half), 0.0, 0.0, math.sin(half)),
        ),
    )


def lines(scene: MapScene, plan: NDArray[np.float64] | None = None) -> tuple[Line, ...]:
    """Draw all lines on the map, in the colours of the paper's pictures.

    Args:
        scene: The map with its contents.
        plan: The controller's plan, Shape=(T, 2 or 3); None if unknown.
    """
    goal = scene.goal
    dots = np.asarray(scene.centroids, np.float64).reshape(-1, 2)
    order = list(range(len(dots))) if scene.chain is None else list(scene.chain)
    rollouts = NONE if scene.rollouts is None else bundle(scene.rollouts, 0.14)
    return (
        Line(name="trajectory", segments=path(scene.trajectory, 0.12), color=YELLOW, width_px=4),
        Line(name="chain", segments=path(dots[order], 0.13), color=BLUE, width_px=3),
        Line(name="rollouts", segments=rollouts, color=ROLLOUT, width_px=1, layer="rollouts"),
        Line(
            name="reference",
            segments=NONE if scene.reference is None else path(scene.reference, 0.15),
            color=REFERENCE,
            width_px=2,
        ),
        Line(name="plan", segments=NONE if plan is None else path(plan[:, :2], 0.18), color=PLAN, width_px=4),
        Line(name="goal", segments=crosshair(*goal, 0.32, 0.2) if goal else NONE, color=MAGENTA, width_px=4),
    )


def markers(scene: MapScene) -> tuple[Marker, ...]:
    """Draw the centroid chain's dots with their labels, pale once visited."""
    dots = np.asarray(scene.centroids, np.float64).reshape(-1, 2)
    names = scene.indices if scene.indices is not None else range(len(dots))
    seen = scene.visited if scene.visited is not None else [False] * len(dots)
    return tuple(
        Marker(label=str(name), position=(float(x), float(y), 0.2), color=PALE_ORANGE if old else ORANGE)
        for (x, y), name, old in zip(dots, names, seen, strict=True)
    )


def truth(world: ReefWorld | None) -> tuple[Line, ...]:
    """Draw outlines of the true oysters and obstacles, which the robot and its advisor never see."""
    if world is None:
        return ()
    scene = Scene.from_world(world)
    everything = scene.outlines(np.arange(len(scene.kind)))
    outlines = [path(_outline(everything, k), 0.06) for k in range(len(scene.kind))]
    return (Line(name="truth", segments=np.concatenate(outlines), color=TRUTH, width_px=2, layer="truth"),)


def _outline(shapes: Footprints, k: int) -> NDArray[np.float64]:
    draw = rectangle if shapes.kind[k] == RECTANGLE else oval
    return draw(shapes.center[k], shapes.half[k], float(shapes.yaw[k]))


def cameras(frame: Frame | None) -> tuple[tuple[str, Image], ...]:
    """Return the pictures of the front camera: colours if it takes them, classes, depth."""
    if frame is None:
        return ()
    what = "oysters green, obstacles dark"
    classes, depth = camera_picture(frame, "segmentation", PICTURE), camera_picture(frame, "depth", PICTURE)
    if frame.rgb is None:
        return (f"Camera: {what}", classes), ("Depth: near is bright", depth)
    colours = camera_picture(frame, "colour", PICTURE)
    return ("Camera", colours), (f"Classes: {what}", classes), ("Depth: near is bright", depth)


def numbers(story: Story, coverage: float, speed_m_s: float) -> tuple[Number, ...]:
    """Return the numbers at the head of the page. `coverage`: 0 to 1."""
    repeated = f" ({story.requeries} again)" if story.requeries else ""
    return (
        Number(name="coverage", value=f"{100 * coverage:.0f} %", tone="good" if coverage >= 1 - 1e-9 else "plain"),
        Number(name="clusters", value=f"{story.covered} of {story.clusters}"),
        Number(name="collisions", value=str(story.collisions), tone="bad" if story.collisions else "plain"),
        Number(name="advisor calls", value=f"{story.calls}{repeated}"),
        Number(name="speed", value=f"{speed_m_s:.2f} m/s"),
        *([Number(name="state", value=story.state, tone=_tone(story.state))] if story.state else []),
    )


def _tone(state: str) -> Tone:
    return "plain" if state in ("ready", "surveying", "stopped") else "bad"
