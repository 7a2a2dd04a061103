"""Rules for standing an object up: push it against an upright face, raise its near end, release."""

from __future__ import annotations

import numpy as np

from coral.contact.plan.contact_regions import PAD_M, Array, Region
from coral.contact.plan.cost_plan import StageAnswer
from coral.contact.rules.scene_reading import Draft, SkillAdjustment, Thing, axis_of, disturbance_term, number, vector
from coral.contact.rules.skill_push import abreast_opening, add_reach_behind, behind_head
from coral.contact.scene.facts import FixtureFacts, SceneFacts


def nearest_face(thing: Thing, item: FixtureFacts) -> tuple[Array, Array]:
    """Find the point on the fixture's nearest upright face, and the horizontal direction from the object into it."""
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


def add_pivot(draft: Draft, thing: Thing, facts: SceneFacts, against: str, adjustment: SkillAdjustment) -> None:
    """Add the stages that push against an upright face, raise the near end while pressing, and release."""
    n = thing.name
    point, way = nearest_face(thing, facts["fixtures"][against])
    axis, sign = thing.toward(np.array([*way, 0.0]))
    height = thing.low + 0.016 - min(adjustment.lower_m, 0.004)
    add_reach_behind(draft, thing, facts, axis, sign, height, adjustment)
    wide = abreast_opening(0.75 * thing.size[next(k for k in thing.lying if k != axis)])
    half, ahead = thing.size[axis] / 2, vector([*way, 0.0])
    up = f"{'-1.0 * ' if thing.up_sign < 0 else ''}quat_axis(self.{n}_quat, {thing.up})"
    raised = f"-1.0 * ({axis_of(n, axis, sign)})[2]"
    gap = f"dot({vector([*point, 0.0])} - self.{n}_pos - {number(half)} * {axis_of(n, axis, sign)}, {ahead})"
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
    soft = 0.6 * adjustment.careful
    draft.stages += [
        StageAnswer(
            name="push",
            done=f"{gap} < 0.006",
            back_to="reach",
            lost=lost,
            noise=soft,
            opening=wide,
            toward=f"self.ee_pos + 0.05 * {ahead}",
            code=behind_head(thing, axis, sign, number(height))
            + f"""
    gap = {gap}
    terms['behind'] = 10.0 * norm(off)
    terms['up to the {against}'] = 12.0 * clip(gap, 0.0, 1.0)
    terms['straight'] = 3.0 * (1.0 - dot(along, {ahead}))
    terms['square'] = 3.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['gently'] = 0.02 * norm(self.{n}_hand_force)
    terms['calm'] = 0.5 * norm(self.{n}_vel)
{disturbance_term(facts, n)}    return terms
""",
        ),
        StageAnswer(
            name="raise",
            done=f"{raised} > 0.985",
            back_to="reach",
            lost=lost,
            noise=soft,
            opening=wide,
            toward=f"self.ee_pos + 0.005 * {ahead} + np.array([0.0, 0.0, 0.03])",
            code=head
            + f"""
    force = dot(self.{n}_hand_force, ahead)
    far = dot({vector([*point, 0.0])} - far_top, ahead)
    terms['raise'] = {number(6 * adjustment.press)} * (1.0 - raised)
    terms['stay under'] = 12.0 * norm(self.ee_pos - under)
    terms['at the {against}'] = 10.0 * clip(far, 0.0, 1.0)
    terms['square'] = 2.0 * square
    terms['abreast'] = 20.0 * abs(self.gripper_target - {number(wide)})
    terms['press'] = 0.05 * abs(force - {number(6 * adjustment.press)})
    # half way up, a finger that is not held back jams between the {n} and the {against}
    terms['gently'] = 0.1 * clip(norm(self.ee_force) - {number(12 * adjustment.press)}, 0.0, 100.0)
    terms['calm'] = 0.2 * norm(self.{n}_vel)
{disturbance_term(facts, n)}    return terms
""",
        ),
        StageAnswer(
            name="let go",
            noise=soft,
            back_to="reach",
            lost=f"{raised} < 0.5",
            toward=f"self.ee_pos - 0.06 * {ahead} + np.array([0.0, 0.0, 0.02])",
            code=head
            + f"""
    off = self.ee_pos - edge + 0.09 * ahead - np.array([0.0, 0.0, 0.03])
    terms['away'] = 10.0 * max(0.0, norm(off) - 0.03)
    terms['let go'] = 1.0 * self.{n}_hand_contact
    terms['gently'] = 0.05 * norm(self.ee_force)
    terms['leave standing'] = 8.0 * (1.0 - raised)
    terms['square'] = 2.0 * square
    terms['calm'] = 0.3 * norm(self.ee_vel)
{disturbance_term(facts, n)}    return terms
""",
        ),
    ]
    center, normal = thing.face(axis, -sign, {thing.up: -0.8 * thing.up_sign})
    draft.regions.append(
        (
            n,
            Region.model_validate(
                {
                    "center": center,
                    "normal": normal,
                    "extent": 0.004,
                    "num_samples": 4,
                    "approach": "push",
                    "opening": wide,
                    "stage": "push",
                }
            ),
        )
    )
    draft.words.append(f"push the {n} up to the {against}, raise its near end against it, let go once it stands")
