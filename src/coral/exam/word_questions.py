"""Single questions of missions in words; their key says what every dot is in truth, and which are right next ones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from coral.advisor.prompt import render
from coral.advisor.rules import RuleAdvisor
from coral.exam.item import ExamItem
from coral.exam.reef_moments import LOST_S, choose_goal, drive, give_up, seconds_of
from coral.reef.decide.mission_planner import MissionPlanner
from coral.reef.decide.outlook import Outlook
from coral.reef.decide.wordless import Wordless
from coral.reef.map.belief import Belief
from coral.reef.map.costfield import CostFieldCfg
from coral.reef.map.mapping import MapCfg, OccupancyMap
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.word_judge import instructed
from coral.reef.mission.word_oracle import next_things
from coral.reef.pictures.questions import question_pictures
from coral.reef.simulation.simulator import make_stills
from coral.reef.vehicle.camera import Camera
from coral.reef.world.generated import find_world
from coral.reef.world.geometry import Pose, to_world
from coral.reef.world.kinds import find_kind
from coral.reef.world.scene import Scene
from coral.reef.world.word_missions import FAMILIES, PREFIX, TEST_FROM
from coral.reef.world.world import ReefWorld

SAME_M = 1.3
"""A dot within this of a thing's middle stands for it."""
LEAST_DOTS = 2
GOALS = 12


@dataclass(frozen=True)
class _Moment:
    outlook: Outlook
    t: float
    key: dict[str, Any]
    """kinds: kind of the thing that each dot with a picture stands for. right: labels of the dots that an oracle would
    go to next. wanted, unwanted: those that the mission is still about, and those that it is not about."""


def word_items(half: str, seed: int, each: int = 2) -> list[ExamItem]:
    """Make questions of missions in words.

    Args:
        half: "development" or "test".
        seed: Of the first mission of each family in that half, and of the moments.
        each: Number of missions of each family.
    """
    first = seed + (TEST_FROM if half == "test" else 0)
    found = [
        item
        for family in FAMILIES
        for number in range(first, first + each)
        if (item := word_item(find_world(f"{PREFIX}{family}:{number}"), _rng(seed, number)))
    ]
    return [replace(item, id=f"{item.kind}-{number:03d}") for number, item in enumerate(found)]


def _rng(seed: int, number: int) -> np.random.Generator:
    return np.random.default_rng([seed, 41, number])


def word_item(world: ReefWorld, rng: np.random.Generator) -> ExamItem | None:
    """Make one question of a mission, at a moment where pictures decide; None if there is none.

    The water is clear: in a bay the robot sees one or two things at a time, and none of several has to be chosen.
    """
    cfg = instructed(MissionCfg(), world.mission)
    belief = Belief(OccupancyMap(world.size_m, cfg.simulator.camera, MapCfg()), replace(cfg.belief, chain_period=1))
    planner = MissionPlanner(belief, CostFieldCfg(), render, lambda outlook: (), cfg.planner)
    met = list(_moments(world, planner, cfg))
    if not met:
        return None
    moment = met[int(rng.integers(len(met)))]
    planner.draw, planner.route.t = question_pictures, moment.t
    question = planner.ask(moment.outlook).question
    assert question is not None
    return ExamItem(
        id="",
        kind=question.kind,
        group=world.name,
        prompt=question.prompt,
        prompt_version=question.prompt_version,
        facts=question.facts,
        pictures=question.pictures,
        asked_at_s=round(moment.t, 1),
        key=moment.key,
    )


def _moments(world: ReefWorld, planner: MissionPlanner, cfg: MissionCfg) -> Iterator[_Moment]:
    """Yield the moments at which some dots are right next ones and others are not, on a tour past everything."""
    scene, belief = Scene.from_world(world), planner.belief
    camera, stills = Camera(scene, cfg.simulator.camera), make_stills(scene, cfg.simulator, world.seed)
    guide = RuleAdvisor({"reef-mission": Wordless()})
    t, seen = 0.0, list[str]()

    def look(pose: Pose) -> None:
        belief.update(stills.of(camera.render(pose, t=t), pose, t), pose)

    look(Pose(world.start.x, world.start.y, world.start.theta))
    belief.goal = to_world(belief.pose, 2.0, 0.0)
    for _ in range(GOALS):
        before = t
        for pose in drive(belief):
            t += seconds_of(belief.pose, pose)
            look(pose)
        if t == before:
            t += LOST_S
            give_up(belief)
        planner.route.t = t
        asked = planner.ask(planner.outlook())
        moment = _moment(world, asked.outlook, t, seen)
        if moment is not None:
            yield moment
        goal = choose_goal(planner, asked, guide)
        if goal is None:
            return
        belief.goal, belief.goal_index = (goal.x, goal.y), goal.index


def _moment(world: ReefWorld, outlook: Outlook, t: float, seen: list[str]) -> _Moment | None:
    """Return a moment if pictures decide at it; `seen`: names of the things that were visited, in order."""
    belief = outlook.belief
    things: dict[int, Any] = {}
    settled = [thing for thing in world.things if not find_kind(thing.kind).circles]  # no dot is of an animal
    for track in belief.tracks:
        near = min(settled, key=lambda thing: math.dist((thing.x, thing.y), (track.x, track.y)))
        if math.dist((near.x, near.y), (track.x, track.y)) <= SAME_M:
            things[track.index] = near
            if outlook.done(track) and near.name not in seen:
                seen.append(near.name)
    shown = {track.index for track, _, _ in belief.best_views.of(belief.tracks)}
    open_ = {track.index for track in outlook.unvisited()} & shown & set(things)
    right, wanted = (
        {index for index in open_ if things[index].name in next_things(world, seen, in_order=in_order)}
        for in_order in (True, False)
    )
    if len(open_) < LEAST_DOTS or not right or wanted == open_:
        return None
    kinds = {str(index): thing.kind for index, thing in things.items() if index in shown}
    key = {"kinds": kinds, "right": sorted(right), "wanted": sorted(wanted), "unwanted": sorted(open_ - wanted)}
    return _Moment(outlook, t, key)
