"""A folder of pictures with depth, classes and poses: `pictures.csv` and three PNG files for each."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from coral.errors import MALFORMED, InputError
from coral.file_writer import open_log, write_whole
from coral.foreign_file import read_picture_file, read_text
from coral.limits import TABLE_BYTES
from coral.reef.world.geometry import Frame, Label, Pose

INDEX = "pictures.csv"
COLUMNS = ("name", "world", "water", "x", "y", "theta", "height", "pitch_down_deg", "hfov_deg", "range_m")


@dataclass(frozen=True, kw_only=True)
class TakenPicture:
    """One picture of a set."""

    name: str
    """Its files are NAME_rgb.png, NAME_depth.png (16 bit, mm, 0: nothing) and NAME_labels.png (`Label`)."""
    world: str
    water: str
    pose: Pose
    """True pose of the body."""
    height: float
    """Of the camera above the seabed (m)."""
    pitch_down_deg: float
    hfov_deg: float
    range_m: float
    """Range beyond which surfaces count as water (m)."""


def write_picture(folder: Path, about: TakenPicture, frame: Frame) -> None:
    """Add a picture to a set; the set's index gets a line.

    Args:
        folder: Of the set; it is made if need be.
        about: The picture's line.
        frame: With its colours.

    Raises:
        InputError: A file cannot be written.
    """
    if frame.rgb is None:
        raise ValueError("the frame has no colours")
    millimetres = np.where(np.isfinite(frame.depth), np.minimum(frame.depth * 1000.0, 65535.0), 0.0)
    images: dict[str, NDArray[Any]] = {
        "rgb": frame.rgb[..., ::-1],
        "depth": np.round(millimetres).astype(np.uint16),
        "labels": frame.labels,
    }
    try:
        for kind, image in images.items():
            encoded = cv2.imencode(".png", image)[1]
            write_whole(folder / f"{about.name}_{kind}.png", encoded.tobytes())
        index = folder / INDEX
        fresh = not index.exists()
        with open_log(index, new=False) as file:
            lines = csv.writer(file, lineterminator="\n")
            if fresh:
                lines.writerow(COLUMNS)
            place = (about.pose.x, about.pose.y, about.pose.theta, about.height)
            lens = (about.pitch_down_deg, about.hfov_deg, about.range_m)
            lines.writerow([about.name, about.world, about.water, *(f"{v:.6f}" for v in place), *lens])
    except OSError as error:
        raise InputError(str(folder), "", error.strerror or "an error", "a folder that can be written") from None


def read_pictures(folder: Path) -> Iterator[tuple[TakenPicture, Frame]]:
    """Read the pictures of a set one by one.

    Raises:
        InputError: There is no index, or a line or file of it is broken.
    """
    index = folder / INDEX
    rows = list(csv.DictReader(read_text(index, "the index of a set of pictures", TABLE_BYTES).splitlines()))
    for number, row in enumerate(rows, start=2):
        try:
            about = TakenPicture(
                name=row["name"],
                world=row["world"],
                water=row["water"],
                pose=Pose(float(row["x"]), float(row["y"]), float(row["theta"])),
                height=float(row["height"]),
                pitch_down_deg=float(row["pitch_down_deg"]),
                hfov_deg=float(row["hfov_deg"]),
                range_m=float(row["range_m"]),
            )
        except MALFORMED:
            raise InputError(
                str(index), f"line {number}", "a broken line", f"values for {', '.join(COLUMNS)}"
            ) from None
        yield about, _read_frame(folder, about.name)


def _read_frame(folder: Path, name: str) -> Frame:
    images = {}
    for kind in ("rgb", "depth", "labels"):
        path = folder / f"{name}_{kind}.png"
        image = read_picture_file(path)
        if image is None:
            raise InputError(str(path), "", "nothing readable", "a PNG picture")
        images[kind] = image
    metres = images["depth"].astype(np.float32) / np.float32(1000.0)
    depth = np.where(images["depth"] > 0, metres, np.float32(np.inf)).astype(np.float32)
    labels = np.minimum(images["labels"], int(Label.SEABED)).astype(np.uint8)
    rgb = np.ascontiguousarray(images["rgb"][..., ::-1]).astype(np.uint8)
    return Frame(depth, labels, np.full(labels.shape, -1, np.int32), rgb)
