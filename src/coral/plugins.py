"""Parts that other installed packages offer by entry points: advisors, controllers, triggers, verifiers and so on."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from coral.errors import InputError, first_line, nearest

GROUPS = {
    "coral.advisors": "function (name, rest, Setting) that makes an advisor; NAME or NAME:ARGUMENT on the command line",
    "coral.controllers": "function of a ControllerSetup that makes a controller of the vehicle",
    "coral.triggers": "function of a TriggerCfg that makes a trigger, or a function of a TriggerMoment",
    "coral.verifiers": "function (question, answer) that returns why an answer is refused, or None",
    "coral.costs": "function of a Task that makes a cost, a Stage, several stages or a Strategy",
    "coral.hand_controllers": "function (planning world, configuration, generator) that makes a controller of the hand",
    "coral.embedders": "class, or function without arguments, that makes an embedder of instructions for the memory",
    "coral.cameras": "function (rest, T_world_camera or None) that makes an RgbdCamera; NAME[:REST] after --camera",
    "coral.conditions": "class of a condition of success, a subclass of BaseCondition",
}
"""What the entry points of each group are."""


def find_plugins(group: str) -> dict[str, EntryPoint]:
    """Find the entry points of a group by name; nothing is imported."""
    return {point.name: point for point in entry_points(group=group)}


def load_plugin(point: EntryPoint, where: str) -> Any:
    """Import what an entry point names.

    Args:
        point: The entry point.
        where: Flag or argument that asked for it, for the error.

    Raises:
        InputError: It cannot be imported.
    """
    try:
        return point.load()
    except (ImportError, AttributeError) as error:
        package = point.dist.name if point.dist is not None else "a package"
        raise InputError(
            where, "", f"{point.name!r} of {package}, which does not load ({first_line(error)})", point.value
        ) from None


def named_plugin(group: str, name: str, where: str, field: str = "", ours: Sequence[str] = ()) -> Any:
    """Import the entry point of this name.

    Args:
        group: The group.
        name: The name.
        where: Flag, file or argument that named it, for the error.
        field: Field in it.
        ours: Names that come with the package, which the error lists too.

    Raises:
        InputError: There is none of this name, or it cannot be imported.
    """
    known = find_plugins(group)
    if name not in known:
        names = [*ours, *known]
        listed = f"one of {', '.join(names)}, or" if names else "the name of"
        raise InputError(
            where, field, repr(name), f"{listed} an entry point of the group {group}{nearest(name, names)}"
        )
    return load_plugin(known[name], where)
