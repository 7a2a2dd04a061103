"""What the record of an attempt says about it: the evidence for a diagnosis, in numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from coral.contact.control.measured_contacts import HELD_M
from coral.contact.plan.stage_end import PartReading
from coral.contact.scene.geometry import conjugate, multiply, rotation_of, to_rotvec
from coral.contact.scene.observation import Array, BodyState, Observation, Transition
from coral.contact.thinker.end_evidence import END_S, EndEvidence, collect_end
from coral.contact.thinker.progress_monitor import PlanNote

FELT_N = 1.0
"""A force above this is a touch of something."""
SUNK_M, SUNK_M_N = 0.006, 0.0003
"""A hand that is deeper in an object than this, and this for each newton that it feels, is not where it is believed to
be, or the object is not. Tracked poses are off by millimetres, and contacts give way: pressing with 30 to 45 N the hand
was 6 to 11 mm inside boxes whose poses were right to a millimetre (measured, simulated hand)."""
MOSTLY = 0.8
"""Share from which something is reported as such."""
OVER_M = 0.005
"""A tool no further below an object's top than this is over the object, not beside it."""
CROSSED = 0.5
"""A hand that went over this share of an object's width passed over it."""
AROUND_M = 0.005
"""A tool this far outside the bounding box still counts as inside."""


@dataclass(frozen=True)
class Evidence:
    """The record of the last seconds, about one object."""

    name: str
    """The object."""
    seconds: float
    """Length of the record."""
    first_m: float
    """Distance of the tool from the object's bounding box at the beginning."""
    least_m: float
    """The smallest one."""
    last_m: float
    """The one at the end."""
    touched: float
    """Share of the plans at which the hand touched the object, as measured."""
    others: tuple[str, ...]
    """What else the hand touched at a quarter of the plans or more."""
    felt: float
    """Share of the plans at which the hand felt a force."""
    unexplained: float
    """Share of these at which it touched nothing, by the believed poses."""
    force_mean_n: float
    """Mean force on the hand."""
    force_peak_n: float
    """Its peak."""
    predicted_n: float
    """Magnitude of the mean force that the plans expected."""
    unpredicted_n: float
    """Magnitude of the mean difference between felt and expected force."""
    moved_m: float
    """Distance of the object from where it was at the beginning."""
    turned_deg: float
    """Its turn."""
    lag_m: float
    """Mean distance of the hand from its commands."""
    sunk: float
    """Share of the plans at which the hand was deeper inside the object, by the believed poses, than contacts give
    way."""
    at_edge: float
    """Share of the last targets at the edge of the workspace or of the arm's reach."""
    around: float
    """Share of the last steps at which the tool, midway between the fingertips, was inside the object's bounding box
    and the fingers were wider apart than its smallest extent."""
    over: float
    """Share of the steps at which the tool was over the object: above its top, and not beside it seen from above."""
    above_m: float
    """The tool's least height above the object's top at these steps; 0 without any."""
    passed_m: float
    """How far the tool went level over the object at these steps."""
    crossed: float
    """The same as a share of the object's smaller width, seen from above."""
    closing: float
    """Share of the steps at which the fingers were told to close on something: 3 mm below their opening."""
    largest_term: str
    """The term that held the cost up at the end; "" if unknown."""
    largest_share: float
    """Its share of the sum of all terms' magnitudes."""
    largest_value: float
    """Its value."""
    end: EndEvidence
    """What became of the end of the stage."""

    def sentences(self) -> list[str]:
        """Return the evidence in sentences, for prompts and events."""
        least_cm = 100 * self.least_m
        reach = f"In the last {self.seconds:.1f} s the hand came no nearer than {least_cm:.1f} cm to the {self.name}"
        if self.touched:
            reach = f"The hand touched the {self.name} for {100 * self.touched:.0f} % of the last {self.seconds:.1f} s"
        told = [
            f"{reach}; its distance went from {100 * self.first_m:.1f} to {100 * self.last_m:.1f} cm.",
            f"It felt {self.force_mean_n:.1f} N on average and {self.force_peak_n:.1f} N at most, and was "
            f"{1000 * self.lag_m:.0f} mm from its commands on average.",
            f"The {self.name} moved {1000 * self.moved_m:.0f} mm and turned {self.turned_deg:.0f} degrees.",
        ]
        if self.others:
            told.append(f"It also touched: {', '.join(self.others)}.")
        if self.felt and self.unexplained:
            told.append(
                f"For {100 * self.unexplained:.0f} % of the time that it felt a force, nothing was near it by the "
                "believed poses."
            )
        if self.unpredicted_n > FELT_N:
            told.append(
                f"The force differed from the predicted one by {self.unpredicted_n:.1f} N on average; "
                f"{self.predicted_n:.1f} N were predicted."
            )
        if self.sunk:
            told.append(
                f"For {100 * self.sunk:.0f} % of the time the hand was inside the {self.name} by the believed poses."
            )
        if self.crossed >= CROSSED:
            told.append(
                f"For {100 * self.over:.0f} % of the time the hand was over the {self.name}, {100 * self.above_m:.1f} "
                f"cm or more above its top, and it passed over {100 * self.passed_m:.1f} cm of it."
            )
        if self.around >= MOSTLY:
            told.append(
                f"At the end the {self.name} was between the fingers, which were told to close on something for "
                f"{100 * self.closing:.0f} % of the time."
            )
        if self.at_edge >= MOSTLY:
            told.append("At the end its targets stood at the edge of its workspace.")
        if self.largest_term:
            told.append(f"The term {self.largest_term!r} makes up {100 * self.largest_share:.0f} % of the cost.")
        return told + self.end.sentences()


def collect_evidence(
    steps: Sequence[Transition],
    notes: Sequence[PlanNote],
    name: str,
    size: Array,
    first_ends: Mapping[str, tuple[PartReading, ...]] | None = None,
) -> Evidence:
    """Collect what a record of one step or more says of an object with a bounding box of this size, Shape=(3,) m.

    `first_ends` is that of `collect_end`.
    """

    def inside(now: Observation) -> bool:
        return _outside(now.objects[name], size, now.tool.position) < AROUND_M

    away = [_outside(step.after.objects[name], size, step.after.tool.position) for step in steps]
    force = [float(np.linalg.norm(step.after.wrench[:3])) for step in steps]
    first, last = steps[0].before.objects[name], steps[-1].after.objects[name]
    ends = np.array([step.after.time_s for step in steps])
    touched, others, felt, unexplained, sunk = 0, dict[str, int](), 0, 0, 0
    felt_n, predicted_n = np.zeros(3), np.zeros(3)
    over, above_m, passed_m, crossed = _passing(steps, name, size)
    late_steps = [step for step in steps if step.after.time_s > ends[-1] - END_S]
    late = [note for note in notes if note.time_s > ends[-1] - END_S]
    for note in notes:
        things = {thing for each in note.touched.values() for thing in each}
        touched += name in things
        for thing in things - {name}:
            others[thing] = others.get(thing, 0) + 1
        index = min(int(np.searchsorted(ends, note.time_s - 1e-9)), len(force) - 1)
        felt_n = felt_n + steps[index].after.wrench[:3] / len(notes)
        predicted_n = predicted_n + np.asarray(note.expected_force) / len(notes)
        sunk += note.sunk_m.get(name, 0.0) > SUNK_M + SUNK_M_N * force[index]
        if force[index] > FELT_N:
            felt += 1
            unexplained += not things
    terms = dict(notes[-1].terms) if notes else {}
    largest = max(terms, key=lambda term: abs(terms[term]), default="")
    whole = sum(abs(value) for value in terms.values())
    return Evidence(
        name=name,
        seconds=steps[-1].after.time_s - steps[0].before.time_s,
        first_m=_outside(first, size, steps[0].before.tool.position),
        least_m=min(away),
        last_m=away[-1],
        touched=touched / max(len(notes), 1),
        others=tuple(sorted(thing for thing, count in others.items() if 4 * count >= len(notes))),
        felt=felt / max(len(notes), 1),
        unexplained=unexplained / max(felt, 1),
        force_mean_n=float(np.mean(force)),
        force_peak_n=max(force),
        predicted_n=float(np.linalg.norm(predicted_n)),
        unpredicted_n=float(np.linalg.norm(felt_n - predicted_n)),
        moved_m=float(np.linalg.norm(last.position - first.position)),
        turned_deg=float(np.degrees(np.linalg.norm(to_rotvec(multiply(conjugate(first.quaternion), last.quaternion))))),
        lag_m=float(np.mean([np.linalg.norm(step.command.position - step.after.tool.position) for step in steps])),
        sunk=sunk / max(len(notes), 1),
        at_edge=sum(note.at_edge for note in late) / max(len(late), 1),
        around=float(np.mean([inside(step.after) and step.after.opening_m >= np.min(size) for step in late_steps])),
        over=over,
        above_m=above_m,
        passed_m=passed_m,
        crossed=crossed,
        closing=float(np.mean([step.command.opening_m < step.after.opening_m - HELD_M for step in steps])),
        largest_term=largest,
        largest_share=abs(terms[largest]) / whole if whole else 0.0,
        largest_value=terms.get(largest, 0.0),
        end=collect_end(notes, first_ends),
    )


def _outside(body: BodyState, size: Array, point: Array) -> float:
    """Return the distance of a point from an object's bounding box, about the object's position; 0 inside."""
    local = np.abs(rotation_of(body.quaternion).T @ (point - body.position))
    return float(np.linalg.norm(np.maximum(local - np.asarray(size) / 2, 0.0)))


def _passing(steps: Sequence[Transition], name: str, size: Array) -> tuple[float, float, float, float]:
    """Return `over`, `above_m`, `passed_m` and `crossed` of `Evidence`."""
    height, ways, narrow = [], [], float("inf")
    for step in steps:
        body, tool = step.after.objects[name], step.after.tool.position
        half = np.abs(rotation_of(body.quaternion)) @ np.asarray(size) / 2
        away = tool - body.position
        narrow = min(narrow, 2.0 * float(half[:2].min()))
        if np.all(np.abs(away[:2]) <= half[:2]) and away[2] > half[2] - OVER_M:
            height.append(float(away[2] - half[2]))
            ways.append(tool[:2])
    if not ways:
        return 0.0, 0.0, 0.0, 0.0
    passed_m = float(np.linalg.norm(np.ptp(np.array(ways), axis=0)))
    return len(ways) / len(steps), max(min(height), 0.0), passed_m, passed_m / narrow
