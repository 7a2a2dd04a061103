"""What happened when a plan was rehearsed, stage by stage, in numbers for its author."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TypedDict

import numpy as np

from coral.contact.plan.imagined_run import ImaginedMoment
from coral.contact.scene.geometry import conjugate, multiply, to_rotvec
from coral.contact.scene.observation import Array

LARGEST = 4
"""Number of terms that are told of."""
TOUCHING = ("hand", "left", "right")


class RehearsedObject(TypedDict):
    """What an object did in a stage: its motion in world axes (mm), its turn (degrees), the time of contact (s)."""

    moved_mm: list[float]
    turned_deg: float
    touched_s: float


class RehearsedStage(TypedDict):
    """One stage of a rehearsal, from its beginning to its end.

    Args:
        stage: Its name; a stage to which the plan fell back appears again.
        began_s: Time since the rehearsal began.
        ended_s: The same of its end; None if it went on to the end of the rehearsal.
        then: The stage that followed; "" for none.
        hand_pos: Position of the tool at the end, m.
        opening_m: Opening of the fingers at the end.
        objects: What each object did.
        force_mean_n: Mean force on the hand.
        force_peak_n: Its peak.
        terms: The largest terms of its cost at the end.
    """

    stage: str
    began_s: float
    ended_s: float | None
    then: str
    hand_pos: list[float]
    opening_m: float
    objects: dict[str, RehearsedObject]
    force_mean_n: float
    force_peak_n: float
    terms: dict[str, float]


def summarize_rehearsal(moments: Sequence[ImaginedMoment]) -> list[RehearsedStage]:
    """Summarize a rehearsal stage by stage.

    Args:
        moments: Its moments in order.
    """
    if not moments:
        return []
    start_s, period_s = moments[0].now.time_s, _period_s(moments)
    visits: list[int] = list(np.cumsum([0, *(one.stage != one.next_stage for one in moments[:-1])]))
    rows: list[RehearsedStage] = []
    for _, group in groupby(range(len(moments)), key=lambda index: visits[index]):
        indices = list(group)
        held = [moments[index] for index in indices]
        last, ended = held[-1], held[-1].stage != held[-1].next_stage
        # The state after the last plan of a stage is the first of the next stage.
        end = moments[min(indices[-1] + 1, len(moments) - 1)].now
        force = [float(np.linalg.norm(one.now.wrench[:3])) for one in held]
        terms = sorted(last.plan.terms.items(), key=lambda item: -abs(item[1]))[:LARGEST]
        rows.append(
            {
                "stage": last.stage,
                "began_s": round(held[0].now.time_s - start_s, 2),
                "ended_s": round(last.now.time_s - start_s, 2) if ended else None,
                "then": last.next_stage if ended else "",
                "hand_pos": _rounded(end.tool.position, 3),
                "opening_m": round(end.opening_m, 3),
                "objects": {
                    name: {
                        "moved_mm": _rounded(1e3 * (end.objects[name].position - body.position), 0),
                        "turned_deg": round(_turn_deg(body.quaternion, end.objects[name].quaternion), 0),
                        "touched_s": round(period_s * sum(_touches(one, name) for one in held), 2),
                    }
                    for name, body in held[0].now.objects.items()
                },
                "force_mean_n": round(float(np.mean(force)), 1),
                "force_peak_n": round(max(force), 1),
                "terms": {name: float(f"{value:.3g}") for name, value in terms},
            }
        )
    return rows


def unreached_stages(rows: Sequence[RehearsedStage], names: Sequence[str]) -> list[str]:
    """Return the stages of a plan that its rehearsal did not reach."""
    begun = {row["stage"] for row in rows} | {row["then"] for row in rows}
    return [name for name in names if name not in begun]


def _period_s(moments: Sequence[ImaginedMoment]) -> float:
    return moments[1].now.time_s - moments[0].now.time_s if len(moments) > 1 else 0.0


def _touches(moment: ImaginedMoment, name: str) -> bool:
    now = moment.plan.now
    if now is None:
        return False
    state: Mapping[str, Array] = {
        part: now[f"{name}_{part}_contact"] for part in TOUCHING if f"{name}_{part}_contact" in now
    }
    return any(bool(np.asarray(value).any()) for value in state.values())


def _turn_deg(before: Array, after: Array) -> float:
    return float(np.degrees(np.linalg.norm(to_rotvec(multiply(conjugate(before), after)))))


def _rounded(values: Array, digits: int) -> list[float]:
    return [round(float(value), digits) + 0.0 for value in values]
