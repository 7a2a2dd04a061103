"""The evaluation worlds by name."""

from __future__ import annotations

from collections.abc import Callable

from coral.contact.scene.trial import Drawn
from coral.contact.worlds.evaluation_world import EvaluationWorld
from coral.contact.worlds.hand_world import HandWorld, HandWorldCfg
from coral.errors import InputError, nearest


def _hand(drawn: Drawn, period_s: float) -> EvaluationWorld:
    return HandWorld(drawn, HandWorldCfg(control_period_s=period_s))


def _panda(drawn: Drawn, period_s: float) -> EvaluationWorld:
    from coral.contact.worlds.panda.world import PandaWorld, PandaWorldCfg

    return PandaWorld(drawn, PandaWorldCfg(control_period_s=period_s))


WORLDS: dict[str, Callable[[Drawn, float], EvaluationWorld]] = {"panda": _panda, "hand": _hand}


def make_world(name: str, drawn: Drawn, period_s: float) -> EvaluationWorld:
    """An evaluation world.

    Args:
        name: "panda": the robot in robosuite; "hand": the free-flying hand.
        drawn: The trial.
        period_s: Of the control.

    Raises:
        InputError: There is no such world.
        RunError: What it needs is not installed.
    """
    check_world(name)
    return WORLDS[name](drawn, period_s)


def check_world(name: str, where: str = "--world") -> None:
    """See that a world exists.

    Raises:
        InputError: It does not.
    """
    if name not in WORLDS:
        raise InputError(where, "", repr(name), f"one of {', '.join(WORLDS)}{nearest(name, WORLDS)}")
