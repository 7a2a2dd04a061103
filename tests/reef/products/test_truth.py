"""The true area of a simulated reef."""

import math

import numpy as np
import pytest

from coral.reef.products.truth import true_oysters
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start


def world(*oysters, obstacles=()):
    return ReefWorld(
        name="x", size_m=(6.0, 6.0), start=Start(x=1.0, y=1.0), clusters=(Cluster(name="a", oysters=oysters),),
        obstacles=obstacles,
    )  # fmt: skip


def shell(x, y=3.0):
    return Oyster(x=x, y=y, z=0.05, radii=(0.3, 0.2, 0.1))


def area_m2(reef):
    return true_oysters(reef, np.ones((300, 300), np.bool_), 0.02).whole_m2


def test_one_shell_has_the_area_of_its_ellipse():
    assert area_m2(world(shell(3.0))) == pytest.approx(math.pi * 0.3 * 0.2, rel=0.02)


def test_shells_that_overlap_count_once_and_gaps_do_not_count():
    one = area_m2(world(shell(3.0)))
    assert area_m2(world(shell(3.0), shell(3.0))) == pytest.approx(one)
    assert area_m2(world(shell(2.0), shell(4.0))) == pytest.approx(2 * one, rel=0.01)


def test_what_lies_under_an_obstacle_does_not_count():
    rock = Obstacle(shape="box", x=3.3, y=3.0, z=0.3, size=(0.3, 0.5, 0.3))
    one = area_m2(world(shell(3.0)))
    assert area_m2(world(shell(3.0), obstacles=(rock,))) == pytest.approx(one / 2, rel=0.05)


def test_number_and_length_of_the_oysters_that_no_obstacle_covers():
    shells = [Oyster(x=x, y=2.0, z=0.03, radii=(half, 0.05, 0.04), rpy=(0.0, 0.0, 0.0)) for x, half in SHELLS]
    reef = world(*shells, obstacles=(Obstacle(shape="cylinder", x=5.0, y=2.0, z=0.5, size=(0.2, 0.2, 0.5)),))
    found = true_oysters(reef, np.ones((300, 300), np.bool_), 0.02)
    assert (found.oysters, found.length_m) == (2, pytest.approx(0.2))
    assert found.m2 == found.whole_m2 == pytest.approx(math.pi * 0.05 * (0.08 + 0.12), rel=0.05)


def test_what_the_survey_did_not_see_is_told_apart():
    reef = world(shell(2.0), shell(4.0))
    west = np.zeros((300, 300), np.bool_)
    west[:, :150] = True
    found = true_oysters(reef, west, 0.02)
    assert (found.oysters, found.m2) == (1, pytest.approx(found.whole_m2 / 2, rel=0.01))
    assert true_oysters(reef, np.zeros((300, 300), np.bool_), 0.02).m2 == 0.0


SHELLS = ((1.0, 0.08), (3.0, 0.12), (5.0, 0.05))


def test_a_net_is_no_oyster():
    reef = world(shell(2.0))
    net = {"name": "net", "kind": "ghost-net", "x": 4.0, "y": 3.0}
    assert area_m2(ReefWorld.model_validate(reef.model_dump() | {"things": [net]})) == area_m2(reef)
