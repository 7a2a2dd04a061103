"""The evaluation worlds by name."""

from __future__ import annotations

from collections.abc import Callable

from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import EvaluationWorld
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg
from coral.errors import InputError, nearest


def _hand(trial: Trial, period_s: float) -> EvaluationWorld:
    return HandWorld(trial, HandWorldCfg(control_period_s=period_s))


def _panda(trial: Trial, period_s: float) -> EvaluationWorld:
    from coral.contact.worlds.panda.world import PandaWorld, PandaWorldCfg

    return PandaWorld(trial, PandaWorldCfg(control_period_s=period_s))


WORLDS: dict[str, Callable[[Trial, float], EvaluationWorld]] = {"panda": _panda, "hand": _hand}


def make_world(name: str, trial: Trial, period_s: float) -> EvaluationWorld:
    """Make an evaluation world.

    Args:
        name: "panda": the robot in robosuite; "hand": the free-flying hand.
        trial: The trial.
        period_s: Control period.

    Raises:
        InputError: No world has this name.
        RunError: A package that it needs is not installed.
    """
    check_world(name)
    return WORLDS[name](trial, period_s)


def check_world(name: str, where: str = "--world", also: tuple[str, ...] = ()) -> None:
    """Check that a world of this name exists.

    Args:
        name: The name.
        where: Where it was given.
        also: Further names to suggest; they are no evaluation worlds.

    Raises:
        InputError: There is none.
    """
    if name not in WORLDS:
        known = (*WORLDS, *also)
        raise InputError(where, "", repr(name), f"one of {', '.join(known)}{nearest(name, known)}")
