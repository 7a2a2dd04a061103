"""Writes a contact episode into its run folder while it runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import IO, Any

import numpy as np

from coral.config import Positive
from coral.contact.perception.symmetry import PoseDifference
from coral.contact.scene.condition import hand_force
from coral.contact.scene.geometry import conjugate, rotate
from coral.contact.scene.observation import Array, BodyState, Contact, HandTarget, Observation, Truth
from coral.contact.worlds.evaluation_world import simulation_of
from coral.contact.worlds.robot_world import RobotWorld
from coral.file_writer import open_log
from coral.run_files import TaskFiles
from coral.runs import RunWriter

TRAJECTORY = {
    "step t": "number of the control step and simulated time (s)",
    "x y z qw qx qy qz": "measured pose of the tool in the world",
    "opening": "measured opening of the hand (m)",
    "cmd_x cmd_y cmd_z cmd_qw cmd_qx cmd_qy cmd_qz cmd_opening cmd_stiffness": "the command: pose, opening, "
    "stiffness (N/m)",
    "fx fy fz tx ty tz": "force (N) and torque (N m) on the hand",
    "stage": "index of the stage",
}
"""Columns of trajectory.csv, SI units: first these, then `OF_OBJECT` for each object, then `TRACKED` for each."""
OF_OBJECT = {
    "x y z qw qx qy qz": "its pose; as measured where nobody knows the truth",
    "hand_force": "the hand's net force on it (N); empty where contacts are not known",
    "touch_x touch_y touch_z": "mean point of that contact in the object's frame (m); empty without contact",
}
TRACKED = {
    "off_m off_rad lost": "error of its tracked pose, modulo symmetry, and whether it is lost; empty without tracking"
}


@dataclass(frozen=True, kw_only=True)
class EpisodeRecordCfg:
    """Optional contents of a run folder."""

    states: bool = True
    """Keep the simulator's joint positions at intervals; the report's pictures and the video need them."""
    state_period_s: Positive = 0.08
    """The interval."""
    report: bool = True
    """Write keyframes.png and report.html at the end."""
    video: bool = False
    """Write episode.mp4 at the end."""


def columns_told() -> dict[str, str]:
    """Return what the columns are, of any object: `OBJECT_x OBJECT_y ...`."""
    each = {" ".join(f"OBJECT_{part}" for part in parts.split()): what for parts, what in (OF_OBJECT | TRACKED).items()}
    return TRAJECTORY | each


def columns(objects: Sequence[str]) -> tuple[str, ...]:
    """Return the columns of trajectory.csv: SI units, world frame; one row per control step."""
    return (
        *" ".join(TRAJECTORY).split(),
        *(f"{name}_{part}" for kinds in (OF_OBJECT, TRACKED) for name in objects for part in " ".join(kinds).split()),
    )


class EpisodeRecorder:
    """Appends the rows of an episode, the states of its simulator and its contacts."""

    def __init__(self, writer: RunWriter, cfg: EpisodeRecordCfg, objects: Sequence[str]) -> None:
        self._writer, self._cfg, self._objects = writer, cfg, tuple(objects)
        self._states: IO[str] | None = None
        self._due = 0.0
        self._contacts = ContactLog()

    def record(
        self,
        step: int,
        world: RobotWorld,
        now: Observation,
        truth: Truth,
        command: HandTarget,
        stage: int = 0,
        seen: Mapping[str, PoseDifference] | None = None,
    ) -> None:
        """Record one control step: its row, the world's state, and contacts that have begun or ended."""
        self.state(step, now.time_s, world)
        self._emit(step, self._contacts.update(truth))
        values: list[float | str] = [step, now.time_s, *_pose(now.tool), now.opening_m]
        values += [*command.position, *command.quaternion, command.opening_m, command.stiffness, *now.wrench, stage]
        for name in self._objects:
            force = (hand_force(truth, name) or 0.0) if truth.contacts_known else ""
            values += [*_pose(truth.objects[name]), force, *_touch_point(truth, name)]
        for name in self._objects:
            one = None if seen is None else seen[name]
            values += ["", "", ""] if one is None else [one.off_m, one.off_rad, int(one.lost)]
        self._writer.row(*(value if isinstance(value, str) else float(value) for value in values))

    def state(self, step: int, t: float, world: RobotWorld, last: bool = False) -> None:
        """Record the joint positions of a simulated world, at the configured rate."""
        simulation = simulation_of(world)
        if not self._cfg.states or simulation is None or (t < self._due - 1e-9 and not last):
            return
        self._due = t + self._cfg.state_period_s
        data = simulation.data
        if self._states is None:
            self._states = open_log(self._writer.folder / TaskFiles.STATES)
            self._states.write(",".join(["step", "t", *(f"q{k}" for k in range(len(data.qpos)))]) + "\n")
        self._states.write(",".join([str(step), f"{t:.6g}", *(f"{value:.6g}" for value in data.qpos)]) + "\n")

    def close(self, step: int) -> None:
        """Close the remaining contacts and the file of states."""
        self._emit(step, self._contacts.finish())
        if self._states is not None:
            self._states.close()

    def _emit(self, step: int, told: list[tuple[float, str, dict[str, Any]]]) -> None:
        for t, event, fields in told:
            self._writer.event(step, t, event, **fields)


@dataclass
class _Touch:
    begun_s: float
    seen_s: float
    peak_n: float = 0.0
    total: float = 0.0
    count: int = 0


@dataclass
class ContactLog:
    """Merges contacts into intervals of time."""

    gap_s: float = 0.1
    """A contact that returns within this time counts as uninterrupted: contacts flicker while a rigid body rocks."""
    _on: dict[tuple[str, str], _Touch] = field(default_factory=dict)

    def update(self, truth: Truth) -> list[tuple[float, str, dict[str, Any]]]:
        """Return time, name and fields of the contacts that began or ended; the former with force and point."""
        said: list[tuple[float, str, dict[str, Any]]] = []
        for contact in truth.contacts:
            pair = contact.first, contact.second
            newtons = float(np.linalg.norm(contact.force))
            if pair not in self._on:
                self._on[pair] = _Touch(truth.time_s, truth.time_s)
                said.append((truth.time_s, "contact", _begin_fields(contact, newtons)))
            touch = self._on[pair]
            touch.seen_s, touch.peak_n = truth.time_s, max(touch.peak_n, newtons)
            touch.total, touch.count = touch.total + newtons, touch.count + 1
        for pair, touch in list(self._on.items()):
            if truth.time_s - touch.seen_s > self.gap_s:
                said.append((truth.time_s, "contact_end", _end_fields(pair, touch)))
                del self._on[pair]
        return said

    def finish(self) -> list[tuple[float, str, dict[str, Any]]]:
        """End the contacts that are still active."""
        said = [(touch.seen_s, "contact_end", _end_fields(pair, touch)) for pair, touch in self._on.items()]
        self._on.clear()
        return said


def _begin_fields(contact: Contact, newtons: float) -> dict[str, Any]:
    told = {"first": contact.first, "second": contact.second}
    return {**told, "force_n": round(newtons, 3), "point": numbers(contact.point, 4)}


def _end_fields(pair: tuple[str, str], touch: _Touch) -> dict[str, Any]:
    return {
        "first": pair[0],
        "second": pair[1],
        "begun_s": round(touch.begun_s, 4),
        "ended_s": round(touch.seen_s, 4),
        "peak_n": round(touch.peak_n, 3),
        "mean_n": round(touch.total / max(touch.count, 1), 3),
    }


def numbers(values: Array, digits: int) -> list[float]:
    """Convert to rounded plain numbers, as in events."""
    return [round(float(value), digits) for value in values]


def _touch_point(truth: Truth, name: str) -> list[float] | list[str]:
    """Return the hand's contact point on an object, in the object's frame: the mean of its contacts by force."""
    total, weight = np.zeros(3), 0.0
    for contact in truth.contacts:
        if name in (contact.first, contact.second) and {"hand", "left", "right"} & {contact.first, contact.second}:
            newtons = float(np.linalg.norm(contact.force)) + 1e-9
            total, weight = total + newtons * contact.point, weight + newtons
    if not weight:
        return ["", "", ""]
    body = truth.objects[name]
    return numbers(rotate(conjugate(body.quaternion), total / weight - body.position), 6)


def _pose(body: BodyState) -> list[float]:
    return [*map(float, body.position), *map(float, body.quaternion)]
