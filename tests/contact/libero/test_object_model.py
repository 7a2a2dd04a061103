"""The boxes and regions of an object's model file."""

import re

import numpy as np
import pytest

from coral.contact.libero.object_model import Box, read_model
from coral.contact.scene.geometry import from_rpy_deg, rotation_of
from coral.errors import InputError

TURN = rotation_of(from_rpy_deg([0, 0, 90]))


def test_a_turned_box_has_its_corners_and_its_inside_turned():
    box = Box(np.array([0.1, 0.0, 0.0]), np.eye(3), np.array([0.2, 0.04, 0.06])).turned(TURN)
    assert box.corners.min(axis=0) == pytest.approx([-0.02, 0.0, -0.03])
    assert box.corners.max(axis=0) == pytest.approx([0.02, 0.2, 0.03])
    inside = box.contains(np.array([[0.0, 0.19, 0.0], [0.1, 0.0, 0.0], [0.019, 0.01, 0.029], [0.021, 0.01, 0.0]]))
    assert inside.tolist() == [True, False, True, False]


def test_what_is_shown_does_not_touch(package):
    path = package.model("can")
    text = path.read_text(encoding="utf-8")
    shown = '<geom type="mesh" mesh="seen" contype="0" conaffinity="0" group="1"/>'
    assert shown in text
    for kept in ('contype="0"', 'group="1"'):
        path.write_text(text.replace(shown, f'<geom type="mesh" mesh="seen" {kept}/>'), encoding="utf-8")
        assert len(read_model(path).boxes) == 8


def test_mass_is_the_volume_of_all_boxes_at_their_density(package):
    found = read_model(package.model("slab"))
    assert found.mass_kg == pytest.approx(0.06 * 0.04 * 0.02 * 100)
    assert found.friction == 0.95
    assert found.boxes[0].size == pytest.approx([0.06, 0.04, 0.02])


def test_a_region_is_a_box_by_its_name(package):
    found = read_model(package.model("bin"))
    assert list(found.regions) == ["hold_region"]
    assert found.regions["hold_region"].position == pytest.approx([0.0, 0.0, 0.05])
    assert found.boxes[0].rotation == pytest.approx(np.eye(3))  # a quaternion of length 2


def test_numbers_that_are_left_out_are_those_of_mujoco(package):
    path = package.model("slab")
    text = re.sub(r'(density|friction)="[^"]*"', "", path.read_text(encoding="utf-8"))
    path.write_text(text, encoding="utf-8")
    found = read_model(path)
    assert (found.mass_kg, found.friction) == (pytest.approx(0.06 * 0.04 * 0.02 * 1000), 1.0)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("<mujoco>", "<mujoco", "a MuJoCo model"),
        ('name="object"', 'name="other"', "a model of LIBERO"),
        ('type="box"', 'type="sphere"', "found sphere, expected boxes that touch"),
        ('pos="0 0.01 0"', 'pos="0 nan 0"', "3 numbers"),
        ('size="0.0295', 'size="-0.0295', "a box"),
        ('density="100"', 'density="much"', "a number"),
    ],
)
def test_a_damaged_model_is_named(old, new, expected, package):
    path = package.model("can")
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=expected) as caught:
        read_model(path)
    assert "can.xml" in str(caught.value)
