"""A task of LIBERO-OBJECT or of a perturbed suite of it, in one of its initial states, as a task of this package.

Frames: LIBERO's Panda stands at x = -0.6 m on the floor, ours at -0.5 m: everything is shifted by the difference, and
its floor is our table. An object's frame is LIBERO's rotated upright; it keeps LIBERO's origin, as its success test
requires.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

import numpy as np

from coral.contact.libero.object_model import Box, Model, read_model
from coral.contact.libero.package import SUITES, Package, find_package
from coral.contact.libero.problem import Problem, read_problem
from coral.contact.libero.simplification import simplified, triple
from coral.contact.scene.geometry import rotation_of
from coral.contact.scene.observation import Array
from coral.contact.scene.shapes import Fixture, Movable, Shape, TableTop
from coral.contact.scene.state_conditions import Inside
from coral.contact.scene.task import Success, Task
from coral.contact.scene.task_validation import check_task
from coral.contact.scene.trial import corners
from coral.errors import InputError, nearest
from coral.foreign_file import read_arrays

PREFIX = "libero:"
TITLE = "LIBERO-OBJECT"
SHIFT_M = np.array([0.1, 0.0])
BELOW_REGION_M = 0.01
"""Tolerance of LIBERO's `in_box` below a region."""
ROBOT_JOINTS = 9
SPREAD = 0.25
"""LIBERO's masses and frictions are the same in every trial; ours vary by this share about them, unknown to the
planner."""
HEAVIEST_FRICTION = 2.0
LIGHTEST_KG = 0.1
"""Smallest mass. LIBERO's cans weigh 25 g and its butter 5 g, real ones 350 and 250 g. In the coarse steps of a
rollout, fingers that squeeze with 20 N throw what is lighter."""
HOVER_M = 0.05
"""Height over the grasp at which the hand comes to rest first: bottles of 25 g fall at a touch, and a can leaves 9 mm
on each side."""
COLORS = (
    (0.75, 0.22, 0.2),
    (0.85, 0.78, 0.6),
    (0.45, 0.55, 0.75),
    (0.6, 0.6, 0.62),
    (0.9, 0.75, 0.3),
    (0.5, 0.65, 0.45),
    (0.65, 0.5, 0.65),
)


def load_libero(text: str) -> Task:
    """Load the task `libero:SUITE/TASK/STATE`.

    SUITE is one of `SUITES`, TASK the index of the task in it, STATE that of the initial state, both from 0; STATE is
    optional.

    Raises:
        InputError: There is no such task, or the package is not installed or not as expected.
    """
    match = re.fullmatch(rf"{PREFIX}([a-z-]+)/(\d{{1,3}})(?:/(\d{{1,3}}))?", text)
    if match is None or match[1] not in SUITES:
        hint = "" if match is None else nearest(match[1], SUITES)
        form = "libero:KIND/TASK, such as libero:object/0, or with a state libero:object/0/3"
        raise InputError("task", "", text, f"{form}; KIND is one of {', '.join(SUITES)}{hint}")
    package = find_package(text, match[1])
    names = package.tasks()
    index, state = int(match[2]), int(match[3] or 0)
    if index >= len(names):
        raise InputError(text, "task", index, f"a number from 0 to {len(names) - 1}")
    return libero_task(package, names[index], f"libero-{match[1]}-{index}-{state}", state)


def libero_task(package: Package, task: str, name: str, state: int) -> Task:
    """Make a task of the package, whose name is `task` there and `name` here, in an initial state.

    Raises:
        InputError: A file is missing or not as expected.
    """
    problem = read_problem(package.problem(task))
    poses = _poses(package.states(task), problem, state)
    models = {key: read_model(package.model(kind)) for key, kind in problem.objects.items()}
    region = models[problem.container].regions.get(problem.region)
    if region is None:
        raise InputError(str(package.model(problem.objects[problem.container])), "site", "none", problem.region)
    position, rotation = poses[problem.container]
    label = _plain(problem.container)
    fixtures, lift = _container(models[problem.container], position, rotation, label)
    middle = rotation @ region.position + np.array([*(position[:2] + SHIFT_M), lift])
    # LIBERO takes the absolute value of the rotated half edges, exact for quarter turns.
    half = np.abs(rotation @ region.rotation @ region.size) / 2
    low = triple(middle - half - np.array([0, 0, BELOW_REGION_M]))
    floor = max(fixture.position[2] + fixture.size[2] / 2 for fixture in fixtures if fixture.name.endswith("bottom"))
    rim = max(fixture.position[2] + fixture.size[2] / 2 for fixture in fixtures)
    order = [problem.target, *(key for key in problem.objects if key not in (problem.target, problem.container))]
    objects = tuple(
        _movable(_plain(key), models[key], poses[key], COLORS[k % len(COLORS)]) for k, key in enumerate(order)
    )
    made = Task(
        name=name,
        title=TITLE,
        instruction=problem.language.strip().rstrip(".") + ".",
        time_limit_s=40.0,
        table=TableTop(size=(1.0, 1.1, 0.05), center=(0.1, 0.0)),
        fixtures=fixtures,
        objects=objects,
        places={"goal": (float(middle[0]), float(middle[1]), float(floor))},
        numbers={"carry_height": round(rim + _rim_clearance(objects[0]), 3), "hover_height": HOVER_M},
        success=Success(hold_s=0.0, conditions=(Inside(object=objects[0].name, low=low, high=triple(middle + half)),)),
    )
    check_task(made, name)
    return made


def _poses(path: Path, problem: Problem, state: int) -> dict[str, tuple[Array, Array]]:
    """Read position and rotation of every object: MuJoCo's state is time, qpos, qvel, with the robot's joints first."""
    count = len(problem.objects)
    try:
        states = np.asarray(read_arrays(path)["states"], dtype=float)
    except (OSError, ValueError, KeyError) as error:
        raise InputError(str(path), "states", type(error).__name__, "the benchmark's initial states") from None
    width = 1 + 2 * ROBOT_JOINTS + 13 * count
    if states.ndim != 2 or states.shape[1] != width or not np.isfinite(states).all():
        raise InputError(str(path), "states", f"shape {states.shape}", f"{width} numbers a state, of {count} objects")
    if state >= len(states):
        raise InputError(str(path), "state", state, f"a number from 0 to {len(states) - 1}")
    rows = states[state, 1 + ROBOT_JOINTS : 1 + ROBOT_JOINTS + 7 * count].reshape(count, 7)
    return {
        name: (row[:3], rotation_of(row[3:] / max(float(np.linalg.norm(row[3:])), 1e-9)))
        for name, row in zip(problem.objects, rows, strict=True)
    }


def _movable(name: str, model: Model, pose: tuple[Array, Array], color: tuple[float, float, float]) -> Movable:
    position, rotation = pose
    upright = _quarter_turns(rotation)
    yaw = _yaw_deg(rotation @ upright.T)
    x, y = position[:2] + SHIFT_M
    mass, friction = max(model.mass_kg, LIGHTEST_KG), model.friction
    parts = simplified([box.turned(upright) for box in model.boxes])
    hull = np.concatenate([box.turned(upright).corners for box in model.boxes])
    return Movable(
        name=name,
        label=name.replace("_", " "),
        parts=parts,
        symmetry=_symmetry(parts),
        points={"middle": triple((hull.min(axis=0) + hull.max(axis=0)) / 2)},
        mass_kg=(mass * (1 - SPREAD), mass * (1 + SPREAD)),
        friction=(friction * (1 - SPREAD), min(friction * (1 + SPREAD), HEAVIEST_FRICTION)),
        x=(float(x), float(x)),
        y=(float(y), float(y)),
        yaw_deg=(yaw, yaw),
        color=color,
    )


def _symmetry(parts: tuple[Shape, ...]) -> Literal["none", "box", "cylinder"]:
    """Choose the tracker's symmetry; a body of several boxes has none, nor does one whose box is tilted."""
    if len(parts) > 1 or any(abs(angle) % 90 > 1e-3 for angle in parts[0].rpy_deg):
        return "none"
    return "cylinder" if parts[0].shape == "cylinder" else "box"


def _container(model: Model, position: Array, rotation: Array, name: str) -> tuple[tuple[Fixture, ...], float]:
    """Convert its boxes to fixtures, and compute the height of its frame's origin when it stands on the table.

    A fixture stands upright, so sides tilted by a few degrees are straightened.
    """
    straight = [Box(box.position, np.eye(3), np.abs(_quarter_turns(box.rotation)) @ box.size) for box in model.boxes]
    upright = _quarter_turns(rotation)
    yaw = _yaw_deg(rotation @ upright.T)
    placed = [box.turned(upright) for box in straight]
    low = min(float(box.corners[:, 2].min()) for box in placed)
    turn = rotation @ upright.T
    lowest = min(range(len(placed)), key=lambda k: placed[k].position[2])
    found, side = [], 0
    for k, box in enumerate(placed):
        if k == lowest:
            part = "bottom"
        else:
            side += 1
            part = f"side{side}"
        centre = turn @ box.position + np.array([*(position[:2] + SHIFT_M), -low])
        found.append(
            Fixture(
                name=f"{name}_{part}",
                size=triple(np.abs(box.rotation) @ box.size),
                position=triple(centre),
                yaw_deg=yaw,
                friction=min(model.friction, HEAVIEST_FRICTION),
                color=(0.66, 0.5, 0.34),
            )
        )
    return tuple(found), -low


def _rim_clearance(item: Movable) -> float:
    """Compute the height of its origin over a rim while carried (m): its lower half and 3 cm."""
    return float(-corners(item, np.ones(3))[:, 2].min()) + 0.03


def _quarter_turns(rotation: Array) -> Array:
    """Round a rotation to quarter turns: of each axis the largest coordinate, the rest right-handed."""
    rows = np.zeros((3, 3))
    first = int(np.abs(rotation[2]).argmax())
    rows[2, first] = np.sign(rotation[2, first])
    rest = np.abs(rotation[0]) * (np.arange(3) != first)
    second = int(rest.argmax())
    rows[0, second] = np.sign(rotation[0, second])
    rows[1] = np.cross(rows[2], rows[0])
    return rows


def _yaw_deg(rotation: Array) -> float:
    return round(float(np.degrees(np.arctan2(rotation[1, 0], rotation[0, 0]))), 4) + 0.0


def _plain(name: str) -> str:
    return re.sub(r"_\d+$", "", name)
