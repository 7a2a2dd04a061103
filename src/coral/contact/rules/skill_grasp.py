"""Rules for grasping from above, lifting and placing: programs for any object that fits between the fingers."""

from __future__ import annotations

import numpy as np

from coral.contact.plan.contact_regions import Region
from coral.contact.plan.cost_plan import StageAnswer
from coral.contact.rules.placement import Placement
from coral.contact.rules.scene_reading import Draft, SkillAdjustment, Thing, disturbance_term, number, others, vector
from coral.contact.rules.support import origin_height
from coral.contact.scene.facts import SceneFacts

PALM_M = 0.037
"""Distance from the tool back to the palm."""


def add_grasp(draft: Draft, thing: Thing, facts: SceneFacts, adjustment: SkillAdjustment) -> None:
    """Add the stages that reach around the object from above and close the fingers."""
    closing = _closing_axis(thing, facts, adjustment)
    depth = max(0.0, thing.height / 2 - 0.025) - adjustment.lower_m
    depth = max(depth, 0.012 - thing.height / 2)
    head = _head(thing, depth, closing)
    n = thing.name
    near_m, square = number(0.012 * adjustment.loose), number(0.05 * adjustment.loose)
    near = f"({_distance_text(thing, depth)}) < {near_m} and ({_misalignment_text(thing, closing)}) < {square}"
    draft.stages += [
        StageAnswer(
            name="reach",
            done=near,
            code=head
            + f"""
    aside = norm(off[:2])
    ready = max(clip01((aside - 0.008) / 0.05), clip01((square - 0.02) / 0.2))
    # from above: until the hand stands over it and square to it, the way leads to a point over the object
    terms['reach'] = 12.0 * norm(off - np.array([0.0, 0.0, {number(thing.height / 2 - depth + 0.03)}]) * ready)
    terms['square'] = 4.0 * square
    terms['open'] = 20.0 * (0.08 - self.gripper_target)
    terms['leave alone'] = 0.1 * norm(self.{n}_hand_force)
{disturbance_term(facts, n)}    return terms
""",
        ),
        StageAnswer(
            name="close",
            done=f"self.{n}_left_contact and self.{n}_right_contact",
            back_to="reach",
            lost=f"({_distance_text(thing, depth)}) > 0.04",
            noise=0.5 * adjustment.careful,
            code=head
            + f"""
    terms['stay'] = 15.0 * norm(off)
    terms['square'] = 2.0 * square
    terms['close'] = {number(20 * adjustment.press)} * self.gripper_target
    terms['hold'] = -1.0 * self.{n}_left_contact * self.{n}_right_contact
{disturbance_term(facts, n)}    return terms
""",
        ),
    ]
    center, normal = thing.face(thing.up, thing.up_sign)
    draft.regions.append(
        (
            n,
            Region.model_validate(
                {
                    "center": center,
                    "normal": normal,
                    "extent": 0.004,
                    "num_samples": 4,
                    "approach": "pinch",
                    "opening": 0.08,
                    "stage": "reach",
                    "closing": closing,
                }
            ),
        )
    )
    draft.words.append(f"grasp the {n} from above across its {100 * thing.size[closing]:.1f} cm side")


def add_lift(draft: Draft, thing: Thing, facts: SceneFacts, height_m: float, adjustment: SkillAdjustment) -> None:
    """Add the stage that raises the held object until its lowest point is above a height."""
    n, depth = thing.name, _depth(thing, adjustment)
    rise = height_m + 0.025
    draft.stages.append(
        StageAnswer(
            name="lift",
            back_to="reach",
            lost=f"({_distance_text(thing, depth)}) > 0.04",
            noise=0.7 * adjustment.careful,
            opening=0.0,
            toward=f"self.ee_pos + np.array([0.0, 0.0, {number(rise)}])",
            code=_holding_head(thing, facts, adjustment)
            + f"""
    terms['lift'] = 10.0 * abs(self.{n}_pos[2] - self.{n}_init_pos[2] - {number(rise)})
    terms['stay over'] = 2.0 * norm((self.{n}_pos - self.{n}_init_pos)[:2])
    return terms
""",
        )
    )
    draft.words.append(f"raise it by {100 * rise:.0f} cm")


def add_place(draft: Draft, thing: Thing, facts: SceneFacts, placement: Placement, adjustment: SkillAdjustment) -> None:
    """Add the stages that carry the held object over everything else, set it down, release and retreat."""
    n, depth = thing.name, _depth(thing, adjustment)
    tops = [Thing(other, facts).position[2] + Thing(other, facts).height / 2 for other in others(facts, n)]
    tops += [
        item["position"][2] + item["size_m"][2] / 2
        for item in facts["fixtures"].values()
        if item["position"][2] + item["size_m"][2] / 2 < 0.3
    ]
    carry = max([0.06, *(min(top, 0.2) for top in tops)]) + thing.height / 2 + 0.02
    # After the lift it may be 3 cm lower than that; it must clear a rim then, too.
    carry = max(carry, placement.top_m + origin_height(thing) + 0.045)
    floor = max(placement.height_m, placement.palm_m - PALM_M - depth)
    lost = f"({_distance_text(thing, depth)}) > 0.05"
    aside = f"norm((self.{n}_pos + {vector(placement.shift)} - {placement.where})[:2])"
    hold = _holding_head(thing, facts, adjustment)
    target = f"{placement.where} - {vector(placement.shift)}"
    offset = f"(self.ee_pos - self.{n}_pos)"

    def to(over: str, height: float) -> str:
        return f"{over} * np.array([1.0, 1.0, 0.0]) + {vector([0, 0, height])} + {offset}"

    soft = 0.7 * adjustment.careful
    draft.stages += [
        StageAnswer(
            name="raise",
            done=f"self.{n}_pos[2] > {number(carry - 0.03)}",
            back_to="reach",
            lost=lost,
            noise=soft,
            opening=0.0,
            toward=to(f"self.{n}_pos", carry),
            code=hold
            + f"""
    terms['raise'] = 10.0 * abs(self.{n}_pos[2] - {number(carry)})
    return terms
""",
        ),
        StageAnswer(
            name="carry",
            done=f"{aside} < {number(placement.near_m)}",
            back_to="reach",
            lost=lost,
            noise=soft,
            opening=0.0,
            toward=to(target, carry),
            code=hold
            + f"""
    terms['carry'] = 10.0 * ({aside} + abs(self.{n}_pos[2] - {number(carry)}))
    return terms
""",
        ),
        StageAnswer(
            name="lower",
            done=f"self.{n}_pos[2] < {number(floor + 0.006)}",
            back_to="reach",
            lost=lost,
            noise=soft,
            opening=0.0,
            toward=to(target, floor),
            code=hold
            + f"""
    terms['lower'] = 10.0 * ({aside} + abs(self.{n}_pos[2] - {number(floor)}))
    terms['gently'] = 1.0 * norm(self.{n}_vel)
    return terms
""",
        ),
    ]
    draft.words.append(f"carry it at {100 * carry:.0f} cm {placement.words}")
    add_release(draft, thing, facts, adjustment)


def add_release(draft: Draft, thing: Thing, facts: SceneFacts, adjustment: SkillAdjustment) -> None:
    """Add the stage that opens the fingers and moves straight up."""
    n = thing.name
    draft.stages += [
        StageAnswer(
            name="release",
            done="self.gripper_opening > 0.07",
            noise=0.5 * adjustment.careful,
            opening=0.08,
            toward="self.ee_pos",
            code=f"""def state_cost(self):
    terms['open'] = 20.0 * (0.08 - self.gripper_target)
    terms['stay'] = 6.0 * norm(self.ee_vel)
    terms['leave alone'] = 5.0 * norm(self.{n}_vel)
    return terms
""",
        ),
        StageAnswer(
            name="retire",
            noise=0.7,
            opening=0.08,
            toward="self.ee_pos + np.array([0.0, 0.0, 0.1])",
            code=f"""def state_cost(self):
    above = self.{n}_pos[2] + {number(thing.height / 2 + 0.1)}
    terms['up'] = 10.0 * abs(self.ee_pos[2] - above)
    terms['straight'] = 10.0 * norm((self.ee_pos - self.{n}_pos)[:2])
    terms['open'] = 20.0 * (0.08 - self.gripper_target)
    terms['leave alone'] = 5.0 * norm(self.{n}_vel)
{disturbance_term(facts, n)}    return terms
""",
        ),
    ]
    draft.words.append("let go and retire upwards")


def _closing_axis(thing: Thing, facts: SceneFacts, adjustment: SkillAdjustment) -> int:
    """Choose the closing axis: of those that fit, the one with the most clearance for the hand; ties by width."""
    fits = thing.closings()

    def room(axis: int) -> float:
        side = thing.rotation[:2, axis] / max(float(np.linalg.norm(thing.rotation[:2, axis])), 1e-9)
        ends = [thing.position[:2] + reach * side for reach in (-0.1, -0.05, 0.05, 0.1)]
        tall = [Thing(other, facts) for other in others(facts, thing.name)]
        tall = [other for other in tall if other.position[2] + other.height / 2 > thing.position[2]]
        gaps = [
            float(np.linalg.norm(end - other.position[:2])) - float(max(other.size[other.lying])) / 2
            for other in tall
            for end in ends
        ]
        return min([0.05, *gaps])

    ranked = sorted(fits, key=lambda axis: (-round(room(axis), 2), thing.size[axis]))
    return ranked[adjustment.turn % len(ranked)]


def _depth(thing: Thing, adjustment: SkillAdjustment) -> float:
    return max(max(0.0, thing.height / 2 - 0.025) - adjustment.lower_m, 0.012 - thing.height / 2)


def _distance_text(thing: Thing, depth: float) -> str:
    return f"norm(self.ee_pos - self.{thing.name}_pos - {vector([0, 0, depth])})"


def _misalignment_text(thing: Thing, closing: int) -> str:
    return (
        f"2.0 + quat_axis(self.ee_quat, 2)[2] - abs(dot(quat_axis(self.ee_quat, 1), "
        f"quat_axis(self.{thing.name}_quat, {closing})))"
    )


def _head(thing: Thing, depth: float, closing: int) -> str:
    return f"""def state_cost(self):
    off = self.ee_pos - self.{thing.name}_pos - {vector([0, 0, depth])}
    square = {_misalignment_text(thing, closing)}"""


def _holding_head(thing: Thing, facts: SceneFacts, adjustment: SkillAdjustment) -> str:
    n, depth = thing.name, _depth(thing, adjustment)
    upright = f"1.0 - ({'-1.0 * ' if thing.up_sign < 0 else ''}quat_axis(self.{n}_quat, {thing.up})[2])"
    return f"""def state_cost(self):
    terms['hold'] = {number(20 * adjustment.press)} * self.gripper_target + 6.0 * {_distance_text(thing, depth)}
    terms['upright'] = 1.5 * (1.0 + quat_axis(self.ee_quat, 2)[2]) + 1.5 * ({upright})
    terms['calm'] = 0.1 * norm(self.ee_vel)
{disturbance_term(facts, n)}"""
