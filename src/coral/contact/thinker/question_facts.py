"""Facts for each kind of question, for advisors without vision: the scene, and what the question adds."""

from __future__ import annotations

from typing import NotRequired, TypedDict

from coral.contact.scene.facts import SceneFacts, TableFacts
from coral.contact.thinker.diagnosis import Diagnosis


class QuestionFacts(SceneFacts):
    """The scene when it was last observed.

    Args:
        refused: How many answers about the plan were refused before the one that holds; regions are to fit that one.
    """

    refused: NotRequired[int]


class PlanFacts(QuestionFacts):
    """Facts of questions about the plan.

    Args:
        diagnoses: What went wrong so far, in order.
        contact_strategy: Whether the plan may say where to touch.
    """

    diagnoses: list[Diagnosis]
    contact_strategy: bool


class RegionFacts(PlanFacts):
    """Facts of the question about the regions of a plan with these stage names."""

    stages: list[str]


class FittedFacts(TypedDict):
    """Mass and friction fitted to an object, and whether they explain the history better."""

    object: str
    mass_kg: float
    friction: float
    better: bool


class CorrectionFacts(QuestionFacts):
    """Facts of the question about corrected parameters."""

    fitted: FittedFacts


class UnposedObjectFacts(TypedDict):
    """An object whose pose is asked for.

    Args:
        label: What it is called.
        size_m: Full extents of the box that holds it.
        middle_m: Centre of that box in the object's frame.
        points_m: Named points, from the centre of the box.
        usual_pose: x, y, z, qw, qx, qy, qz where the task file puts it.
        pixels: How many pixels of it have a measured depth.
        seen_box_m: Lowest and highest corner of the measured points, in the world; None without any.
    """

    label: str
    size_m: list[float]
    middle_m: list[float]
    points_m: dict[str, list[float]]
    usual_pose: list[float]
    pixels: int
    seen_box_m: list[list[float]] | None


class CameraFacts(TypedDict):
    """The camera: its position (m) and axes in the world, its lens and picture."""

    position: list[float]
    axes_right_down_forward: list[list[float]]
    focal_px: float
    width_px: int
    height_px: int


class ToolFacts(TypedDict):
    """The tool's pose: x, y, z, qw, qx, qy, qz."""

    pose: list[float]


class PoseFacts(TypedDict):
    """Facts of the question about the objects' poses."""

    task: str
    instruction: str
    objects: dict[str, UnposedObjectFacts]
    table: TableFacts
    hand: ToolFacts
    camera: CameraFacts
