import math

import numpy as np
import pytest

from coral.advisor.question import Rejection
from coral.advisor.registry import make_advisor
from coral.errors import InputError
from coral.reef.mission.clairvoyant import NAME, Clairvoyant, clairvoyant
from coral.reef.world.world import load_world

POSE = {"x": 10.0, "y": 10.0, "theta": math.pi / 2}


def facts(*dots, options=()):
    """Facts of a robot that looks north."""
    return {"arrival": {"pose": POSE}, "centroids": list(dots), "options": list(options)}


def dot(index, forward, left, visited=False):
    return {"index": index, "forward_m": forward, "left_m": left, "visited": visited}


def test_it_takes_the_dot_of_the_first_cluster_or_a_step_towards_it():
    one = Clairvoyant(np.array([(10.0, 14.0), (2.0, 2.0)]))
    assert one.centroid(facts(dot(3, 4.2, 0.3), dot(5, -9.0, 7.0)), ()).selected_centroid_index == 3
    unseen = one.centroid(facts(dot(5, -9.0, 7.0)), ())
    assert (unseen.waypoint.forward_m, unseen.waypoint.left_m) == (4, 0)
    assert (unseen.expect.forward_m, unseen.expect.sure) == (4.0, 1.0)
    step = one.waypoint(facts(), ())
    assert (step.forward_m, step.left_m, step.dot) == (4, 0, None)
    shorter = one.waypoint(facts(), [Rejection(code="blocked", reason="no")])
    assert (shorter.forward_m, shorter.left_m) == (3, 0)


def test_what_the_robot_has_seen_from_near_is_done():
    one = Clairvoyant(np.array([(10.0, 14.0)]))
    assert one.waypoint(facts(dot(3, 4.0, 0.0, visited=True)), ()).expect is None
    ended = one.centroid(facts(dot(3, 4.0, 0.0, visited=True)), ())
    assert ended.end_survey
    assert one.centroid(facts(dot(8, 1.0, 1.0)), ()).selected_centroid_index == 8  # noise, but nothing else is left


def test_it_is_no_name_of_an_advisor():
    made = clairvoyant(load_world("l1"))
    assert made.name == NAME
    with pytest.raises(InputError):
        make_advisor(NAME, rules={}, rng=np.random.default_rng(0))
