"""Facts of a scene as plain numbers: the types of the JSON in questions and memories.

Metres, kilograms, quaternions (w, x, y, z), world frame. `thinker/scene_facts.py` collects them; checks, memory and
rules read them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NotRequired, TypedDict, cast

import numpy as np
from numpy.typing import NDArray

from coral.contact.scene.conditions import Condition


class PartFacts(TypedDict):
    """Bounding box of one part of an object, in the object's frame."""

    size_m: list[float]
    position: list[float]


class JointFacts(TypedDict):
    """What holds an object: `axis` and `point` in its frame; `range` and friction in degrees and N m, or m and N."""

    kind: str
    axis: list[float]
    point: list[float]
    range: list[float]
    now: float
    friction: float


class ObjectFacts(TypedDict):
    """One movable object.

    Args:
        label: Its name for people; its identifier if the task file has no label.
        size_m: Full extents of its bounding box.
        pose: Pose of its frame: x, y, z, qw, qx, qy, qz.
        shapes: Kinds of its parts, sorted.
        solid_share: Volume of the parts as a share of the box.
        parts: The parts that are neither meshes nor rotated.
        points: Named points in its frame.
        middle_m: Centre of its box in its frame; missing if it is the origin.
        joint: What holds it; missing if it moves freely.
        unseen: True before a picture has shown it: its pose is a guess.
        mass_kg, friction: Beliefs; missing before the first belief.
    """

    label: str
    size_m: list[float]
    pose: list[float]
    shapes: list[str]
    solid_share: float
    parts: list[PartFacts]
    points: dict[str, list[float]]
    middle_m: NotRequired[list[float]]
    joint: NotRequired[JointFacts]
    mass_kg: NotRequired[float]
    friction: NotRequired[float]
    unseen: NotRequired[bool]


class FixtureFacts(TypedDict):
    """A fixed thing: its centre, full extents and rotation about z."""

    position: list[float]
    size_m: list[float]
    yaw_deg: float


class TableFacts(TypedDict):
    """Extent of the table's top in x and y; it lies at z = 0."""

    x: list[float]
    y: list[float]


class HandFacts(TypedDict):
    """The tool's pose, and the fingers' opening, present and widest."""

    pose: list[float]
    opening_m: float
    widest_opening_m: float


class LiftedGoal(TypedDict):
    """See `state_conditions.Lifted`."""

    object: str
    kind: Literal["lifted"]
    height_m: float
    most_m: float | None


class GraspedGoal(TypedDict):
    """See `state_conditions.Grasped`."""

    object: str
    kind: Literal["grasped"]
    point: str | None
    within_m: float


class ReleasedGoal(TypedDict):
    """See `state_conditions.Released`."""

    object: str
    kind: Literal["released"]


class AtGoal(TypedDict):
    """See `state_conditions.At`."""

    object: str
    kind: Literal["at"]
    place: str
    point: str | None
    tolerance_m: float
    axes: str


class InsideGoal(TypedDict):
    """See `state_conditions.Inside`."""

    object: str
    kind: Literal["inside"]
    low: list[float]
    high: list[float]
    point: str | None


class RestingGoal(TypedDict):
    """See `state_conditions.Resting`."""

    object: str
    kind: Literal["resting"]
    thing: str


class FlippedGoal(TypedDict):
    """See `state_conditions.Flipped`."""

    object: str
    kind: Literal["flipped"]
    axis: str
    degrees: float
    tolerance_deg: float


class UprightGoal(TypedDict):
    """See `state_conditions.Upright`."""

    object: str
    kind: Literal["upright"]
    tolerance_deg: float


class TouchedWhileTurningGoal(TypedDict):
    """See `history_conditions.TouchedWhileTurning`."""

    object: str
    kind: Literal["touched-while-turning"]
    thing: str
    axis: str
    between_deg: list[float]
    for_s: float


class SteadyForceGoal(TypedDict):
    """See `history_conditions.SteadyForce`."""

    object: str
    kind: Literal["steady-force"]
    newtons: float
    tolerance: float
    fraction: float
    moving_m_s: float
    window_s: float
    for_s: float
    deviation_n: float | None


class UndisturbedGoal(TypedDict):
    """See `state_conditions.Undisturbed`."""

    object: str
    kind: Literal["undisturbed"]
    tolerance_m: float
    tolerance_deg: float


class TouchingGoal(TypedDict):
    """See `state_conditions.Touching`."""

    object: str
    kind: Literal["touching"]
    thing: str


class StillGoal(TypedDict):
    """See `state_conditions.Still`."""

    object: str
    kind: Literal["still"]
    speed_m_s: float
    turn_rad_s: float


class PointingGoal(TypedDict):
    """See `state_conditions.Pointing`."""

    object: str
    kind: Literal["pointing"]
    axis: str
    direction: list[float]
    tolerance_deg: float
    either_way: bool


class LeaningGoal(TypedDict):
    """See `state_conditions.Leaning`."""

    object: str
    kind: Literal["leaning"]
    thing: str
    axis: str
    between_deg: list[float]


class AtObjectGoal(TypedDict):
    """See `relative_conditions.AtObject`."""

    object: str
    kind: Literal["at-object"]
    other: str
    point: str | None
    other_point: str | None
    offset: list[float]
    tolerance_m: float
    axes: str
    tolerance_deg: float | None


class InsertedGoal(TypedDict):
    """See `relative_conditions.Inserted`."""

    object: str
    kind: Literal["inserted"]
    point: str
    place: str | None
    other: str | None
    other_point: str | None
    into: str
    depth_m: float
    tolerance_m: float


class OpenedGoal(TypedDict):
    """See `relative_conditions.Opened`."""

    object: str
    kind: Literal["opened"]
    between_deg: list[float] | None
    between_m: list[float] | None


class PeakForceGoal(TypedDict):
    """See `history_conditions.PeakForce`."""

    object: str
    kind: Literal["peak-force"]
    newtons: float
    window_s: float


class SpeedLimitGoal(TypedDict):
    """See `history_conditions.SpeedLimit`."""

    object: str
    kind: Literal["speed-limit"]
    speed_m_s: float


class KeptLevelGoal(TypedDict):
    """See `history_conditions.KeptLevel`."""

    object: str
    kind: Literal["kept-level"]
    axis: str
    tolerance_deg: float


class KeptNearGoal(TypedDict):
    """See `history_conditions.KeptNear`."""

    object: str
    kind: Literal["kept-near"]
    point: str | None
    distance_m: float


class KeptTouchingGoal(TypedDict):
    """See `history_conditions.KeptTouching`."""

    object: str
    kind: Literal["kept-touching"]
    thing: str
    for_s: float


class NeverTouchedGoal(TypedDict):
    """See `history_conditions.NeverTouched`."""

    object: str
    kind: Literal["never-touched"]
    thing: str


class SlidGoal(TypedDict):
    """See `history_conditions.Slid`."""

    object: str
    kind: Literal["slid"]
    thing: str
    distance_m: float


SingleGoal = (
    LiftedGoal
    | GraspedGoal
    | ReleasedGoal
    | AtGoal
    | InsideGoal
    | RestingGoal
    | FlippedGoal
    | UprightGoal
    | TouchedWhileTurningGoal
    | SteadyForceGoal
    | UndisturbedGoal
    | TouchingGoal
    | StillGoal
    | PointingGoal
    | LeaningGoal
    | AtObjectGoal
    | InsertedGoal
    | OpenedGoal
    | PeakForceGoal
    | SpeedLimitGoal
    | KeptLevelGoal
    | KeptNearGoal
    | KeptTouchingGoal
    | NeverTouchedGoal
    | SlidGoal
)
"""A condition other than a sequence."""


class SequenceGoal(TypedDict):
    """See `conditions.EventSequence`."""

    object: str
    kind: Literal["sequence"]
    events: list[list[SingleGoal]]
    for_s: float


Goal = SingleGoal | SequenceGoal
"""A condition of the task file as JSON; `kind` is its kind."""

GoalsByKind = TypedDict(
    "GoalsByKind",
    {
        "lifted": LiftedGoal,
        "grasped": GraspedGoal,
        "released": ReleasedGoal,
        "at": AtGoal,
        "inside": InsideGoal,
        "resting": RestingGoal,
        "flipped": FlippedGoal,
        "upright": UprightGoal,
        "touched-while-turning": TouchedWhileTurningGoal,
        "steady-force": SteadyForceGoal,
        "undisturbed": UndisturbedGoal,
        "touching": TouchingGoal,
        "still": StillGoal,
        "pointing": PointingGoal,
        "leaning": LeaningGoal,
        "at-object": AtObjectGoal,
        "inserted": InsertedGoal,
        "opened": OpenedGoal,
        "peak-force": PeakForceGoal,
        "speed-limit": SpeedLimitGoal,
        "kept-level": KeptLevelGoal,
        "kept-near": KeptNearGoal,
        "kept-touching": KeptTouchingGoal,
        "never-touched": NeverTouchedGoal,
        "slid": SlidGoal,
        "sequence": SequenceGoal,
    },
    total=False,
)
"""Goals of one object, at most one of each kind."""


class SceneFacts(TypedDict):
    """The whole scene.

    Args:
        task: Name of the task.
        instruction: The task in words.
        goals: The conditions of the task file.
        objects, fixtures: Movable and fixed things by name.
        places: Named places of the task.
        numbers: Named numbers of the task.
        table: The table's top.
        hand: The hand.
    """

    task: str
    instruction: str
    goals: list[Goal]
    objects: dict[str, ObjectFacts]
    fixtures: dict[str, FixtureFacts]
    places: dict[str, list[float]]
    numbers: dict[str, float]
    table: TableFacts
    hand: HandFacts


def goals_of(conditions: Sequence[Condition]) -> list[Goal]:
    """Convert conditions to JSON; a test checks that their fields are those of the types above."""
    return [cast(Goal, condition.model_dump(mode="json")) for condition in conditions]


def goals_by_kind(goals: Sequence[Goal]) -> GoalsByKind:
    """Sort the goals of one object by kind; of two of a kind, the last counts."""
    return cast(GoalsByKind, {goal["kind"]: goal for goal in goals})


def on_table(table: TableFacts, point: NDArray[np.float64]) -> bool:
    """Check whether a point lies over the table.

    Args:
        table: The table.
        point: Shape=(2,) or (3,) m, in the world.
    """
    (left, right), (near, far) = table["x"], table["y"]
    return bool(left <= point[0] <= right and near <= point[1] <= far)
