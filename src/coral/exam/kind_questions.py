"""Questions that show things of every kind, shuffled, to be named: whether a reader can tell them apart in a water."""

from __future__ import annotations

import math

import numpy as np

from coral.advisor.prompt import render
from coral.advisor.question import Picture
from coral.errors import InputError
from coral.exam.item import ExamItem
from coral.reef.map.best_views import NEAR_M, BestViews
from coral.reef.map.chain import Track
from coral.reef.pictures.mapview import png
from coral.reef.pictures.things import crops_picture
from coral.reef.simulation.simulator import SimulatorCfg, make_stills
from coral.reef.vehicle.camera import Camera, CameraCfg
from coral.reef.world.geometry import Pose
from coral.reef.world.kinds import catalogue, grow
from coral.reef.world.scene import Scene
from coral.reef.world.water_types import find_water
from coral.reef.world.world_model import ReefWorld

APART_M, COLUMNS, EDGE_M = 9.0, 5, 7.0
"""Things on a sheet lie so far apart, in rows of so many, so far from the edge."""
FARTHEST_M = 6.0


def kind_items(water: str, distance_m: float, seed: int, each: int) -> list[ExamItem]:
    """Make questions that together show every kind `each` times; how often one question does is chance.

    Args:
        water: Jerlov type or preset.
        distance_m: From which every thing is seen.
        seed: Of order, places and sides.
        each: Number of questions.

    Raises:
        InputError: There is no such water, or the distance is out of range.
    """
    find_water(water, "--kinds")
    if not NEAR_M <= distance_m <= FARTHEST_M:
        raise InputError("--distance-m", "", distance_m, f"{NEAR_M:g} to {FARTHEST_M:g} m")
    rng = np.random.default_rng([seed, 43])
    names = list(catalogue().kinds)
    drawn = rng.permutation(names * each).reshape(each, len(names)).tolist()
    return [_item(f"reef-mission-{k:03d}", kinds, water, distance_m, rng) for k, kinds in enumerate(drawn)]


def _item(name: str, kinds: list[str], water: str, distance_m: float, rng: np.random.Generator) -> ExamItem:
    places = [(EDGE_M + APART_M * (k % COLUMNS), EDGE_M + APART_M * (k // COLUMNS)) for k in range(len(kinds))]
    yaws = rng.uniform(-math.pi, math.pi, len(kinds)).round(2).tolist()
    rows = math.ceil(len(kinds) / COLUMNS)
    world = ReefWorld.model_validate(
        {
            "name": name,
            "size_m": [2.0 * EDGE_M + APART_M * (n - 1) for n in (COLUMNS, rows)],
            "start": {"x": 1.0, "y": 1.0},
            "clusters": [],
            "things": [
                {"name": str(k), "kind": kind, "x": x, "y": y, "yaw": yaw}
                for k, (kind, (x, y), yaw) in enumerate(zip(kinds, places, yaws, strict=True))
            ],
        }
    )
    scene, cfg = Scene.from_world(world), CameraCfg()
    camera, stills = Camera(scene, cfg), make_stills(scene, SimulatorCfg(water=water), 0)
    found = []
    for k, thing in enumerate(world.things):
        solids = grow(thing.kind, thing.x, thing.y, thing.yaw, 0.0)
        x, y = (float(np.mean([solid[axis] for solid in solids])) for axis in ("x", "y"))
        angle = float(rng.uniform(-math.pi, math.pi))
        pose = Pose(
            x + distance_m * math.cos(angle),
            y + distance_m * math.sin(angle),
            math.remainder(angle + math.pi, math.tau),
        )
        views, track = BestViews(cfg), Track(index=k, x=x, y=y, area_px=0, length_m=0.0)
        views.update(stills.of(camera.render(pose), pose, 0.0), pose, [track], 0)
        found += [(k, view, 0.0) for _, view, _ in views.of([track])]
    sheet = crops_picture(found)
    assert sheet is not None
    says = [kind.says for kind in catalogue().kinds.values()]
    prompt, version = render("sea-floor-kinds", kinds=says, distance_m=distance_m)
    return ExamItem(
        id=name,
        kind="reef-mission",
        group=f"kinds-{water}-{distance_m:g}",
        prompt=prompt,
        prompt_version=version,
        facts={},
        pictures=(Picture(name="things", png=png(sheet), caption="numbered things"),),
        key={"kinds": {str(k): kind for k, kind in enumerate(kinds)}},
    )
