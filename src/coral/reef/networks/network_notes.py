"""What is stated about a network: in its file, in files that were exported with it, and by its user."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from coral.config import read_config
from coral.errors import InputError
from coral.foreign_file import read_json
from coral.onnx_file import OnnxFile
from coral.reef.networks.class_table import read_names

SUFFIX = ".eyes.yaml"
_HUGGING_FACE = "pixel_values"
"""Name of the input of networks that were exported from transformers."""


@dataclass(frozen=True)
class PictureInput:
    """value = (byte * factor - mean) / spread, by channel."""

    name: str
    """Of the scaling, for people."""
    factor: float = 1.0 / 255.0
    mean: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spread: tuple[float, float, float] = (1.0, 1.0, 1.0)
    bgr: bool = False
    """Blue first; mean and spread are in the order of the channels."""

    def tensor(self, rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Return a picture as a network reads it. Shape=(H, W, 3), red first, to (1, 3, H, W)."""
        ordered = rgb[:, :, ::-1] if self.bgr else rgb
        scaled = ordered.astype(np.float32) * np.float32(self.factor)
        values = (scaled - np.array(self.mean, np.float32)) / np.array(self.spread, np.float32)
        return np.ascontiguousarray(values.transpose(2, 0, 1)[None])

    def describe(self) -> str:
        """Say it in a few words."""
        return f"{'BGR' if self.bgr else 'RGB'}, {self.name}"


UNIT = PictureInput("0 to 1")
BYTES = PictureInput("0 to 255", factor=1.0)
IMAGENET = PictureInput("normalised as ImageNet", mean=(0.485, 0.456, 0.406), spread=(0.229, 0.224, 0.225))
SCALINGS = {"unit": UNIT, "bytes": BYTES, "imagenet": IMAGENET}
"""By the name that a user states."""


@dataclass(frozen=True, kw_only=True)
class EyesFileCfg:
    """What a user states about NAME.onnx, in NAME.eyes.yaml beside it. It wins over what the export says."""

    classes: dict[int | str, Literal["oyster", "obstacle", "seabed", "water"]] = field(default_factory=dict)
    """What classes are, by name or number."""
    channels: Literal["rgb", "bgr"] | None = None
    """Order of the picture's channels; rgb by default."""
    pixels: Literal["unit", "bytes", "imagenet"] | None = None
    """Scaling of the picture: 0 to 1, 0 to 255, or normalised by mean and spread of ImageNet."""
    depth: Literal["relative", "metric"] | None = None
    """Of a depth network: relative inverse depth, or metres."""


@dataclass(frozen=True, kw_only=True)
class NetworkNotes:
    """What is stated about a network."""

    names: Mapping[int, str]
    """Of its classes; empty where nobody says."""
    task: str
    """As Ultralytics says it; empty where nobody does."""
    suppressed: bool | None
    """Whether the network leaves out doubles of an object by itself; None where nobody says."""
    size: tuple[int, int] | None
    """Width and height of its pictures (px)."""
    depth: Literal["relative", "metric"] | None
    pixels: PictureInput | None
    """None where nobody says."""
    stated: EyesFileCfg

    def picture_input(self, usual: PictureInput) -> PictureInput:
        """Return how pictures are given to it: as the user states, as the export says, or as is usual."""
        said = SCALINGS[self.stated.pixels] if self.stated.pixels else self.pixels or usual
        return replace(said, bgr=self.stated.channels == "bgr")


def read_notes(file: OnnxFile) -> NetworkNotes:
    """Read metadata, `config.json` and `preprocessor_config.json` of an export, and the user's file.

    Raises:
        InputError: A file is broken, or two of them contradict each other.
    """
    path = Path(file.path)
    config, preprocessor = _beside(path, "config.json"), _beside(path, "preprocessor_config.json")
    own = path.with_suffix(SUFFIX)
    stated = read_config(own, EyesFileCfg()) if own.is_file() else EyesFileCfg()
    metadata = file.metadata
    names = read_names(metadata["names"], file.path) if "names" in metadata else {}
    listed = config.get("id2label")
    if isinstance(listed, Mapping):
        other = read_names(repr(dict(listed)), file.path)
        if names and other != names:
            expected = f"the names in config.json: {', '.join(other.values())}"
            raise InputError(file.path, "metadata.names", ", ".join(names.values()), expected)
        names = names or other
    arguments = _literal(metadata.get("args", ""))
    nms = arguments.get("nms") if isinstance(arguments, Mapping) else None
    end_to_end = {"True": True, "False": False}.get(metadata.get("end2end", ""))
    return NetworkNotes(
        names=names,
        task=metadata.get("task", ""),
        suppressed=True if nms or end_to_end else False if nms is False and end_to_end is False else None,
        size=_size(_literal(metadata.get("imgsz", ""))) or _size(preprocessor.get("size")),
        depth=_depth(stated, config, file.path),
        pixels=_pixels(preprocessor, file),
        stated=stated,
    )


def _beside(path: Path, name: str) -> Mapping[str, Any]:
    for folder in (path.parent, *([path.parent.parent] if path.parent.name == "onnx" else [])):
        if (folder / name).is_file():
            found = read_json(folder / name, "an object, as transformers writes it")
            known = isinstance(found, Mapping) and ("model_type" in found or name != "config.json")
            return found if known else {}
    return {}


def _literal(text: str) -> Any:
    try:
        return ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        return None


def _size(found: Any) -> tuple[int, int] | None:
    if isinstance(found, Mapping):
        found = found.get("height"), found.get("width")
    if isinstance(found, int):
        found = found, found
    whole = isinstance(found, list | tuple) and len(found) == 2 and all(type(n) is int and n > 0 for n in found)
    return (found[1], found[0]) if whole else None


def _depth(stated: EyesFileCfg, config: Mapping[str, Any], path: str) -> Literal["relative", "metric"] | None:
    said = config.get("depth_estimation_type")
    exported: Literal["relative", "metric"] | None = said if said in ("relative", "metric") else None
    if stated.depth and exported and stated.depth != exported:
        raise InputError(path, "depth", f"{stated.depth} in {SUFFIX}", f"{exported}, as config.json says")
    return stated.depth or exported


def _pixels(preprocessor: Mapping[str, Any], file: OnnxFile) -> PictureInput | None:
    if not preprocessor:
        return SCALINGS["imagenet"] if _HUGGING_FACE in file.inputs else None
    factor = preprocessor.get("rescale_factor", 1.0 / 255.0) if preprocessor.get("do_rescale", True) else 1.0
    mean, spread = preprocessor.get("image_mean"), preprocessor.get("image_std")
    if not preprocessor.get("do_normalize", True):
        mean, spread = (0.0,) * 3, (1.0,) * 3
    try:
        made = PictureInput("scaled as preprocessor_config.json says", float(factor), _three(mean), _three(spread))
    except (TypeError, ValueError):
        found = f"rescale_factor {factor}, image_mean {mean}, image_std {spread}"
        raise InputError(file.path, "preprocessor_config.json", found[:120], "numbers, three by three") from None
    return next((one for one in SCALINGS.values() if replace(one, name=made.name) == made), made)


def _three(values: Any) -> tuple[float, float, float]:
    red, green, blue = (float(one) for one in values)
    if not all(abs(one) < 1e6 for one in (red, green, blue)):
        raise ValueError
    return red, green, blue
