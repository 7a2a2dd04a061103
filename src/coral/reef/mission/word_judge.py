"""The judge of a mission in words, who knows the truth; and what such a mission changes in a configuration."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from coral.config import merge, nested
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.vehicle.camera import CameraCfg, ray_lengths
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Frame, Pose
from coral.reef.world.instruction import Deeds, Fulfilment, KeptOff, MissionText, checked_words
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld

INSPECT_M = 1.6
"""A thing is inspected when part of it is in the picture from no farther: near enough to be meant."""
LEAST_PX = 30
"""Pixels of it that must be so near in one picture."""


class WordJudge:
    """Collects the deeds of a mission. No decision reads it."""

    def __init__(self, world: ReefWorld, scene: Scene, text: MissionText, camera: CameraCfg) -> None:
        self.text, self.done = text, False
        self.answer: str | None = None
        self._stretch = ray_lengths(camera).astype(np.float32)
        """Range by depth of each pixel."""
        self._things, self._scene = world.things, scene
        owners = np.full(len(scene), -1, np.int32) if scene.thing is None else scene.thing
        self._thing = np.append(owners, np.int32(-1))  # the last is for pixels of nothing
        watched = {name for clause in text.conditions if isinstance(clause, KeptOff) for name in clause.of}
        self._outlines = {
            k: scene.outlines(np.flatnonzero(owners == k))
            for k, thing in enumerate(world.things)
            if watched & {thing.name, thing.kind}
        }
        self._start = world.start
        self._inspected: dict[str, float] = {}
        self._nearest: dict[str, float] = {}
        self._seen: dict[str, set[tuple[float, float]]] = {}
        self._end_s, self._at = 0.0, (world.start.x, world.start.y)

    def hear(self, answer: str) -> None:
        """Take the advisor's word that the mission is done."""
        self.done, self.answer = True, answer

    def note(self, t: float, pose: Pose, taken: tuple[Pose, Frame] | None) -> None:
        """Watch one tick: where the vehicle is, and what the last picture shows in truth, from where."""
        x, y, _ = pose
        self._end_s, self._at = t, (x, y)
        for k, outline in self._outlines.items():
            name = self._things[k].name
            self._nearest[name] = min(self._nearest.get(name, math.inf), clearance(outline, x, y))
        if taken is not None:
            self._look(t, *taken)

    def _look(self, t: float, pose: Pose, frame: Frame) -> None:
        owner = self._thing[frame.instances]
        count = len(self._things) + 1
        seen = np.bincount(owner.ravel() + 1, minlength=count)[1:]
        near = np.bincount(owner[frame.depth * self._stretch <= INSPECT_M] + 1, minlength=count)[1:]
        for k in np.flatnonzero(seen >= LEAST_PX).tolist():
            thing = self._things[k]
            if near[k] >= LEAST_PX:
                self._inspected.setdefault(thing.name, t)
            dx, dy = pose.x - thing.x, pose.y - thing.y
            view = round(math.hypot(dx, dy), 1), round(math.atan2(dy, dx), 1)
            self._seen.setdefault(thing.name, set()).add(view)

    def deeds(self) -> Deeds:
        """Return what has been done so far."""
        x, y = self._at
        return Deeds(
            kinds={thing.name: thing.kind for thing in self._things},
            inspected_s=dict(self._inspected),
            nearest_m=dict(self._nearest),
            seen_from={name: tuple(views) for name, views in self._seen.items()},
            end_s=self._end_s,
            from_start_m=math.dist((x, y), (self._start.x, self._start.y)),
            from_m={thing.name: math.dist((x, y), (thing.x, thing.y)) for thing in self._things},
            done=self.done,
            answer=self.answer,
        )

    def verdict(self) -> list[Fulfilment]:
        """Judge the conditions."""
        return self.text.judge(self.deeds())


def told_verdict(text: str, answer: str | None, judge: WordJudge | None, contacts: int) -> dict[str, Any]:
    """Return what the event `judged` tells of a mission in words, `text` at the end; empty for another mission.

    Only the judge's own instruction has known conditions; of other words nobody judges. `answer` is None if the advisor
    did not say that the mission was done. With contacts no mission is fulfilled.
    """
    if not text:
        return {}
    known = judge is not None and judge.text.instruction.strip() == text.strip()
    verdict = judge.verdict() if judge is not None and known else []
    return {
        "instruction": {
            "text": text,
            "met": all(one.met for one in verdict) and not contacts if known else None,
            "answer": answer,
            "conditions": [one.model_dump() for one in verdict],
        }
    }


def with_instruction(cfg: MissionCfg, words: str, text: MissionText | None = None) -> MissionCfg:
    """Return the configuration of a mission in words of one's own.

    Raises:
        InputError: The instruction is empty or too long.
    """
    told = {"planner": {"instruction": {"text": checked_words(words)}}}
    return instructed(merge(cfg, told, "--cfg"), text)


def instructed(cfg: MissionCfg, text: MissionText | None) -> MissionCfg:
    """Return the configuration of a mission in words: its instruction, its time, what counts as inspected, stills."""
    told = cfg.planner.instruction
    if text is None and not told.text:
        return cfg
    limit_s = cfg.time_limit_s if text is None else min(cfg.time_limit_s, text.time_s)
    pixel_m = INSPECT_M / cfg.simulator.camera.intrinsics[0]
    changed = {
        "time_limit_s": limit_s,
        "stop_when_covered": False,
        "planner.instruction.text": told.text or (text.instruction if text else ""),
        "planner.instruction.time_s": limit_s,
        "simulator.stills": True,
        "simulator.imaging.pixel_m": pixel_m,
        "belief.inspect.pixel_m": pixel_m,
    }
    return merge(cfg, nested(changed, "--cfg"), "--cfg")
