"""Objects of many boxes as few primitives."""

import numpy as np
import pytest

from coral.contact.libero import simplification
from coral.contact.libero.object_model import Box
from coral.contact.libero.simplification import simplified
from coral.contact.libero.task import libero_task
from coral.contact.scene.geometry import from_rpy_deg, rotation_of

TASK = "pick_up_the_can_and_place_it_in_the_bin"


def box(z, edge):
    return Box(np.array([0, 0, z]), np.eye(3), np.array([edge, 0.05, 0.05]))


def test_an_object_that_fills_no_cylinder_keeps_its_largest_boxes():
    parts = simplified([box(0, 0.1), box(0.05, 0.02), box(0.1, 0.08), box(0.2, 0.03), box(0.3, 0.0001)])
    assert [part.size[0] for part in parts] == [0.1, 0.08, 0.03, 0.02]


def test_boxes_that_add_little_are_left_out():
    parts = simplified([box(0, 0.1), *(box(0.001 * k, 0.02) for k in range(1, 6))])
    assert [part.size[0] for part in parts] == [0.1]


def test_few_boxes_stay(package, monkeypatch):
    monkeypatch.setattr(simplification, "MOST", 12)
    task = libero_task(package, TASK, "few", 0)
    assert [part.shape for part in task.objects[0].parts] == ["box"] * 8


def around(n, radius, height):
    """An upright round of n boxes, like spokes."""
    width = 2 * radius * np.tan(np.pi / (2 * n))
    turns = [rotation_of(from_rpy_deg([0, 0, 180 * k / n])) for k in range(n)]
    return [Box(np.array([0.01, 0.02, 0.1]), turn, np.array([2 * radius, width, height])) for turn in turns]


def test_a_round_of_boxes_becomes_the_cylinder_that_it_fills():
    (part,) = simplified(around(12, 0.03, 0.08))
    assert part.shape == "cylinder"
    assert part.size == pytest.approx((0.06, 0.06, 0.08), abs=5e-4)
    assert part.position == pytest.approx((0.01, 0.02, 0.1))


def test_a_round_that_lies_on_its_side_is_no_upright_cylinder():
    side = rotation_of(from_rpy_deg([90, 0, 0]))
    parts = simplified([one.turned(side) for one in around(12, 0.03, 0.08)])
    assert {part.shape for part in parts} == {"box"}


def test_a_box_keeps_its_turn():
    (part,) = simplified([Box(np.zeros(3), rotation_of(from_rpy_deg([10, -20, 30])), np.full(3, 0.1))])
    assert part.rpy_deg == pytest.approx((10, -20, 30))
