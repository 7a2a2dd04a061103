"""The sources of masks by name: `--masks`, its help and its errors follow from this registry."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from coral.contact.perception.object_model import ObjectModel
from coral.contact.real_scenes.masks.colour_masks import ColourMasks, paint_regions, read_colours
from coral.contact.real_scenes.masks.mask_source import MaskSource
from coral.contact.scene.trial import Trial
from coral.errors import InputError
from coral.plugins import named_plugin

GROUP = "coral.masks"
MASKS = {"colour[:FILE]": "the colours of the task file, or of a file"}
"""Description of each form of the value after `--masks`, as half a sentence."""


def mask_help() -> str:
    """List the sources of masks with their descriptions, for the command line's help."""
    return "; or ".join(f"{form}, {what}" for form, what in MASKS.items())


def make_masks(word: str, trial: Trial, models: Mapping[str, ObjectModel]) -> MaskSource:
    """Make the source of masks that a word names, NAME or NAME:REST.

    Raises:
        InputError: There is no such source, its file is broken, or objects have the same colour and no file has others.
    """
    name, _, rest = word.partition(":")
    if name != "colour":
        made: MaskSource = named_plugin(GROUP, name, "--masks", ours=["colour"])(rest, trial, models)
        return made
    if not rest:
        return ColourMasks(paint_regions({name: trial.task.object(name).color for name in models}, trial.task.name))
    regions = read_colours(Path(rest))
    for name in models:
        if name not in regions:
            raise InputError(rest, f"objects.{name}", "missing", f"an entry for each object: {', '.join(models)}")
    return ColourMasks({name: regions[name] for name in models})
