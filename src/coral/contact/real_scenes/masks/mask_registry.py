"""The sources of masks by name: `--masks`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from coral.contact.perception.object_model import ObjectModel
from coral.contact.real_scenes.masks.click_masks import ClickMasks, read_clicks
from coral.contact.real_scenes.masks.colour_masks import ColourMasks, ColourRegion, read_colours
from coral.contact.real_scenes.masks.mask_source import MaskSource
from coral.errors import InputError, nearest

V = TypeVar("V")


@dataclass(frozen=True)
class MaskSetting:
    """What a source of masks may know."""

    models: Mapping[str, ObjectModel]
    """The objects."""
    regions: Callable[[], Mapping[str, ColourRegion]]
    """The objects' colours, where no file has them."""


@dataclass(frozen=True)
class MaskKind:
    """A source of masks on the command line."""

    form: str
    """Form of the value after `--masks`."""
    help: str
    """Description, as half a sentence."""
    make: Callable[[str, MaskSetting], MaskSource | None]
    """Makes it from what follows the first colon ("" without one); None where the word is not of this form."""


def _make_colour(rest: str, setting: MaskSetting) -> MaskSource | None:
    return ColourMasks(_of_all(rest, read_colours(Path(rest)), setting) if rest else setting.regions())


def _make_click(rest: str, setting: MaskSetting) -> MaskSource | None:
    return ClickMasks(_of_all(rest, read_clicks(Path(rest)), setting), setting.models) if rest else None


MASKS: dict[str, MaskKind] = {
    "colour": MaskKind("colour[:FILE]", "the colours of the task file, or of a file", _make_colour),
    "click": MaskKind("click:FILE", "one click per object in the first picture", _make_click),
}


def mask_help() -> str:
    """List the sources of masks with their descriptions, for the command line's help."""
    return "; or ".join(f"{kind.form}, {kind.help}" for kind in MASKS.values())


def make_masks(word: str, setting: MaskSetting) -> MaskSource:
    """Make the source of masks that a word names, NAME or NAME:FILE.

    Raises:
        InputError: There is no such source, or its file is broken.
    """
    name, _, rest = word.partition(":")
    kind = MASKS.get(name)
    source = kind.make(rest, setting) if kind else None
    if source is None:
        forms = " or ".join(one.form for one in MASKS.values())
        raise InputError(
            "--masks", "", repr(word), f"{forms}{nearest(name, MASKS)}" if kind is None else f"{name}:FILE"
        )
    return source


def _of_all(file: str, found: Mapping[str, V], setting: MaskSetting) -> dict[str, V]:
    """Return the values of all objects; a file has to name each."""
    for name in setting.models:
        if name not in found:
            raise InputError(
                file, f"objects.{name}", "missing", f"an entry for each object: {', '.join(setting.models)}"
            )
    return {name: found[name] for name in setting.models}
