"""Distances of boxes as an independent method finds them, also where MuJoCo says 0."""

import mujoco
import numpy as np
import pytest

from coral.contact.scene.geom_gap import geom_gap
from coral.contact.scene.geometry import from_rotvec, rotation_of

TABLE, FINGER = np.array([0.4, 0.4, 0.025]), np.array([0.006, 0.002, 0.022])
XML = """<mujoco><worldbody><geom type="box" size=".4 .4 .025"/>
<body><freejoint/><geom type="box" size=".006 .002 .022"/></body></worldbody></mujoco>"""


@pytest.fixture(scope="module")
def boxes():
    model = mujoco.MjModel.from_xml_string(XML)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def place(data, position, turn):
    data.geom_xpos[1], data.geom_xmat[1] = position, rotation_of(from_rotvec(turn)).reshape(9)


def distance_by_projections(position, turn):
    rotation, point = rotation_of(from_rotvec(turn)), np.array(position)
    for _ in range(20_000):
        other = np.clip(point, -TABLE, TABLE)
        before, point = point, position + rotation @ np.clip(rotation.T @ (other - position), -FINGER, FINGER)
        if np.linalg.norm(point - before) < 1e-12:
            break
    return np.linalg.norm(point - np.clip(point, -TABLE, TABLE))


def test_it_finds_the_distance_where_mujoco_does_not(boxes):
    model, data = boxes
    rng = np.random.default_rng(0)
    fooled = 0
    for _ in range(150):
        position, turn = rng.uniform([-0.5, -0.5, 0.06], [0.5, 0.5, 0.2]), rng.uniform(-2, 2, 3) * rng.integers(0, 2)
        place(data, position, turn)
        fooled += mujoco.mj_geomDistance(model, data, 1, 0, 1.0, None) < 1e-3
        distance, start, end = geom_gap(model, data, 1, 0, 1.0)
        assert distance == pytest.approx(distance_by_projections(position, turn), abs=2e-5)
        assert np.linalg.norm(end - start) == pytest.approx(distance, abs=1e-5)
        assert data.geom_xmat[1] == pytest.approx(rotation_of(from_rotvec(turn)).reshape(9))
    assert fooled > 0, "MuJoCo is right now: the second try is no longer needed"


def test_overlapping_boxes_have_a_negative_distance(boxes):
    model, data = boxes
    place(data, [0.0, 0.0, 0.04], np.zeros(3))
    assert geom_gap(model, data, 1, 0, 1.0)[0] == pytest.approx(-0.007, abs=1e-5)


def test_far_boxes_are_as_far_as_was_asked(boxes):
    model, data = boxes
    place(data, [0.0, 0.0, 0.5], np.zeros(3))
    assert geom_gap(model, data, 1, 0, 0.05)[0] == 0.05
