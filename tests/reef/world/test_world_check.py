"""Faults of a world that its types cannot express, each named with the field that is wrong."""

import pytest

from coral.errors import InputError
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start
from coral.reef.world.world_check import MAX_OBJECTS, check_world


def oyster(x=7.0, y=5.0, z=0.05):
    return Oyster(x=x, y=y, z=z, radii=(0.1, 0.08, 0.05))


def box(x=4.0, y=2.0, z=0.6, size=(0.3, 0.2, 0.6), yaw=0.3):
    return Obstacle(shape="box", x=x, y=y, z=z, size=size, yaw=yaw)


def pool(**changes):
    """A valid world of 10 x 10 m with two clusters and a box, but for the changes."""
    parts = {
        "name": "pool",
        "size_m": (10.0, 10.0),
        "start": Start(x=2.0, y=5.0),
        "clusters": (Cluster(name="a", oysters=(oyster(),)), Cluster(name="b", oysters=(oyster(y=8.0),))),
        "obstacles": (box(),),
    }
    return ReefWorld(**{**parts, **changes})


def fault(**changes):
    with pytest.raises(InputError) as caught:
        check_world(pool(**changes), "w.yaml")
    assert caught.value.where == "w.yaml"
    return caught.value


def one(*oysters, name="a"):
    return (Cluster(name=name, oysters=oysters),)


def test_a_valid_world_passes():
    check_world(pool(), "w.yaml")


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"size_m": (150.0, 10.0)}, "size_m[0]", "between 2 and 100 m"),
        ({"size_m": (10.0, 1.0)}, "size_m[1]", "between 2 and 100 m"),
        ({"start": Start(x=2.0, y=10.1)}, "start.y", "0 to 10 m"),
        ({"clusters": one(oyster(), oyster(x=10.5))}, "clusters[0].oysters[1].x", "0 to 10 m"),
        ({"clusters": one(oyster(z=9.0))}, "clusters[0].oysters[0].z", "on the seabed"),
        ({"clusters": one(oyster(z=-0.2))}, "clusters[0].oysters[0].z", "on the seabed"),
        ({"clusters": one(oyster()) * 2}, "clusters[1].name", "a different name"),
        ({"obstacles": (box(y=-0.5),)}, "obstacles[0].y", "0 to 10 m"),
        ({"obstacles": (box(z=-4.0),)}, "obstacles[0].z", "above 0 m"),
    ],
)
def test_what_lies_out_of_place_is_named(changes, field, words):
    error = fault(**changes)
    assert error.field == field
    assert words in error.expected


def test_too_many_objects_are_refused():
    world = pool()
    many = world.model_copy(update={"obstacles": world.obstacles * (MAX_OBJECTS + 1)})
    with pytest.raises(InputError, match="at most 20000"):
        check_world(many, "w.yaml")


def test_a_start_in_or_beside_an_obstacle_is_refused():
    error = fault(start=Start(x=4.0, y=2.1))
    assert error.field == "start"
    assert "inside obstacles[0]" in error.found
    assert "m from obstacles[0]" in fault(start=Start(x=4.0, y=2.45)).found


def wall(gap_m):
    """A wall at x = 5 over the whole height of the pool, with one gap at y = 5."""
    half = (5.0 - gap_m / 2) / 2
    return tuple(box(x=5.0, y=y, size=(0.1, half, 0.6), yaw=0.0) for y in (half, 10.0 - half))


def test_a_gap_must_be_wider_than_the_hull():
    error = fault(obstacles=wall(0.6))
    assert error.field == "clusters[0]"
    assert "'a'" in error.found
    check_world(pool(obstacles=wall(0.9)), "w.yaml")
