import pytest

from coral.reef.map.recognisable import unrecognisable
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start, load_world, shipped_worlds


def world(count, spacing_m, *obstacles):
    oysters = tuple(
        Oyster(x=4 + spacing_m * (k % 3), y=3 + spacing_m * (k // 3), z=0.05, radii=(0.2, 0.2, 0.06), rpy=(0, 0, 1))
        for k in range(count)
    )
    start = Start(x=1, y=1, theta=0)
    return ReefWorld(
        name="w", size_m=(8, 6), start=start, clusters=(Cluster(name="bed", oysters=oysters),), obstacles=obstacles
    )


@pytest.mark.parametrize(("count", "spacing_m", "bad"), [(6, 0.35, False), (1, 0.35, True), (6, 1.0, True)])
def test_a_cluster_must_be_large_and_dense(count, spacing_m, bad):
    notes = unrecognisable(world(count, spacing_m))
    assert [note.partition(":")[0] for note in notes] == ["clusters[0] 'bed'"] * bad


@pytest.mark.parametrize(("half_m", "bad"), [(0.2, True), (0.7, False)])
def test_an_obstacle_lower_than_the_robot_swims_is_told(half_m, bad):
    box = Obstacle(shape="box", x=6, y=5, z=half_m, size=(0.3, 0.3, half_m))
    assert [note[:12] for note in unrecognisable(world(6, 0.35, box))] == ["obstacles[0]"] * bad


def test_nothing_in_a_shipped_reef_is_hard_to_recognise():
    assert [unrecognisable(load_world(name)) for name in shipped_worlds()] == [[]] * 10
