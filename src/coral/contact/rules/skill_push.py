"""Rules for pushing: approaching a face from behind, pushing to a place, tipping over."""

from __future__ import annotations

import numpy as np

from coral.contact.plan.contact_regions import PAD_M, Region
from coral.contact.plan.cost_plan import StageAnswer
from coral.contact.rules.scene_reading import Draft, SkillAdjustment, Thing, axis_of, disturbance_term, number
from coral.contact.scene.facts import AtGoal, SceneFacts

HIGH = 0.75
"""Height at which a box is tipped, from -1 at the bottom to 1 at the top: the fingertip needs room below the edge."""
PACE_M_S = 0.035
LEAD_M = 0.06
SOFT = 1.5
"""Softness of the hand for a steady force: at the longest lead its spring pulls hardly harder than asked."""


def abreast_opening(width_m: float) -> float:
    """Return the opening at which both fingers push a face abreast: wide enough to steer, narrower than the face."""
    return float(np.clip(0.4 * width_m, 0.0, 0.07))


def behind_head(thing: Thing, axis: int, sign: float, height: str, handed: bool = False) -> str:
    """Return the head of a program: the pushing axis, the point behind the pushed face, and the hand's misalignment.

    Two orientations push alike. `handed` selects the one whose fingers open to the left of the path, from which an arm
    can go on to point along an edge on that side; from the other one a Panda ends at its joint limits.
    """
    n, half = thing.name, thing.to_face(axis, -sign)
    return f"""def state_cost(self):
    along = {axis_of(n, axis, sign)}
    behind = self.{n}_pos - {number(half + PAD_M)} * along
    behind = np.array([behind[0], behind[1], {height}])
    off = self.ee_pos - behind
    square = {_misalignment_text(thing.name, axis, sign if handed else 0.0)}"""


def add_reach_behind(
    draft: Draft,
    thing: Thing,
    facts: SceneFacts,
    axis: int,
    sign: float,
    height_m: float,
    adjustment: SkillAdjustment,
    handed: bool = False,
) -> None:
    """Add the stage that approaches the pushed face from above."""
    n = thing.name
    wide = abreast_opening(thing.size[next(k for k in thing.lying if k != axis)])
    up = thing.up_sign * (height_m - thing.low - thing.height / 2) / max(thing.height / 2, 1e-6)
    gap, above = 0.012, thing.height + 0.03
    here = (
        f"norm(self.ee_pos - self.{n}_pos + {number(thing.to_face(axis, -sign) + PAD_M + gap)} * "
        f"{axis_of(n, axis, sign)} - np.array([0.0, 0.0, {number(height_m)} - self.{n}_pos[2]]))"
    )
    draft.stages.append(
        StageAnswer(
            name="reach",
            done=f"{here} < {number(0.018 * adjustment.loose)} and "
            f"({_misalignment_text(n, axis, sign if handed else 0.0)}) < {number(0.1 * adjustment.loose)}",
            code=behind_head(thing, axis, sign, number(height_m), handed)
            + f"""
    goal = behind - {number(gap)} * along
    aside = clip01((norm((self.ee_pos - goal)[:2]) - 0.015) / 0.05)
    # from above: until the hand stands beside the face, the way leads to a point over it
    terms['reach'] = 12.0 * norm(self.ee_pos - goal - np.array([0.0, 0.0, {number(above - height_m)}]) * aside)
    terms['square'] = 4.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['leave alone'] = 0.2 * norm(self.{n}_hand_force)
{_no_blow_term(facts, n)}{disturbance_term(facts, n)}    return terms
""",
        )
    )
    center, normal = thing.face(axis, -sign, {thing.up: float(np.clip(up, -0.95, 0.95))})
    draft.regions.append(
        (
            n,
            Region.model_validate(
                {
                    "center": center,
                    "normal": normal,
                    "extent": 0.006,
                    "num_samples": 4,
                    "approach": "push",
                    "opening": wide,
                    "stage": "reach",
                }
            ),
        )
    )


def _no_blow_term(facts: SceneFacts, n: str) -> str:
    """Return the term that keeps the hand clear of an object that may not be pressed hard, while it goes round it.

    A hand that has passed the object, as before a repair, would come back through it.
    """
    if not any(goal["kind"] == "peak-force" and goal["object"] == n for goal in facts["goals"]):
        return ""
    return f"    terms['no blow'] = 12.0 * aside * clip01((0.03 - self.{n}_hand_clearance) / 0.03)\n"


def _misalignment_text(n: str, axis: int, handed: float) -> str:
    if handed:
        left = f"cross(np.array([0.0, 0.0, 1.0]), {axis_of(n, axis, handed)})"
        return f"1.0 + quat_axis(self.ee_quat, 2)[2] + 4.0 * (1.0 - dot(quat_axis(self.ee_quat, 1), {left}))"
    return (
        f"1.0 + quat_axis(self.ee_quat, 2)[2] + 3.0 * dot(quat_axis(self.ee_quat, 1), "
        f"quat_axis(self.{n}_quat, {axis})) ** 2"
    )


def add_push(
    draft: Draft,
    thing: Thing,
    facts: SceneFacts,
    goal: AtGoal,
    newtons: float | None,
    adjustment: SkillAdjustment,
) -> None:
    """Add the stages that push to a place, with a given force if one is asked for."""
    n, place = thing.name, goal["place"]
    way = np.asarray(facts["places"][place], dtype=float)[:2] - thing.position[:2]
    axis, sign = thing.toward(np.array([*way, 0.0]))
    height = (
        _push_height(thing, adjustment) if newtons is None else max(thing.low + thing.height - 0.03, thing.low + 0.016)
    )
    add_reach_behind(draft, thing, facts, axis, sign, height, adjustment)
    wide = abreast_opening(thing.size[next(k for k in thing.lying if k != axis)])
    point = goal.get("point")
    where = f"self.{n}_{point}_pos" if point else f"self.{n}_pos"
    gap = f"norm(({where} - self.{place}_pos)[:2])"
    lost = f"norm(self.ee_pos - self.{n}_pos) > {number(thing.to_face(axis, -sign) + 0.1)}"
    stiffness, short = 600.0 * adjustment.press, ""
    if newtons is None:
        draft.stages.append(
            StageAnswer(
                name="push",
                done=f"{gap} < {number(0.5 * goal['tolerance_m'])}",
                back_to="reach",
                lost=lost,
                noise=0.6 * adjustment.careful,
                stiffness=stiffness,
                opening=wide,
                toward=f"self.ee_pos + 0.06 * (self.{place}_pos - {where}) / ({gap} + 0.02) * "
                "np.array([1.0, 1.0, 0.0])",
                code=behind_head(thing, axis, sign, number(height))
                + f"""
    terms['behind'] = 8.0 * norm(off)
    terms['to the place'] = 15.0 * {gap}
    terms['force'] = 0.01 * norm(self.{n}_hand_force)
    terms['square'] = 3.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['calm'] = 0.5 * norm(self.{n}_vel)
{disturbance_term(facts, n)}    return terms
""",
            )
        )
    else:
        stiffness = float(np.clip(SOFT * newtons / LEAD_M * adjustment.press, 50.0, 600.0))
        short = f"{gap} > {number(0.95 * goal['tolerance_m'])}"
        ahead = f"(self.{place}_pos - {where}) / ({gap} + 0.001) * np.array([1.0, 1.0, 0.0])"
        top = number(thing.height / 2 - 0.01)
        draft.stages.append(
            StageAnswer(
                name="push",
                done=f"{gap} < {number(0.7 * goal['tolerance_m'])}",
                back_to="reach",
                lost=lost,
                noise=0.2 * adjustment.careful,
                stiffness=stiffness,
                toward=f"self.ee_pos + 0.065 * {ahead} - "
                f"np.array([0.0, 0.0, max(0.0, self.ee_pos[2] - self.{n}_pos[2] - {top})])",
                code=_steady_push_head(thing, axis, sign, place, where, height, newtons)
                + f"""
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
{disturbance_term(facts, n)}    return terms
""",
            )
        )
    draft.words.append(f"push the {n} to {place}" + (f" with {newtons:g} N" if newtons else ""))
    add_retreat(draft, thing, axis, sign, height, facts, stiffness, short)


def _steady_push_head(
    thing: Thing, axis: int, sign: float, place: str, where: str, height_m: float, newtons: float
) -> str:
    """Return the head of a program that pushes with a steady force.

    Friction balances a slow push; stops, impacts and the hand's stiffness disturb the force. So the target of the
    hand's spring moves straight to the place at constant speed, the force counts as a vector (dragging down the face
    adds friction), and the hand stays behind the middle, on the line to the place, or the object turns.
    """
    n = thing.name
    return f"""def state_cost(self):
    along = {axis_of(n, axis, sign)}
    way = (self.{place}_pos - {where}) * np.array([1.0, 1.0, 0.0])
    left = norm(way)
    ahead = way / (left + 0.001)
    line = way + 0.03 * along
    line = line / (norm(line) + 0.001)
    depth = {number(thing.to_face(axis, -sign))} / clip(dot(line, along), 0.7, 1.0)
    behind = self.{n}_pos - depth * line - {number(PAD_M)} * along
    off = self.ee_pos - behind
    wrong = self.{n}_hand_force - {number(newtons)} * ahead
    pace = {number(PACE_M_S)} * clip01(left / 0.01)
    terms['to the place'] = 12.0 * left
    terms['evenly'] = 2.0 * norm((self.{n}_vel - pace * ahead)[:2])
    high = abs(self.ee_pos[2] - {number(height_m)})
    terms['behind'] = 6.0 * clip(norm(off[:2]) - 0.01, 0.0, 1.0) + 6.0 * clip(high - 0.02, 0.0, 1.0)
    terms['force'] = 0.05 * norm(wrong)
    aside = off - dot(off, ahead) * ahead
    terms['straight'] = 25.0 * norm((self.last_action[:3] - {number(PACE_M_S)} * ahead + 0.8 * aside)[:2])
    terms['no drag'] = 0.1 * abs(wrong[2])
    # linear in small tilts: a finger that leans is a wedge
    tilt = norm(quat_axis(self.ee_quat, 2)[:2])
    terms['square'] = 2.0 * tilt + 6.0 * dot(quat_axis(self.ee_quat, 1), along) ** 2"""


def add_retreat(
    draft: Draft,
    thing: Thing,
    axis: int,
    sign: float,
    height_m: float,
    facts: SceneFacts,
    stiffness: float = 600.0,
    short: str = "",
) -> None:
    """Add the stage that leaves the pushed face without dragging the object, as stiff as the push to avoid a jolt."""
    n = thing.name
    draft.stages.append(
        StageAnswer(
            name="draw back",
            noise=0.6,
            toward=f"self.ee_pos - 0.06 * {axis_of(n, axis, sign)}",
            stiffness=stiffness,
            back_to="reach" if short else "",
            lost=short,
            code=behind_head(thing, axis, sign, number(height_m))
            + f"""
    terms['away'] = 10.0 * norm(off + 0.05 * along)
    terms['leave alone'] = 5.0 * norm(self.{n}_vel)
    terms['square'] = 1.0 * square
    terms['calm'] = 0.3 * norm(self.ee_vel)
{disturbance_term(facts, n)}    return terms
""",
        )
    )


def _push_height(thing: Thing, adjustment: SkillAdjustment) -> float:
    return float(thing.low + max(0.014, 0.35 * thing.height - adjustment.lower_m))


def add_tip(draft: Draft, thing: Thing, facts: SceneFacts, adjustment: SkillAdjustment) -> None:
    """Add the stage that pushes near the top so that the object tips over its far lower edge."""
    n = thing.name
    ranked = sorted(thing.lying, key=lambda k: thing.size[k])
    axis = ranked[adjustment.turn % 2]
    sign = 1.0 if thing.rotation[0, axis] >= 0 else -1.0
    half_up = thing.height / 2
    height = thing.position[2] + HIGH * half_up - adjustment.lower_m
    add_reach_behind(draft, thing, facts, axis, sign, height, adjustment)
    wide = abreast_opening(thing.size[next(k for k in thing.lying if k != axis)])
    up = f"{'-1.0 * ' if thing.up_sign < 0 else ''}quat_axis(self.{n}_quat, {thing.up})"
    first = axis_of(n, axis, sign, "init_quat")
    lean = f"dot({up}, {first})"
    head = f"""def state_cost(self):
    ahead = {first}
    up = {up}
    along = {axis_of(n, axis, sign)}
    lean = dot(up, ahead)
    touch = self.{n}_pos - {number(thing.size[axis] / 2)} * along + {number(HIGH * half_up - adjustment.lower_m)} * up
    behind = touch - {number(PAD_M)} * ahead
    foot = self.{n}_pos + {number(thing.size[axis] / 2)} * along - {number(half_up)} * up
    square = 1.0 + quat_axis(self.ee_quat, 2)[2] + 3.0 * dot(quat_axis(self.ee_quat, 1), ahead) ** 2"""
    draft.stages += [
        StageAnswer(
            name="tip",
            done=f"{lean} > 0.75",
            back_to="reach",
            noise=0.6 * adjustment.careful,
            opening=wide,
            lost=f"{lean} < 0.15 and norm(self.ee_pos - self.{n}_pos) > {number(half_up + 0.1)}",
            toward=f"self.ee_pos + 0.07 * {first}",
            stiffness=600.0 * adjustment.press,
            code=head
            + f"""
    terms['behind'] = 10.0 * norm(self.ee_pos - behind)
    terms['tip'] = {number(5 * adjustment.press)} * (1.0 - lean)
    terms['do not slide'] = 2.0 * norm((foot - self.{n}_init_pos)[:2])
    terms['square'] = 3.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['gently'] = 0.05 * norm(self.{n}_hand_force)
    terms['calm'] = 0.3 * norm(self.ee_vel)
{disturbance_term(facts, n)}    return terms
""",
        ),
        StageAnswer(
            name="draw back",
            noise=0.6,
            back_to="reach",
            lost=f"{lean} < 0.3",
            toward=f"self.ee_pos - 0.06 * {first} + np.array([0.0, 0.0, 0.03])",
            code=head
            + f"""
    away = self.{n}_init_pos - 0.08 * ahead
    terms['away'] = 8.0 * norm(self.ee_pos - np.array([away[0], away[1], {number(thing.height + 0.02)}]))
    terms['let it fall'] = 2.0 * (1.0 - lean)
    terms['let go'] = 0.2 * norm(self.{n}_hand_force)
    terms['square'] = 2.0 * square
    terms['calm'] = 0.3 * norm(self.ee_vel)
{disturbance_term(facts, n)}    return terms
""",
        ),
    ]
    draft.words.append(f"tip the {n} over its {100 * thing.size[axis]:.0f} cm deep foot by a push near its top")
