"""Materials follow from what a solid is."""

import numpy as np

from coral.reef.paint.materials import Materials
from coral.reef.paint.solid_kernels import BLOCK, BUOY, CARD, PILE, ROCK, SHELL
from coral.reef.world.scene import Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

OYSTERS = tuple(Oyster(x=1.0 + k, y=1.0, z=0.03, radii=(0.1, 0.07, 0.05)) for k in range(20))
SHAPES = (
    ("sphere", (0.2, 0.2, 0.2), BUOY),
    ("ellipsoid", (0.4, 0.3, 0.2), ROCK),
    ("cylinder", (0.2, 0.2, 1.0), PILE),
    ("box", (0.2, 0.2, 0.2), BLOCK),
)
WORLD = ReefWorld(
    name="w",
    size_m=(30, 30),
    start=Start(x=25, y=25),
    clusters=(Cluster(name="c", oysters=OYSTERS),),
    obstacles=tuple(Obstacle(shape=shape, x=5 + k, y=5, z=1, size=size) for k, (shape, size, _) in enumerate(SHAPES)),
)


def test_oysters_are_shells_and_every_obstacle_has_its_own_material():
    chosen = Materials.of(Scene.from_world(WORLD), 3).kind
    assert chosen.tolist() == [SHELL] * 20 + [material for *_, material in SHAPES]


def test_no_two_oysters_are_alike():
    made = Materials.of(Scene.from_world(WORLD), 3)
    assert len(np.unique(made.paint[:20], axis=0)) == 20
    assert made.paint.min() > 0.0
    assert made.paint.max() < 1.0


def test_a_thing_has_the_look_of_its_kind_and_the_others_stay_as_they_were():
    net = {"name": "net", "kind": "tyre", "x": 20.0, "y": 20.0}
    plain = Materials.of(Scene.from_world(WORLD), 3)
    mixed = Materials.of(Scene.from_world(ReefWorld.model_validate({**WORLD.model_dump(), "things": [net]})), 3)
    assert mixed.kind[:20].tolist() == plain.kind[:20].tolist()
    assert set(mixed.kind[20:-4].tolist()) == {CARD}
    assert mixed.paint[20:-4].max() < 0.02
