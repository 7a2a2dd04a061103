"""Difference between an object's estimated and true pose; for reports, never for decisions."""

from __future__ import annotations

from dataclasses import dataclass

from coral.contact.perception.symmetry import Symmetry
from coral.contact.scene.observation import BodyState
from coral.contact.scene.rigid_transform import body_to_matrix


@dataclass(frozen=True)
class PoseDifference:
    """The error of one object's pose at one time."""

    off_m: float
    off_rad: float
    """Difference between the true pose and the planner's estimate, modulo the object's symmetry."""
    lost: bool
    """Whether the tracker had lost the object."""


def compare_poses(symmetry: Symmetry, believed: BodyState, true: BodyState, lost: bool) -> PoseDifference:
    """Compute the error of one object's pose."""
    shift, turn = symmetry.difference(body_to_matrix(believed), body_to_matrix(true))
    return PoseDifference(float(shift), float(turn), lost)
