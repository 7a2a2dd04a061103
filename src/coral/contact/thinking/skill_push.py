"""Rules for pushing: to a place, over on its side, up against something, out over the table's edge."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coral.contact.thinking.plan_answer import StageAnswer
from coral.contact.thinking.regions import PAD_M, Array, Region
from coral.contact.thinking.setting import Choice, Draft, Thing, axis_of, care, number, vector

HIGH = 0.75
"""Where a box is tipped, -1 at the bottom to 1 at the top: some face is left below the upper edge for the fingertip."""
GRAVITY = 9.81


def abreast(width_m: float) -> float:
    """Opening at which two fingers side by side push a face: wide enough to steer, narrower than the face."""
    return float(np.clip(0.4 * width_m, 0.0, 0.07))


def behind_head(thing: Thing, axis: int, sign: float, height: str, handed: bool = False) -> str:
    """Begin of a program: the axis of pushing, the point behind the pushed face, how square the hand stands to it.

    Two orientations push alike. `handed` asks for the one whose fingers open to the left of the way, from where an arm
    can go on to point along an edge on that side; from the other one a Panda ends at its joint limits.
    """
    n, half = thing.name, thing.to_face(axis, -sign)
    return f"""def state_cost(self):
    along = {axis_of(n, axis, sign)}
    behind = self.{n}_pos - {number(half + PAD_M)} * along
    behind = np.array([behind[0], behind[1], {height}])
    off = self.ee_pos - behind
    square = {_square(thing.name, axis, sign if handed else 0.0)}"""


def add_behind(draft: Draft, thing: Thing, facts: Mapping[str, Any], axis: int, sign: float, height_m: float,
               choice: Choice, handed: bool = False) -> None:
    """Come from above to the face that is to be pushed."""
    n = thing.name
    wide = abreast(thing.size[next(k for k in thing.lying if k != axis)])
    up = thing.up_sign * (height_m - thing.low - thing.height / 2) / max(thing.height / 2, 1e-6)
    gap, above = 0.012, thing.height + 0.03
    here = (f"norm(self.ee_pos - self.{n}_pos + {number(thing.to_face(axis, -sign) + PAD_M + gap)} * "
            f"{axis_of(n, axis, sign)} - np.array([0.0, 0.0, {number(height_m)} - self.{n}_pos[2]]))")
    draft.stages.append(StageAnswer(
        name="reach", done=f"{here} < 0.018 and ({_square(n, axis, sign if handed else 0.0)}) < 0.1",
        code=behind_head(thing, axis, sign, number(height_m), handed) + f"""
    goal = behind - {number(gap)} * along
    aside = clip01((norm((self.ee_pos - goal)[:2]) - 0.015) / 0.05)
    # from above: until the hand stands beside the face, the way leads to a point over it
    terms['reach'] = 12.0 * norm(self.ee_pos - goal - np.array([0.0, 0.0, {number(above - height_m)}]) * aside)
    terms['square'] = 4.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['leave alone'] = 0.2 * norm(self.{n}_hand_force)
{care(facts, n)}    return terms
"""))
    center, normal = thing.face(axis, -sign, {thing.up: float(np.clip(up, -0.95, 0.95))})
    draft.regions.append((n, Region.model_validate({
        "center": center, "normal": normal, "extent": 0.006, "num_samples": 4, "approach": "push", "opening": wide,
        "stage": "reach"})))


def _square(n: str, axis: int, handed: float) -> str:
    if handed:
        left = f"cross(np.array([0.0, 0.0, 1.0]), {axis_of(n, axis, handed)})"
        return f"1.0 + quat_axis(self.ee_quat, 2)[2] + 4.0 * (1.0 - dot(quat_axis(self.ee_quat, 1), {left}))"
    return (f"1.0 + quat_axis(self.ee_quat, 2)[2] + 3.0 * dot(quat_axis(self.ee_quat, 1), "
            f"quat_axis(self.{n}_quat, {axis})) ** 2")


def add_push(draft: Draft, thing: Thing, facts: Mapping[str, Any], goal: Mapping[str, Any], newtons: float | None,
             choice: Choice) -> None:
    """Push to a place, with a given force if one is asked for."""
    n, place = thing.name, goal["place"]
    way = np.asarray(facts["places"][place], dtype=float)[:2] - thing.position[:2]
    axis, sign = thing.toward(np.array([*way, 0.0]))
    height = _push_height(thing, choice)
    add_behind(draft, thing, facts, axis, sign, height, choice)
    wide = abreast(thing.size[next(k for k in thing.lying if k != axis)])
    point = goal.get("point")
    where = f"self.{n}_{point}_pos" if point else f"self.{n}_pos"
    gap = f"norm(({where} - self.{place}_pos)[:2])"
    force = f"0.01 * norm(self.{n}_hand_force)" if newtons is None else (
        f"0.4 * abs(norm(self.{n}_hand_force) - {number(newtons)})")
    draft.stages.append(StageAnswer(
        name="push", done=f"{gap} < {number(0.5 * goal['tolerance_m'])}", back_to="reach",
        lost=f"norm(self.ee_pos - self.{n}_pos) > {number(thing.to_face(axis, -sign) + 0.1)}",
        noise=0.6 * choice.careful,
        toward=f"self.ee_pos + 0.06 * (self.{place}_pos - {where}) / ({gap} + 0.02) * np.array([1.0, 1.0, 0.0])",
        opening=wide, stiffness=600.0 * choice.press, code=behind_head(thing, axis, sign, number(height)) + f"""
    terms['behind'] = 8.0 * norm(off)
    terms['to the place'] = 15.0 * {gap}
    terms['force'] = {force}
    terms['square'] = 3.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['calm'] = {'2.0' if newtons is not None else '0.5'} * norm(self.{n}_vel)
{care(facts, n)}    return terms
"""))
    draft.words.append(f"push the {n} to {place}" + (f" with {newtons:g} N" if newtons else ""))
    add_draw_back(draft, thing, axis, sign, height, facts)


def add_draw_back(draft: Draft, thing: Thing, axis: int, sign: float, height_m: float, facts: Mapping[str, Any]
                  ) -> None:
    """Away from the pushed face, without taking the object along."""
    n = thing.name
    draft.stages.append(StageAnswer(
        name="draw back", noise=0.6, toward=f"self.ee_pos - 0.06 * {axis_of(n, axis, sign)}",
        code=behind_head(thing, axis, sign, number(height_m)) + f"""
    terms['away'] = 10.0 * norm(off + 0.05 * along)
    terms['leave alone'] = 5.0 * norm(self.{n}_vel)
    terms['square'] = 1.0 * square
    terms['calm'] = 0.3 * norm(self.ee_vel)
{care(facts, n)}    return terms
"""))


def _push_height(thing: Thing, choice: Choice) -> float:
    return float(thing.low + max(0.014, 0.35 * thing.height - choice.lower_m))


def add_tip(draft: Draft, thing: Thing, facts: Mapping[str, Any], choice: Choice) -> None:
    """Push near the top so that the object falls over its far lower edge."""
    n = thing.name
    ranked = sorted(thing.lying, key=lambda k: thing.size[k])
    axis = ranked[choice.turn % 2]
    sign = 1.0 if thing.rotation[0, axis] >= 0 else -1.0
    half_up = thing.height / 2
    height = thing.position[2] + HIGH * half_up - choice.lower_m
    add_behind(draft, thing, facts, axis, sign, height, choice)
    wide = abreast(thing.size[next(k for k in thing.lying if k != axis)])
    up = f"{'-1.0 * ' if thing.up_sign < 0 else ''}quat_axis(self.{n}_quat, {thing.up})"
    first = axis_of(n, axis, sign, "init_quat")
    lean = f"dot({up}, {first})"
    head = f"""def state_cost(self):
    ahead = {first}
    up = {up}
    along = {axis_of(n, axis, sign)}
    lean = dot(up, ahead)
    touch = self.{n}_pos - {number(thing.size[axis] / 2)} * along + {number(HIGH * half_up - choice.lower_m)} * up
    behind = touch - {number(PAD_M)} * ahead
    foot = self.{n}_pos + {number(thing.size[axis] / 2)} * along - {number(half_up)} * up
    square = 1.0 + quat_axis(self.ee_quat, 2)[2] + 3.0 * dot(quat_axis(self.ee_quat, 1), ahead) ** 2"""
    draft.stages += [
        StageAnswer(name="tip", done=f"{lean} > 0.75", back_to="reach", noise=0.6 * choice.careful, opening=wide,
                    lost=f"{lean} < 0.15 and norm(self.ee_pos - self.{n}_pos) > {number(half_up + 0.1)}",
                    toward=f"self.ee_pos + 0.07 * {first}", stiffness=600.0 * choice.press, code=head + f"""
    terms['behind'] = 10.0 * norm(self.ee_pos - behind)
    terms['tip'] = {number(5 * choice.press)} * (1.0 - lean)
    terms['do not slide'] = 2.0 * norm((foot - self.{n}_init_pos)[:2])
    terms['square'] = 3.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['gently'] = 0.05 * norm(self.{n}_hand_force)
    terms['calm'] = 0.3 * norm(self.ee_vel)
{care(facts, n)}    return terms
"""),
        StageAnswer(name="draw back", noise=0.6, back_to="reach", lost=f"{lean} < 0.3",
                    toward=f"self.ee_pos - 0.06 * {first} + np.array([0.0, 0.0, 0.03])", code=head + f"""
    away = self.{n}_init_pos - 0.08 * ahead
    terms['away'] = 8.0 * norm(self.ee_pos - np.array([away[0], away[1], {number(thing.height + 0.02)}]))
    terms['let it fall'] = 2.0 * (1.0 - lean)
    terms['let go'] = 0.2 * norm(self.{n}_hand_force)
    terms['square'] = 2.0 * square
    terms['calm'] = 0.3 * norm(self.ee_vel)
{care(facts, n)}    return terms
""")]
    draft.words.append(f"tip the {n} over its {100 * thing.size[axis]:.0f} cm deep foot by a push near its top")


def nearest_face(thing: Thing, item: Mapping[str, Any]) -> tuple[Array, Array]:
    """Point on the fixture's nearest upright face, and the horizontal direction from the object into it."""
    yaw = np.radians(item["yaw_deg"])
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    middle, half = np.asarray(item["position"][:2], dtype=float), np.asarray(item["size_m"][:2], dtype=float) / 2
    best: tuple[float, Array, Array] | None = None
    for k in (0, 1):
        for sign in (1.0, -1.0):
            out = sign * turn[:, k]
            point = middle + half[k] * out
            gap = float((thing.position[:2] - point) @ out)
            if gap > 0 and (best is None or gap < best[0]):
                best = gap, point, -out
    if best is None:
        return middle, np.array([1.0, 0.0])
    return best[1], best[2]


def add_pivot(draft: Draft, thing: Thing, facts: Mapping[str, Any], against: str, choice: Choice) -> None:
    """Push against something upright, raise the near end while pressing, let go."""
    n = thing.name
    point, way = nearest_face(thing, facts["fixtures"][against])
    axis, sign = thing.toward(np.array([*way, 0.0]))
    height = thing.low + 0.016 - min(choice.lower_m, 0.004)
    add_behind(draft, thing, facts, axis, sign, height, choice)
    wide = abreast(0.75 * thing.size[next(k for k in thing.lying if k != axis)])
    half, ahead = thing.size[axis] / 2, vector([*way, 0.0])
    up = f"{'-1.0 * ' if thing.up_sign < 0 else ''}quat_axis(self.{n}_quat, {thing.up})"
    raised = f"-1.0 * ({axis_of(n, axis, sign)})[2]"
    gap = (f"dot({vector([*point, 0.0])} - self.{n}_pos - {number(half)} * {axis_of(n, axis, sign)}, {ahead})")
    head = f"""def state_cost(self):
    ahead = {ahead}
    along = {axis_of(n, axis, sign)}
    up = {up}
    raised = -1.0 * along[2]
    edge = self.{n}_pos - {number(half)} * along - {number(thing.height / 2)} * up
    under = edge - {number(PAD_M)} * ahead + np.array([0.0, 0.0, 0.004])
    far_top = self.{n}_pos + {number(half)} * along + {number(thing.height / 2)} * up
    square = 1.0 + quat_axis(self.ee_quat, 2)[2] + 3.0 * dot(quat_axis(self.ee_quat, 1), ahead) ** 2"""
    lost = f"{raised} < 0.2 and norm(self.ee_pos - self.{n}_pos) > {number(half + 0.09)}"
    soft = 0.6 * choice.careful
    draft.stages += [
        StageAnswer(name="push", done=f"{gap} < 0.006", back_to="reach", lost=lost, noise=soft, opening=wide,
                    toward=f"self.ee_pos + 0.05 * {ahead}", code=behind_head(thing, axis, sign, number(height)) + f"""
    gap = {gap}
    terms['behind'] = 10.0 * norm(off)
    terms['up to the {against}'] = 12.0 * clip(gap, 0.0, 1.0)
    terms['straight'] = 3.0 * (1.0 - dot(along, {ahead}))
    terms['square'] = 3.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['gently'] = 0.02 * norm(self.{n}_hand_force)
    terms['calm'] = 0.5 * norm(self.{n}_vel)
{care(facts, n)}    return terms
"""),
        StageAnswer(name="raise", done=f"{raised} > 0.985", back_to="reach", lost=lost, noise=soft, opening=wide,
                    toward=f"self.ee_pos + 0.005 * {ahead} + np.array([0.0, 0.0, 0.03])", code=head + f"""
    force = dot(self.{n}_hand_force, ahead)
    far = dot({vector([*point, 0.0])} - far_top, ahead)
    terms['raise'] = {number(6 * choice.press)} * (1.0 - raised)
    terms['stay under'] = 12.0 * norm(self.ee_pos - under)
    terms['at the {against}'] = 10.0 * clip(far, 0.0, 1.0)
    terms['square'] = 2.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['press'] = 0.05 * abs(force - {number(6 * choice.press)})
    terms['calm'] = 0.2 * norm(self.{n}_vel)
{care(facts, n)}    return terms
"""),
        StageAnswer(name="let go", noise=soft, back_to="reach", lost=f"{raised} < 0.5",
                    toward=f"self.ee_pos - 0.06 * {ahead} + np.array([0.0, 0.0, 0.02])", code=head + f"""
    away = edge - 0.06 * ahead
    away = np.array([away[0], away[1], {number(thing.size[axis] * 0.6)}])
    terms['away'] = 10.0 * norm(self.ee_pos - away)
    terms['let go'] = 0.1 * norm(self.{n}_hand_force)
    terms['leave standing'] = 8.0 * (1.0 - raised)
    terms['square'] = 2.0 * square
    terms['calm'] = 0.3 * norm(self.ee_vel)
{care(facts, n)}    return terms
""")]
    center, normal = thing.face(axis, -sign, {thing.up: -0.8 * thing.up_sign})
    draft.regions.append((n, Region.model_validate({
        "center": center, "normal": normal, "extent": 0.004, "num_samples": 4, "approach": "push", "opening": wide,
        "stage": "push"})))
    draft.words.append(f"push the {n} up to the {against}, raise its near end against it, let go once it stands")
