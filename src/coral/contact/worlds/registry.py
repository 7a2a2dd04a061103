"""The evaluation worlds by name."""

from __future__ import annotations

from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import EvaluationWorld
from coral.errors import InputError, nearest
from coral.plugins import find_plugins, has_plugin, named_plugin

GROUP = "coral.worlds"


def make_world(name: str, trial: Trial, period_s: float) -> EvaluationWorld:
    """Make an evaluation world: "panda", the robot in robosuite; "hand", the free-flying hand; or an entry point.

    Raises:
        InputError: No world has this name.
        RunError: A package that it needs is not installed.
    """
    check_world(name)
    made: EvaluationWorld = named_plugin(GROUP, name, "--world")(trial, period_s)
    return made


def check_world(name: str, where: str = "--world", also: tuple[str, ...] = ()) -> None:
    """Check that a world of this name exists; `also` are further names to suggest, which are no evaluation worlds.

    Raises:
        InputError: There is none.
    """
    if not has_plugin(GROUP, name):
        known = (*find_plugins(GROUP), *also)
        raise InputError(where, "", repr(name), f"one of {', '.join(known)}{nearest(name, known)}")
