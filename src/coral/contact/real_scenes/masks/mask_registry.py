"""The sources of masks by name: `--masks`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from coral.contact.perception.object_model import ObjectModel
from coral.contact.real_scenes.masks.click_masks import ClickMasks, read_clicks
from coral.contact.real_scenes.masks.colour_masks import ColourMasks, paint_regions, read_colours
from coral.contact.real_scenes.masks.mask_source import MaskSource
from coral.contact.scene.trial import Trial
from coral.errors import InputError, nearest

V = TypeVar("V")
MASKS = {
    "colour[:FILE]": "the colours of the task file, or of a file",
    "click:FILE": "one click per object in the first picture",
}
"""Description of each form of the value after `--masks`, as half a sentence."""


def mask_help() -> str:
    """List the sources of masks with their descriptions, for the command line's help."""
    return "; or ".join(f"{form}, {what}" for form, what in MASKS.items())


def make_masks(word: str, trial: Trial, models: Mapping[str, ObjectModel]) -> MaskSource:
    """Make the source of masks that a word names, NAME or NAME:FILE.

    Raises:
        InputError: There is no such source, its file is broken, or objects have the same colour and no file has others.
    """
    name, _, file = word.partition(":")
    if word == "colour":
        return ColourMasks(paint_regions({name: trial.task.object(name).color for name in models}, trial.task.name))
    if name == "colour" and file:
        return ColourMasks(_of_all(file, read_colours(Path(file)), models))
    if name == "click" and file:
        return ClickMasks(_of_all(file, read_clicks(Path(file)), models), models)
    raise InputError("--masks", "", repr(word), f"{' or '.join(MASKS)}{nearest(name, ('colour', 'click'))}")


def _of_all(file: str, found: Mapping[str, V], models: Mapping[str, ObjectModel]) -> dict[str, V]:
    """Return the values of all objects; a file has to name each."""
    for name in models:
        if name not in found:
            raise InputError(file, f"objects.{name}", "missing", f"an entry for each object: {', '.join(models)}")
    return {name: found[name] for name in models}
