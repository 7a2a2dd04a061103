"""Poses come as datagrams; bad ones are counted and change nothing."""

import json
import socket

import numpy as np
import pytest

from coral.contact.franka.object_poses import (
    PARSED,
    ObjectPoses,
    parse_poses,
    poses_datagram,
)
from coral.contact.scene.observation import BodyState
from coral.errors import InputError

UPRIGHT = np.array([1.0, 0, 0, 0])


@pytest.fixture
def poses():
    receiver = ObjectPoses(("box", "lid"), "127.0.0.1", 0)
    yield receiver
    receiver.close()


def send(poses, data):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(data, ("127.0.0.1", poses.port))


def box_at(x):
    return poses_datagram({"box": BodyState(np.array([x, 0.0, 0.03]), UPRIGHT)})


def test_a_pose_is_kept_with_its_age(poses):
    send(poses, box_at(0.1))
    poses.update(2.0)
    assert poses.poses["box"].position == pytest.approx([0.1, 0.0, 0.03])
    assert poses.age_s("box", 2.5) == pytest.approx(0.5)


def test_what_is_held_moves_with_the_tool_between_datagrams(poses):
    inside = BodyState(np.array([0.0, 0.0, 0.02]), UPRIGHT)
    send(poses, poses_datagram({"box": inside, "lid": inside}, ["box"]))
    overhead = np.array([0.0, 1.0, 0.0, 0.0])  # the palm looks down
    poses.update(2.0, BodyState(np.array([0.1, 0.0, 0.3]), overhead))
    assert poses.poses["box"].position == pytest.approx([0.1, 0.0, 0.28])
    assert poses.poses["lid"].position == pytest.approx([0.0, 0.0, 0.02])
    poses.update(2.1, BodyState(np.array([0.1, 0.0, 0.4]), overhead, np.array([0.0, 0.0, 1.0]), np.array([0, 5.0, 0])))
    assert poses.poses["box"].position == pytest.approx([0.1, 0.0, 0.38])
    assert poses.poses["box"].velocity == pytest.approx([-0.1, 0.0, 1.0])  # turning about y, 2 cm below the tool
    assert poses.age_s("box", 2.1) == pytest.approx(0.1)


def test_what_was_let_go_of_stays_where_it_is_seen(poses):
    send(poses, poses_datagram({"box": BodyState(np.array([0.0, 0.0, 0.02]), UPRIGHT)}, ["box"]))
    poses.update(2.0, BodyState(np.array([0.1, 0.0, 0.3]), UPRIGHT))
    send(poses, box_at(0.1))
    poses.update(2.1, BodyState(np.array([0.5, 0.0, 0.3]), UPRIGHT))
    assert poses.poses["box"].position == pytest.approx([0.1, 0.0, 0.03])


def test_an_object_that_was_never_seen_is_the_oldest(poses):
    send(poses, box_at(0.1))
    poses.update(2.0)
    assert poses.oldest(2.1) == ("lid", np.inf)


def test_the_velocity_is_a_smoothed_difference(poses):
    for time_s, x in ((0.0, 0.0), (0.1, 0.01)):
        send(poses, box_at(x))
        poses.update(time_s)
    assert poses.poses["box"].velocity == pytest.approx([0.1 * (1 - np.exp(-1.0)), 0, 0])


@pytest.mark.parametrize(
    "data",
    [
        b"\xff",
        b"[]",
        b'{"objects": 3}',
        b'{"objects": {"box": {"position": [0, 0], "quaternion": [1, 0, 0, 0]}}}',
        b'{"objects": {"box": {"position": [0, 0, NaN], "quaternion": [1, 0, 0, 0]}}}',
        b'{"objects": {"box": {"position": [0, 0, 0], "quaternion": [0, 0, 0, 0]}}}',
        json.dumps({"objects": {"box": None}}).encode(),
        b'{"objects": {"box": {"position": [0, 0, 0], "quaternion": [1, 0, 0, 0], "in": "camera"}}}',
        b'{"objects": {"box": {"position": [0, 0, 1%s], "quaternion": [1, 0, 0, 0]}}}' % (b"0" * 400),
    ],
)
def test_a_malformed_datagram_is_ignored(poses, data):
    assert parse_poses(data) is None
    send(poses, data)
    poses.update(1.0)
    assert poses.poses == {}


def test_a_port_in_use_is_refused_by_its_name(poses):
    with pytest.raises(InputError, match=r"franka.poses_port.*expected a free port"):
        ObjectPoses(("box",), "127.0.0.1", poses.port)


def test_a_flood_of_large_datagrams_is_not_read_through(poses, monkeypatch):
    """A hundred of 60 kB held the arm's stream up for a second."""
    read, place = [], {"position": [0, 0, 0], "quaternion": [1, 0, 0, 0]}
    large = json.dumps({"objects": {f"thing {k}": place for k in range(700)}}).encode()
    monkeypatch.setattr("coral.contact.franka.object_poses.parse_poses", lambda data: read.append(data))
    send(poses, large)
    for k in range(60):
        send(poses, box_at(0.01 * k))
    poses.update(1.0)
    assert len(read) == PARSED
    assert read[-1] == box_at(0.59)
    send(poses, large)
    poses.update(2.0)
    assert len(read) == PARSED
