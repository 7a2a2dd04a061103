"""The script that runs in Blender: it imports nothing of this package, so that bpy's own environment can run it."""

import ast

from coral.reef.paint import blender_script
from coral.reef.paint.blender import SCRIPT
from coral.reef.paint.blender_scene import solid_of_index


def test_the_script_stands_alone():
    names = set()
    for node in ast.walk(ast.parse(SCRIPT.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(str(node.module).split(".")[0])
    assert names <= {"__future__", "json", "math", "os", "sys", "typing", "numpy", "bpy", "bmesh", "mathutils"}


def test_indices_mean_the_same_on_both_sides():
    import numpy as np

    indices = np.array([0, blender_script.FLOOR_INDEX, blender_script.FIRST_INDEX])
    instances, floor = solid_of_index(indices)
    assert instances.tolist() == [-1, -1, 0]
    assert floor.tolist() == [False, True, False]


def test_a_solid_of_unit_size_gets_its_extents_and_place(monkeypatch):
    monkeypatch.setattr(blender_script, "_rows", lambda matrix: matrix)
    solid = {"rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "half": [1.0, 2.0, 3.0], "center": [7.0, 8.0, 9.0]}
    assert blender_script._matrix(solid) == [[0, -2, 0, 7], [1, 0, 0, 8], [0, 0, 3, 9], [0, 0, 0, 1]]
