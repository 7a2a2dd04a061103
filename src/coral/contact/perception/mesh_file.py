"""Reads the triangles of STL, OBJ and PLY files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.ply_file import read_ply
from coral.errors import InputError
from coral.foreign_file import read_bytes
from coral.limits import MESH_BYTES

Array = NDArray[np.float64]


def read_mesh(path: Path, scale: float = 1.0) -> Array:
    """Read the triangles of an STL, PLY (both binary or text) or OBJ file, Shape=(M, 3, 3) m.

    Args:
        path: The file.
        scale: Metres per unit of the file: 0.001 for millimetres.

    Raises:
        InputError: The file cannot be read, or contains no triangles.
    """
    raw = read_bytes(path, "a readable STL, OBJ or PLY file", MESH_BYTES)
    try:
        if path.suffix.lower() == ".obj":
            triangles = _obj(raw.decode("utf-8"))
        elif path.suffix.lower() == ".ply":
            triangles = read_ply(raw)
        elif len(raw) >= 84 and len(raw) == 84 + 50 * int.from_bytes(raw[80:84], "little"):
            layout = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
            triangles = np.frombuffer(raw, layout, offset=84)["corners"].astype(float)
        else:
            words = [line.split()[1:4] for line in raw.decode("ascii").splitlines() if line.split()[:1] == ["vertex"]]
            triangles = np.array(words, float).reshape(-1, 3, 3)
    except (UnicodeDecodeError, ValueError, IndexError, KeyError, OverflowError) as error:
        raise InputError(str(path), "", f"broken mesh ({error})", "an STL, OBJ or PLY file") from None
    if not len(triangles) or not np.isfinite(triangles).all():
        raise InputError(str(path), "", "no finite triangles", "an STL, OBJ or PLY file with triangles")
    return triangles * scale


def _obj(text: str) -> Array:
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            corner = [int(w.split("/")[0]) for w in words[1:]]
            corner = [c - 1 if c >= 0 else len(vertices) + c for c in corner]
            if min(corner, default=0) < 0:
                raise IndexError("a face names a vertex that is not there")
            faces += [(corner[0], corner[k], corner[k + 1]) for k in range(1, len(corner) - 1)]
    return np.asarray(np.array(vertices, float).reshape(-1, 3)[np.array(faces, int).reshape(-1, 3)])
