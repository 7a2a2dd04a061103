"""Commands and configurations as data without importing them, from a cache that is made again when the code changed.

To describe a command its module must be imported, with all that it needs: seconds. Help, completion, a mistyped flag
and `coral config` need the description alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from coral.disk_cache import code_stamp, recall
from coral.errors import MALFORMED
from coral.flags import Described, Flag, FlagGroup, describe

CONFIGURATIONS = {
    "reef": ("coral.reef.mission.mission_cfg:MissionCfg", "--cfg", "a survey"),
    "contact": ("coral.contact.episode.cfg:EpisodeCfg", "--cfg", "an attempt at a contact task"),
    "model": ("coral.advisor.model_cfg:ModelCfg", "--model", "the calls of a real model"),
    "safety": ("coral.reef.sea.safety:SafetyCfg", "--safety", "the limits of a vehicle at sea"),
    "products": ("coral.reef.products.survey_products:ProductsCfg", "--cfg", "maps and tables for an ecologist"),
}
"""Place, flag and subject of each."""


def load(place: str) -> Any:
    """Import what `module:name` names."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def is_installed(place: str) -> bool:
    """Return whether the module of `module:name` is there; it is not imported."""
    return find_spec(place.partition(":")[0]) is not None


def foreign_commands(ours: Mapping[str, object]) -> dict[str, tuple[str, str]]:
    """Find other packages' commands: `module:class` and package by their words. Names of ours cannot be taken."""

    def search() -> list[list[str]]:
        from coral.plugins import find_plugins  # reading the metadata of packages takes a tenth of a second

        points = find_plugins("coral.commands").values()
        return [[point.name, point.value, point.dist.name if point.dist else ""] for point in points]

    found = recall("commands", code_stamp(), search)
    return {
        words: (at, f"(of {package})") for name, at, package in found if (words := name.replace(".", " ")) not in ours
    }


def described(place: str) -> Described:
    """Describe the command or configuration at `module:class`."""
    with suppress(*MALFORMED):
        return _read(recall(place.replace(":", "."), code_stamp(), lambda: asdict(describe(load(place)))))
    return describe(load(place))


def _read(content: Any) -> Described:
    def flag(values: Any) -> Flag:
        return Flag(**{**values, "field": tuple(values["field"]), "names": tuple(values["names"])})

    return Described(
        text=content["text"],
        flags=tuple(map(flag, content["flags"])),
        groups=tuple(FlagGroup(**group) for group in content["groups"]),
    )


def configuration_at(place: str) -> str | None:
    """Return the name of the configuration whose class is at `module:class`."""
    return next((name for name, (known, _, _) in CONFIGURATIONS.items() if known == place), None)
