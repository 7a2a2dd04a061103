"""Adjustments of the default advisor's plan after each diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from coral.contact.rules.scene_reading import SkillAdjustment

LOOSE = 1.5
"""Factor on the ends of reaches: 1.8 cm in place of 1.2, about what the planner leaves. Next, another side is tried."""


def adjustment_after(diagnoses: Sequence[str]) -> SkillAdjustment:
    """Return the adjustment after these failures, in order."""
    adjustment = SkillAdjustment()
    for kind in diagnoses:
        if kind == "slipped":
            adjustment = replace(
                adjustment,
                press=min(adjustment.press * 1.4, 3.0),
                lower_m=min(adjustment.lower_m + 0.006, 0.012),
                careful=max(0.5, 0.8 * adjustment.careful),
            )
        elif kind == "not-moved":
            adjustment = replace(adjustment, press=min(adjustment.press * 1.6, 3.0))
        elif kind == "stage-never-ends" and adjustment.loose < LOOSE:
            adjustment = replace(adjustment, loose=LOOSE)
        elif kind in (
            "stage-never-ends",
            "not-gripped",
            "not-reached",
            "led-away",
            "out-of-reach",
            "pose-wrong",
            "settled",
            "blocked",
            "no-progress",
            "cost-error",
        ):
            adjustment = replace(adjustment, turn=adjustment.turn + 1)
        else:
            adjustment = replace(adjustment, careful=max(0.5, 0.8 * adjustment.careful))
    return adjustment


def change_words(before: SkillAdjustment, after: SkillAdjustment) -> str:
    """Describe the changes of a repair in a sentence."""
    words = []
    if after.turn != before.turn:
        words.append("takes the next grasp or side that fits")
    if after.press != before.press:
        words.append(f"presses and squeezes {after.press / before.press:.1f} times as hard")
    if after.lower_m != before.lower_m:
        words.append(f"takes hold {1000 * (after.lower_m - before.lower_m):.0f} mm lower")
    if after.loose != before.loose:
        words.append(f"goes on from {after.loose / before.loose:.1f} times as far from where the hand reaches")
    if after.careful != before.careful:
        words.append("moves more carefully in contact")
    return "The new one " + " and ".join(words) if words else "The new one tries the same again"
