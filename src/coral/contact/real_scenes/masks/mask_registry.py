"""The sources of masks by name: `--masks`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from coral.contact.perception.object_model import ObjectModel
from coral.contact.real_scenes.masks.click_masks import ClickMasks, read_clicks
from coral.contact.real_scenes.masks.colour_masks import ColourMasks, ColourRegion, read_colours
from coral.contact.real_scenes.masks.mask_source import MaskSource
from coral.contact.real_scenes.masks.prompted_network import read_prompted_network
from coral.errors import InputError, nearest


@dataclass(frozen=True)
class MaskSetting:
    """What a source of masks may know."""

    models: Mapping[str, ObjectModel]
    """The objects."""
    regions: Callable[[], Mapping[str, ColourRegion]] | None = None
    """The objects' colours, where they are known without a file."""


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
    if rest:
        regions: Mapping[str, ColourRegion] = read_colours(Path(rest))
        _check_names(rest, regions, setting.models)
    elif setting.regions is not None:
        regions = setting.regions()
    else:
        return None
    return ColourMasks({name: regions[name] for name in setting.models})


def _make_click(rest: str, setting: MaskSetting) -> MaskSource | None:
    if not rest:
        return None
    clicks = read_clicks(Path(rest))
    _check_names(rest, clicks, setting.models)
    return ClickMasks({name: clicks[name] for name in setting.models}, setting.models)


def _make_onnx(rest: str, setting: MaskSetting) -> MaskSource | None:
    if not rest:
        return None
    network, clicks = read_prompted_network(Path(rest))
    _check_names(rest, clicks, setting.models)
    return ClickMasks({name: clicks[name] for name in setting.models}, setting.models, first=network.segment)


MASKS: dict[str, MaskKind] = {
    "colour": MaskKind("colour[:FILE]", "the colours of the task file, or of a file", _make_colour),
    "click": MaskKind("click:FILE", "one click per object in the first picture", _make_click),
    "onnx": MaskKind("onnx:FILE", "a network that segments at these clicks (SAM)", _make_onnx),
}


def mask_help() -> str:
    """List the sources of masks with their descriptions, for the command line's help."""
    return "; or ".join(f"{kind.form}, {kind.help}" for kind in MASKS.values())


def make_masks(word: str, setting: MaskSetting, where: str = "--masks") -> MaskSource:
    """Make the source of masks that a word names.

    Args:
        word: NAME or NAME:FILE.
        setting: What it may know.
        where: Source of the word, for errors.

    Raises:
        InputError: There is no such source, or its file is broken.
    """
    name, _, rest = word.partition(":")
    kind = MASKS.get(name)
    source = kind.make(rest, setting) if kind else None
    if source is None:
        forms = " or ".join(one.form for one in MASKS.values())
        expected = f"{forms}{nearest(name, MASKS)}" if kind is None else f"{name}:FILE"
        raise InputError(where, "", repr(word), expected)
    return source


def _check_names(file: str, found: Iterable[str], models: Mapping[str, ObjectModel]) -> None:
    """Check that a file names all objects."""
    known = set(found)
    for name in models:
        if name not in known:
            raise InputError(file, f"objects.{name}", "missing", f"an entry for each object: {', '.join(models)}")
