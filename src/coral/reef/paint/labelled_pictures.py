"""Real pictures with oysters marked by hand: YOLO (Roboflow), COCO, masks, CoralNet's points."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import MALFORMED, InputError
from coral.foreign_file import read_json, read_picture_file, read_text
from coral.limits import TABLE_BYTES
from coral.reef.paint.collage import OTHER
from coral.reef.world.geometry import Label
from coral.yaml_file import load_mapping

UNKNOWN = 255
"""Label of a pixel of which nothing is known."""
PICTURES = (".jpg", ".jpeg", ".png")
_FRAME = re.compile(r"[-_ ]*\d+(_(jpe?g|png))?(\.rf\.[0-9a-f]+)?$")


class LabelFiles:
    """What a folder of labelled pictures may hold: the first of these."""

    COCO: Final = ("_annotations.coco.json", "annotations.json", "instances.json", "coco.json")
    """COCO: outlines or boxes."""
    POINTS: Final = ("annotations.csv",)
    """CoralNet's points, with Name, Row, Column, Label; all between them is unknown."""
    MASKS: Final = ("NAME_mask.png", "masks/NAME.png")
    """Masks of the pictures NAME, not 0 where oysters are."""
    OUTLINES: Final = ("NAME.txt", "labels/NAME.txt")
    """YOLO, Roboflow's export: class and outline, or class and box (oyster inside the ellipse, corners unknown), in
    fractions of width and height. Pictures may lie in `images`, names of classes in `data.yaml`."""


@dataclass(frozen=True)
class LabelledPicture:
    """A picture and what is known of its pixels."""

    name: str
    rgb: NDArray[np.uint8]
    """sRGB. Shape=(H, W, 3)."""
    target: NDArray[np.uint8]
    """`Label.OYSTER`, `OTHER` or `UNKNOWN`. Shape=(H, W)."""
    of_points: bool = False
    """Whether only points are known, and not outlines or boxes."""

    @property
    def video(self) -> str:
        """The name without the number of the frame: pictures of one video are never split."""
        return video_of(self.name)


def video_of(name: str) -> str:
    """Return the video that a picture's name, without its ending, belongs to."""
    return _FRAME.sub("", name) or name


def read_labelled(folder: Path, oysters: tuple[str, ...] = ()) -> Iterator[LabelledPicture]:
    """Read a folder of labelled pictures; what lies in it says of which kind it is.

    `LabelFiles` are told apart by name. A folder with parts train, valid or test is all of them together. `oysters` are
    names (or numbers, where there are no names) of classes that are oysters; all, by default.

    Raises:
        InputError: There are no labels, or a file is broken.
    """
    parts = [folder / part for part in ("train", "valid", "test") if (folder / part).is_dir()] or [folder]
    count = 0
    for part in parts:
        for picture in _read_part(part, oysters):
            count += 1
            yield picture
    if not count:
        raise InputError(str(folder), "", "no labelled picture", "pictures with YOLO, COCO, mask or CoralNet labels")


def _read_part(folder: Path, oysters: tuple[str, ...]) -> Iterator[LabelledPicture]:
    for files, read in ((LabelFiles.COCO, _read_coco), (LabelFiles.POINTS, _read_points)):
        if (found := _find(folder, files)) is not None:
            yield from read(found, oysters)
            return
    images = folder / "images" if (folder / "images").is_dir() else folder
    names = _yolo_names(folder)
    for path in sorted(p for p in images.iterdir() if p.suffix.lower() in PICTURES and not p.stem.endswith("_mask")):
        mask, outline = (_find(folder, files, path) for files in (LabelFiles.MASKS, LabelFiles.OUTLINES))
        if mask is None and outline is None:
            continue
        rgb = _read_rgb(path)
        target = _mask_target(mask, rgb) if mask is not None else _yolo_target(outline, rgb, names, oysters)
        yield LabelledPicture(path.stem, rgb, target)


def _find(folder: Path, files: tuple[str, ...], picture: Path | None = None) -> Path | None:
    """Return the first of these files that exists; those of a picture lie beside it or in a folder of their own."""
    beside, stem = (folder, "") if picture is None else (picture.parent, picture.stem)
    found = ((folder if "/" in name else beside) / name.replace("NAME", stem) for name in files)
    return next((one for one in found if one.is_file()), None)


def _mask_target(path: Path, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
    mask = read_picture_file(path)
    if mask is None or mask.shape[:2] != rgb.shape[:2]:
        raise InputError(str(path), "", "no mask of its picture", "a PNG of the picture's size, 0 where no oyster is")
    there = mask if mask.ndim == 2 else mask[..., :3].max(axis=2)
    return np.where(there > 0, np.uint8(Label.OYSTER), np.uint8(OTHER)).astype(np.uint8)


def _yolo_names(folder: Path) -> list[str]:
    for path in (folder / "data.yaml", folder.parent / "data.yaml"):
        if path.is_file():
            names = load_mapping(read_text(path, "names of classes"), str(path)).get("names", [])
            return [str(name) for name in (names.values() if isinstance(names, dict) else names)]
    return []


def _yolo_target(
    path: Path | None, rgb: NDArray[np.uint8], names: list[str], oysters: tuple[str, ...]
) -> NDArray[np.uint8]:
    assert path is not None
    size = np.array([rgb.shape[1], rgb.shape[0]], np.float64)
    marks = []
    for number, line in enumerate(read_text(path, "labels of a picture", TABLE_BYTES).splitlines(), start=1):
        if not line.strip():
            continue
        try:
            kind, *values = (float(part) for part in line.split())
            numbers = np.array(values)
            if kind != int(kind) or len(numbers) < 4 or len(numbers) % 2 or not np.all(np.abs(numbers) < 10):
                raise ValueError
        except MALFORMED:
            raise InputError(str(path), f"line {number}", line[:60], "class x y x y ... in fractions") from None
        name = names[int(kind)] if 0 <= int(kind) < len(names) else str(int(kind))
        if oysters and name not in oysters:
            continue
        box = len(numbers) == 4
        points = _box_corners(*numbers) if box else numbers.reshape(-1, 2)
        marks.append((points * size, box))
    return fill_target(rgb.shape[:2], marks)


def _box_corners(x: float, y: float, width: float, height: float) -> NDArray[np.float64]:
    half = np.array([width, height]) / 2
    return np.asarray(np.array([x, y]) + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]), np.float64)


def fill_target(shape: tuple[int, ...], marks: list[tuple[NDArray[np.float64], bool]]) -> NDArray[np.uint8]:
    """Fill outlines (px), Shape=(N, 2), with oyster: a box is one inside its ellipse, its corners are unknown."""
    target = np.full(shape[:2], OTHER, np.uint8)
    for points, box in sorted(marks, key=lambda mark: not mark[1]):
        corners = np.round(np.clip(points, -10_000, 20_000)).astype(np.int32)
        if box:
            kept = target.copy()
            cv2.fillPoly(target, [corners], UNKNOWN)
            target[kept == int(Label.OYSTER)] = int(Label.OYSTER)
            (x0, y0), (x1, y1) = corners.min(axis=0), corners.max(axis=0)
            middle, axes = (int(x0 + x1) // 2, int(y0 + y1) // 2), (int(x1 - x0) // 2, int(y1 - y0) // 2)
            cv2.ellipse(target, middle, axes, 0, 0, 360, int(Label.OYSTER), -1)
        else:
            cv2.fillPoly(target, [corners], int(Label.OYSTER))
    return target


def _read_coco(path: Path, oysters: tuple[str, ...]) -> Iterator[LabelledPicture]:
    content = read_json(path, "COCO annotations")
    try:
        names = {one["id"]: str(one["name"]) for one in content["categories"]}
        wanted = {key for key, name in names.items() if not oysters or name in oysters}
        marks: dict[Any, list[tuple[NDArray[np.float64], bool]]] = {one["id"]: [] for one in content["images"]}
        for one in content["annotations"]:
            if one["category_id"] not in wanted:
                continue
            if isinstance(one.get("segmentation"), list) and one["segmentation"]:
                marks[one["image_id"]] += [
                    (np.array(ring, np.float64).reshape(-1, 2), False) for ring in one["segmentation"]
                ]
            else:
                x, y, width, height = (float(v) for v in one["bbox"])
                marks[one["image_id"]].append((_box_corners(x + width / 2, y + height / 2, width, height), True))
        files = [(one["id"], str(one["file_name"])) for one in content["images"]]
    except MALFORMED as error:
        raise InputError(str(path), "", f"a broken file ({error})", "COCO annotations with outlines or boxes") from None
    for key, name in files:
        rgb = _read_rgb(_inside(path.parent, name))
        yield LabelledPicture(Path(name).stem, rgb, fill_target(rgb.shape, marks[key]))


def _read_points(path: Path, oysters: tuple[str, ...]) -> Iterator[LabelledPicture]:
    points: dict[str, list[tuple[int, int, str]]] = {}
    rows = csv.DictReader(read_text(path, "CoralNet's annotations", TABLE_BYTES).splitlines())
    for number, row in enumerate(rows, start=2):
        try:
            points.setdefault(row["Name"], []).append((int(row["Row"]), int(row["Column"]), row["Label"]))
        except MALFORMED:
            raise InputError(str(path), f"line {number}", "a broken line", "Name, Row, Column, Label") from None
    for name, places in points.items():
        rgb = _read_rgb(_inside(path.parent, name))
        target = np.full(rgb.shape[:2], UNKNOWN, np.uint8)
        for across, along, label in places:
            oyster = label in oysters if oysters else "oyster" in re.split(r"[^a-z]+", label.lower())
            cv2.circle(target, (along, across), max(2, rgb.shape[1] // 200), int(Label.OYSTER) if oyster else OTHER, -1)
        yield LabelledPicture(Path(name).stem, rgb, target, of_points=True)


def _inside(folder: Path, name: str) -> Path:
    path = folder / name
    if not path.resolve().is_relative_to(folder.resolve()):
        raise InputError(str(folder), name, "a path that leads out of it", "names of pictures in the folder")
    return path


def _read_rgb(path: Path) -> NDArray[np.uint8]:
    image = read_picture_file(path, cv2.IMREAD_COLOR)
    if image is None:
        raise InputError(str(path), "", "nothing readable", "a picture")
    return np.ascontiguousarray(image[..., ::-1]).astype(np.uint8)
