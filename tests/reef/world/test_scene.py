import numpy as np
import pytest

from coral.reef.world.geometry import Label
from coral.reef.world.scene import BOX, CYLINDER, ELLIPSE, ELLIPSOID, RECTANGLE, Scene, rotations
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Seabed, Start


def world(oysters=(((1.0, 2.0, 0.1), (0.1, 0.2, 0.05), (0.0, 0.0, 0.0)),), obstacles=()):
    clusters = tuple(
        Cluster(name=f"c{i}", oysters=(Oyster(x=p[0], y=p[1], z=p[2], radii=r, rpy=a),))
        for i, (p, r, a) in enumerate(oysters)
    )
    return ReefWorld(
        name="w",
        size_m=(20, 20),
        seabed=Seabed(z_m=-3.0),
        start=Start(x=1, y=1),
        clusters=clusters,
        obstacles=obstacles,
    )


def test_oysters_come_cluster_by_cluster_and_obstacles_last():
    a = Oyster(x=1, y=1, z=0, radii=(0.1, 0.1, 0.1))
    b = Oyster(x=2, y=1, z=0, radii=(0.1, 0.1, 0.1))
    rock = Obstacle(shape="box", x=5, y=6, z=0.5, size=(0.3, 0.4, 0.5), yaw=0.2)
    pile = Obstacle(shape="cylinder", x=7, y=6, z=0.5, size=(0.3, 0.3, 0.5))
    clusters = (Cluster(name="west", oysters=(a, b)), Cluster(name="east", oysters=(b,)))
    scene = Scene.from_world(
        ReefWorld(name="w", size_m=(20, 20), start=Start(x=1, y=1), clusters=clusters, obstacles=(rock, pile))
    )
    assert scene.kind.tolist() == [ELLIPSOID, ELLIPSOID, ELLIPSOID, BOX, CYLINDER]
    assert scene.label.tolist() == [Label.OYSTER] * 3 + [Label.OBSTACLE] * 2
    assert scene.cluster.tolist() == [0, 0, 1, -1, -1]
    assert scene.cluster_names == ("west", "east")
    assert scene.center[3].tolist() == [5, 6, 0.5]
    assert scene.half[3].tolist() == [0.3, 0.4, 0.5]
    assert len(scene) == 5


def test_seabed_height_is_the_worlds():
    assert Scene.from_world(world()).seabed_z == -3.0


def test_rotation_is_yaw_after_pitch_after_roll():
    quarter = np.pi / 2
    # Roll takes z to -y, pitch leaves y alone, yaw takes -y to x.
    turn = rotations([(quarter, quarter, quarter)])[0]
    np.testing.assert_allclose(turn @ [0, 0, 1], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(rotations([(0, 0.3, 0)])[0] @ [1, 0, 0], [np.cos(0.3), 0, -np.sin(0.3)], atol=1e-15)
    np.testing.assert_allclose(rotations([(0, 0, 0.3)])[0] @ [1, 0, 0], [np.cos(0.3), np.sin(0.3), 0], atol=1e-15)


def test_footprints_keep_the_order_of_the_obstacles():
    obstacles = (
        Obstacle(shape="sphere", x=3, y=4, z=0, size=(0.5, 0.5, 0.5), yaw=0.7),
        Obstacle(shape="box", x=5, y=6, z=0, size=(0.3, 0.4, 0.5), yaw=0.2),
        Obstacle(shape="cylinder", x=7, y=8, z=0, size=(0.2, 0.2, 0.9)),
        Obstacle(shape="ellipsoid", x=9, y=10, z=0, size=(0.6, 0.2, 0.9), yaw=-0.4),
    )
    outlines = Scene.from_world(world(obstacles=obstacles)).footprints()
    assert len(outlines.kind) == 4
    assert outlines.kind.tolist() == [ELLIPSE, RECTANGLE, ELLIPSE, ELLIPSE]
    assert outlines.center.tolist() == [[3, 4], [5, 6], [7, 8], [9, 10]]
    assert outlines.half.tolist() == [[0.5, 0.5], [0.3, 0.4], [0.2, 0.2], [0.6, 0.2]]
    np.testing.assert_allclose(outlines.yaw, [0.7, 0.2, 0.0, -0.4], atol=1e-15)


def test_a_world_without_obstacles_has_no_footprints():
    assert len(Scene.from_world(world()).footprints().kind) == 0


@pytest.mark.parametrize("seed", range(5))
def test_outline_of_a_tilted_oyster_is_its_shadow(seed):
    rng = np.random.default_rng(seed)
    radii, rpy = tuple(rng.uniform(0.02, 0.3, 3)), tuple(rng.uniform(-3, 3, 3))
    scene = Scene.from_world(world(oysters=(((1.0, 2.0, 0.1), radii, rpy),)))
    outline = scene.outlines(np.array([0]))
    ball = rng.standard_normal((20000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    shadow = ((ball * scene.half[0]) @ scene.rotation[0].T)[:, :2]
    c, s = np.cos(outline.yaw[0]), np.sin(outline.yaw[0])
    inside = np.hypot((shadow @ [c, s]) / outline.half[0, 0], (shadow @ [-s, c]) / outline.half[0, 1])
    assert inside.max() <= 1 + 1e-12
    assert inside.max() > 0.999
    # Touched all around, not at one point.
    bearing = np.arctan2(shadow @ [-s, c], shadow @ [c, s])[inside > 0.98]
    assert np.ptp(bearing) > 6.0


def test_parts_of_things_have_the_class_of_their_kind_and_know_their_thing():
    content = world().model_dump() | {"seabed": {"z_m": 0.0}}
    content["things"] = [
        {"name": "net", "kind": "ghost-net", "x": 5.0, "y": 5.0},
        {"name": "cable", "kind": "cable", "x": 9.0, "y": 5.0},
    ]
    scene = Scene.from_world(ReefWorld.model_validate(content))
    assert set(scene.label[scene.thing == 0]) == {Label.OYSTER}
    assert set(scene.cluster[scene.thing == 0]) == {-1}
    assert set(scene.label[scene.thing == 1]) == {Label.SEABED}
    assert scene.thing[0] == -1
    assert [scene.looks[0], scene.looks[-1]] == [None, "sheath"]


def test_an_animal_goes_round_its_place_and_the_rest_stays():
    things = [{"name": "pot", "kind": "crab-pot", "x": 5, "y": 5}, {"name": "crab", "kind": "crab", "x": 12, "y": 8}]
    beds = ReefWorld.model_validate(
        {"name": "w", "size_m": (20, 20), "start": {"x": 1, "y": 1}, "clusters": [], "things": things}
    )
    scene = Scene.from_world(beds)
    moves = scene.thing == 1
    assert not beds.solids
    assert (scene.label[moves] == Label.SEABED).all()
    later = scene.at(10.0)
    np.testing.assert_array_equal(later.center[~moves], scene.center[~moves])
    turned = later.center[moves, :2] - (12, 8)
    before = scene.center[moves, :2] - (12, 8)
    np.testing.assert_allclose(np.hypot(*turned.T), np.hypot(*before.T))
    angle = np.arctan2(before[:, 0] * turned[:, 1] - before[:, 1] * turned[:, 0], (before * turned).sum(axis=1))
    np.testing.assert_allclose(angle, 2.5, atol=1e-9)
    assert len(scene.resting) == (~moves).sum()


def test_a_scene_without_animals_is_the_same_at_any_time():
    scene = Scene.from_world(world())
    assert scene.at(7.0) is scene
    assert scene.resting is scene
