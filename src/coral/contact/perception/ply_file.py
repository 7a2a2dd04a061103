"""Reads the triangles of PLY files, as BOP data sets have them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def read_ply(raw: bytes) -> Array:
    """Return the triangles, Shape=(M, 3, 3), of a PLY file (text or binary) of which all faces are triangles.

    Raises:
        ValueError, KeyError, IndexError: The file is broken, or has other faces or elements.
    """
    end = raw.index(b"end_header")
    body = raw[raw.index(b"\n", end) + 1 :]
    lines = [line.split() for line in raw[:end].decode("ascii").splitlines()]
    if lines[0] != ["ply"]:
        raise ValueError("no 'ply' in the first line")
    (form,) = (line[1] for line in lines if line[:1] == ["format"])
    counts: dict[str, int] = {}
    properties: dict[str, list[list[str]]] = {}
    name = ""
    for line in lines:
        if line[:1] == ["element"]:
            name, counts[line[1]] = line[1], int(line[2])
            properties[name] = []
        elif line[:1] == ["property"]:
            properties[name].append(line[1:])
    if list(counts)[:2] != ["vertex", "face"]:
        raise ValueError(f"elements {list(counts)} instead of vertex and face")
    vertices, faces = counts["vertex"], counts["face"]
    columns = [words[-1] for words in properties["vertex"]]
    place = [columns.index(axis) for axis in "xyz"]
    if form == "ascii":
        rows = body.decode("ascii").splitlines()
        points = np.array([row.split()[: len(columns)] for row in rows[:vertices]], float)[:, place]
        corners = np.array([row.split()[:4] for row in rows[vertices : vertices + faces]], int)
    else:
        order = _ORDERS[form]
        row = np.dtype([(words[-1], order + _TYPES[words[0]]) for words in properties["vertex"]])
        found = np.frombuffer(body, row, vertices)
        points = np.column_stack([found[axis] for axis in "xyz"]).astype(float)
        start = vertices * row.itemsize
        face = np.dtype(_face_columns(properties["face"], order, body, start))
        indices = np.frombuffer(body, face, faces, start)
        for column in filter(lambda name: name.startswith("count of "), face.names or ()):
            if (indices[column] != indices[column][0]).any():
                raise ValueError(f"a {column.removeprefix('count of ')} that differs from face to face")
        corners = np.column_stack([indices["count"], indices["corners"]]).astype(int)
    if not (corners[:, 0] == 3).all():
        raise ValueError("a face that is no triangle")
    if corners[:, 1:].min() < 0:
        raise IndexError("a face names a vertex that is not there")
    return np.asarray(points[corners[:, 1:]])


def _face_columns(
    properties: list[list[str]], order: str, body: bytes, start: int
) -> list[tuple[str, str] | tuple[str, str, int]]:
    """Return the columns of a face; its list of corners has room for three, another list as for the first face."""
    columns: list[tuple[str, str] | tuple[str, str, int]] = []
    for words in properties:
        if words[0] != "list":
            columns.append((words[-1], order + _TYPES[words[0]]))
        elif words[-1] in ("vertex_indices", "vertex_index"):
            columns += [("count", order + _TYPES[words[1]]), ("corners", order + _TYPES[words[2]], 3)]
        else:  # texture coordinates, for example
            count = f"count of {words[-1]}"
            columns.append((count, order + _TYPES[words[1]]))
            size = int(np.frombuffer(body, np.dtype(columns), 1, start)[count][0])
            if not 0 <= size <= 64:
                raise ValueError(f"{size} values of {words[-1]} in a face")
            columns += [(words[-1], order + _TYPES[words[2]], size)] if size else []
    return columns
