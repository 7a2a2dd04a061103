"""A contact run as a ROS 2 bag: where hand, target and objects were, what was planned, forces, events (REP-103).

Frames: `hand` (the tool as measured), `hand_target` and each object stand in `world`; z points up, the table's top is
at z = 0. Objects stand where the trajectory says, which in a simulated world is the truth.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.bag_writer import BagWriter, open_bag
from coral.contact.scene.geometry import conjugate, from_rpy_deg, rotate
from coral.contact.scene.trial import Trial
from coral.errors import InputError
from coral.run_files import RunFiles
from coral.view.contact.replay import trial_of_run
from coral.view.run import RunFolder

TOPICS = {
    "/tf": (
        "tf2_msgs/msg/TFMessage",
        "`world` to `hand` (as measured), to `hand_target`, and to each object (in a simulation, its true pose).",
    ),
    "/hand/wrench": ("geometry_msgs/msg/WrenchStamped", "Force and torque on the hand, on its own axes."),
    "/hand/opening": ("sensor_msgs/msg/JointState", "Its opening and the commanded one (m)."),
    "/plan/aim": ("geometry_msgs/msg/PointStamped", "Where each plan leads the hand."),
    "/plan/cost": ("std_msgs/msg/Float64", "The cost of each plan."),
    "/events": ("std_msgs/msg/String", "Every line of `events.jsonl`."),
    "/scene": ("visualization_msgs/msg/MarkerArray", "Table, fixtures and objects, once; meshes are left out."),
}
"""Type of each topic, and what is on it."""
Array = NDArray[np.float64]
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
WORLD, HAND, TARGET = "world", "hand", "hand_target"
KINDS = {"box": 1, "sphere": 2, "cylinder": 3}
"""Of visualization_msgs/Marker; meshes are left out."""
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
WRENCH = ("fx", "fy", "fz", "tx", "ty", "tz")


def export_mcap(path: Path, out: Path) -> dict[str, int]:
    """Write a contact run as one MCAP file; see `write_bag`."""
    return write_bag(RunFolder.read(path), out, single_file=True)


def export_bag(path: Path, out: Path) -> dict[str, int]:
    """Write a contact run as a ROS 2 bag, a folder; see `write_bag`."""
    return write_bag(RunFolder.read(path), out, single_file=False)


def write_bag(run: RunFolder, out: Path, *, single_file: bool) -> dict[str, int]:
    """Write a contact run, finished or killed.

    Args:
        run: The run.
        out: The bag's folder, or the MCAP file; it must not exist.
        single_file: Whether to write one MCAP file and no folder.

    Returns:
        Number of messages on each topic that has some.

    Raises:
        InputError: It is no contact run or has no trajectory, the path exists, or rosbags is not installed.
    """
    trial, times = trial_of_run(run), run.column("t")
    if not len(times):
        raise InputError(str(run.path), RunFiles.TRAJECTORY, "no rows", "at least one control step")
    steps = {name: _poses(run, prefix) for name, prefix in _frames(trial).items()}
    wrench = np.stack([run.column(name) for name in WRENCH], axis=1)
    opening = np.stack([run.column("opening"), run.column("cmd_opening")], axis=1)
    with open_bag(out, TOPICS, single_file=single_file) as bag:
        bag.send("/scene", float(times[0]), _scene(bag, trial, float(times[0])))
        events = iter([*run.events, None])
        event = next(events)
        for row, t in enumerate(map(float, times)):
            while event is not None and float(event["t"]) <= t:
                _tell(bag, event)
                event = next(events)
            moved = [
                bag.transform(WORLD, name, pose[row, :3], pose[row, 3:], t)
                for name, pose in steps.items()
                if np.isfinite(pose[row]).all()
            ]
            bag.send("/tf", t, bag.new("tf2_msgs/msg/TFMessage", transforms=moved))
            bag.send("/hand/wrench", t, _wrench(bag, wrench[row], steps[HAND][row], t))
            bag.send("/hand/opening", t, _opening(bag, opening[row], t))
        while event is not None:
            _tell(bag, event)
            event = next(events)
    return bag.counts


def _frames(trial: Trial) -> dict[str, str]:
    """Return the prefix of the columns of each frame's pose."""
    return {HAND: "", TARGET: "cmd_", **{name: f"{name}_" for name in trial.objects}}


def _poses(run: RunFolder, prefix: str) -> Array:
    return np.stack([run.column(f"{prefix}{name}") for name in POSE], axis=1)


def _tell(bag: BagWriter, event: Any) -> None:
    """Write an event as JSON, and what a plan aims at."""
    t, aim, cost = float(event["t"]), event.get("aim"), event.get("cost")
    bag.send("/events", t, bag.text(json.dumps(event)))
    if event["event"] != "plan":
        return
    if isinstance(aim, list) and len(aim) == 3:
        point = bag.new("geometry_msgs/msg/PointStamped", header=bag.header(t, WORLD), point=bag.point(aim))
        bag.send("/plan/aim", t, point)
    if isinstance(cost, int | float):
        bag.send("/plan/cost", t, bag.new("std_msgs/msg/Float64", data=float(cost)))


def _wrench(bag: BagWriter, wrench: Array, hand: Array, t: float) -> Any:
    """Turn force (N) and torque (N m) from the world's axes to the hand's."""
    to_hand = conjugate(hand[[6, 3, 4, 5]])
    force, torque = (bag.vector(rotate(to_hand, part)) for part in (wrench[:3], wrench[3:]))
    return bag.new(
        "geometry_msgs/msg/WrenchStamped",
        header=bag.header(t, HAND),
        wrench=bag.new("geometry_msgs/msg/Wrench", force=force, torque=torque),
    )


def _opening(bag: BagWriter, values: Array, t: float) -> Any:
    nothing = np.zeros(0)
    return bag.new(
        "sensor_msgs/msg/JointState",
        header=bag.header(t, HAND),
        name=["opening", "opening_target"],
        position=values,
        velocity=nothing,
        effort=nothing,
    )


def _scene(bag: BagWriter, trial: Trial, t: float) -> Any:
    """Draw table, fixtures and objects; the marks of objects move with their frames."""
    task = trial.task
    (x, y), height = task.table.center, task.table.size[2]
    marks = [_mark(bag, WORLD, "table", task.table.size, (x, y, -height / 2), UPRIGHT, (0.8, 0.75, 0.7), t)]
    for item in task.fixtures:
        turn = from_rpy_deg((0.0, 0.0, item.yaw_deg))
        marks.append(_mark(bag, WORLD, item.name, item.size, item.position, turn, item.color, t))
    for name, drawn in trial.objects.items():
        parts = [part for part in task.object(name).parts if part.shape in KINDS]
        for number, part in enumerate(parts):
            size, place = drawn.scale * part.size, drawn.scale * part.position
            mark = _mark(bag, name, name, size, place, from_rpy_deg(part.rpy_deg), task.object(name).color, t)
            mark.id, mark.type = number, KINDS[part.shape]
            marks.append(mark)
    return bag.new("visualization_msgs/msg/MarkerArray", markers=marks)


def _mark(
    bag: BagWriter,
    frame: str,
    name: str,
    size: Sequence[float] | Array,
    place: Sequence[float] | Array,
    turn: Array,
    color: Sequence[float],
    t: float,
) -> Any:
    """Make a box that stands in a frame: full edges and middle (m), turn as (w, x, y, z)."""
    texture = bag.new(
        "sensor_msgs/msg/CompressedImage", header=bag.header(t, ""), format="", data=np.zeros(0, np.uint8)
    )
    file = bag.new("visualization_msgs/msg/MeshFile", filename="", data=np.zeros(0, np.uint8))
    rgba = bag.new("std_msgs/msg/ColorRGBA", r=color[0], g=color[1], b=color[2], a=1.0)
    return bag.new(
        "visualization_msgs/msg/Marker",
        header=bag.header(t, frame),
        ns=name,
        id=0,
        type=KINDS["box"],
        action=0,
        pose=bag.new(
            "geometry_msgs/msg/Pose", position=bag.point(place), orientation=bag.quaternion(np.roll(turn, -1))
        ),
        scale=bag.vector(size),
        color=rgba,
        lifetime=bag.new("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
        frame_locked=True,
        points=[],
        colors=[],
        texture_resource="",
        texture=texture,
        uv_coordinates=[],
        text="",
        mesh_resource="",
        mesh_file=file,
        mesh_use_embedded_materials=False,
    )
