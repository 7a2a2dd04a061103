"""Rules for objects too wide and flat to grasp as they lie: push one end over the table's edge and pinch it there."""

from __future__ import annotations

import numpy as np

from coral.contact.control.hand_model import MAX_OPENING_M, SQUEEZE_M
from coral.contact.plan.contact_regions import Array, Region, tool_quaternion
from coral.contact.plan.cost_plan import StageAnswer
from coral.contact.rules.scene_reading import (
    GRASP_M,
    Draft,
    SkillAdjustment,
    Thing,
    axis_of,
    disturbance_term,
    number,
    vector,
)
from coral.contact.rules.skill_push import add_reach_behind, behind_head
from coral.contact.scene.facts import SceneFacts

OPEN_M = 0.07
DEEP_M = 0.028
"""How far the fingers reach over the pinched part: the palm is 37 mm behind the tool and stays clear."""

SLANTS = (0.57, 0.27, 1.0)
"""Inward slant of the approach, in order of preference: 30, 15, 45 degrees off the edge. A Panda reaches all."""


def can_overhang(thing: Thing) -> bool:
    """Check whether an end of the object can be pinched across its height once it is over the edge."""
    return thing.height <= GRASP_M and max(thing.size[thing.lying]) > 2 * thing.height


def add_overhang(draft: Draft, thing: Thing, facts: SceneFacts, lift_m: float, adjustment: SkillAdjustment) -> None:
    """Add stages: push an end over the edge, move around it, pinch it, lift."""
    n = thing.name
    axis, sign, grip = _end_to_push(thing, facts)
    out, edge = _edge(thing, facts, thing.rotation[:, axis] * sign)
    overhang = min(facts["numbers"].get("overhang", 0.05), 0.3 * float(thing.size[axis]))
    rear = thing.to_face(axis, -sign)
    height = thing.low + max(0.014, thing.height / 2)
    add_reach_behind(draft, thing, facts, axis, sign, height, adjustment, handed=True)
    rise = lift_m + 0.05
    beyond = f"(dot(self.{n}_pos + quat_rotate(self.{n}_quat, {vector(grip)}), {vector(out)}) - {number(edge)})"
    # Along the edge, away from the robot and slightly inward, which an arm on the robot's side can reach.
    slant = SLANTS[adjustment.turn % len(SLANTS)]
    aside = np.array([1.0, 0.0, 0.0]) - slant * out if abs(out[1]) > abs(out[0]) else -out
    palm: Array = aside / np.linalg.norm(aside)
    inward = thing.rotation.T @ palm
    grip = grip - max(0.0, thing.room_behind(grip, inward) - DEEP_M - 0.5 * adjustment.lower_m) * inward
    at = f"(self.{n}_pos + quat_rotate(self.{n}_quat, {vector(grip)}))"
    tool = np.asarray(facts["hand"]["pose"][3:], dtype=float)
    pinch = tool_quaternion(palm, np.array([0.0, 0.0, 1.0]), tool)
    turn = f"quat_angle(self.ee_quat, {vector(pinch)})"
    soft = 0.6 * adjustment.careful
    over = f"{beyond} > {number(overhang - 0.004)}"
    reach = draft.stages[-1]
    draft.stages[-1] = reach.model_copy(update={"done": f"({reach.done}) or {over}"})
    side = np.cross([0.0, 0.0, 1.0], out)
    ahead = f"(self.{n}_pos + {vector((0.08 - rear) * out)})"

    draft.stages.append(
        StageAnswer(
            name="push",
            done=over,
            back_to="reach",
            noise=soft,
            lost=f"norm(self.ee_pos - self.{n}_pos) > {number(rear + 0.12)} and not {over}",
            opening=OPEN_M,
            toward=f"{ahead} * np.array([1.0, 1.0, 0.0]) + np.array([0.0, 0.0, {number(height)}])",
            stiffness=600.0 * adjustment.press,
            code=behind_head(thing, axis, sign, number(height), handed=True)
            + f"""
    beyond = {beyond}
    terms['overhang'] = 20.0 * clip({number(overhang)} - beyond, 0.0, 1.0)
    terms['not too far'] = 60.0 * clip(beyond - {number(overhang + 0.02)}, 0.0, 1.0)
    terms['behind'] = 8.0 * norm(off)
    drift = abs(dot(self.{n}_pos - self.{n}_init_pos, {vector(side)}))
    terms['straight'] = 3.0 * quat_angle(self.{n}_quat, self.{n}_init_quat) + 5.0 * drift
    terms['square'] = 2.0 * square
    terms['abreast'] = 15.0 * abs(self.gripper_target - {number(OPEN_M)})
    terms['gently'] = 1.0 * norm(self.{n}_vel) + 0.01 * norm(self.ee_force)
{disturbance_term(facts, n)}    return terms
""",
        )
    )

    def pose(goal: str, opening: str, turning: str = turn) -> str:
        return f"""def state_cost(self):
    goal = {goal}
    terms['reach'] = 10.0 * norm(self.ee_pos - goal)
    terms['turn'] = 2.0 * {turning}
    terms['opening'] = 15.0 * abs(self.gripper_target - {opening})
    terms['leave alone'] = 5.0 * norm(self.{n}_vel)
    terms['calm'] = 0.1 * norm(self.ee_vel)
    return terms
"""

    def beside(back_m: float, up_m: float) -> str:
        return f"({at} + {vector(-back_m * palm + np.array([0, 0, up_m]))})"

    def there(goal: str, near_m: float, angle: float) -> str:
        near, square = number(near_m * adjustment.loose), number(angle * adjustment.loose)
        return f"norm(self.ee_pos - {goal}) < {near} and {turn} < {square}"

    back = number(rear + 0.05)
    high = f"(self.{n}_pos - {back} * {axis_of(n, axis, sign)} + np.array([0.0, 0.0, 0.17]))"
    down = "(1.0 + quat_axis(self.ee_quat, 2)[2])"
    short = f"{beyond} < {number(overhang - 0.02)}"
    slipped = f"norm(self.ee_pos - {at}) > 0.06"
    held = f"self.{n}_left_contact and self.{n}_right_contact and self.gripper_target < {number(thing.height - 0.022)}"
    stay = f"10.0 * norm(self.ee_pos - {at})"
    near_side = f"{turn} < 0.5 and norm(self.ee_pos - {beside(0.12, 0.17)}) < 0.25"
    open_ = number(OPEN_M)
    draft.stages += [
        StageAnswer(
            name="rise",
            done=f"norm(self.ee_pos - {high}) < 0.05 or ({near_side})",
            toward=high,
            opening=OPEN_M,
            code=pose(high, open_, down),
        ),
        StageAnswer(
            name="turn",
            done=there(beside(0.12, 0.17), 0.03, 0.15),
            back_to="reach",
            lost=short,
            toward=beside(0.12, 0.17),
            opening=OPEN_M,
            code=pose(beside(0.12, 0.17), open_),
        ),
        StageAnswer(
            name="descend",
            done=there(beside(0.11, 0.0), 0.012, 0.1),
            toward=beside(0.11, 0.0),
            opening=OPEN_M,
            noise=soft,
            code=pose(beside(0.11, 0.0), open_),
        ),
        StageAnswer(
            name="insert",
            done=there(at, 0.012, 0.12),
            toward=at,
            opening=OPEN_M,
            noise=0.8 * soft,
            code=pose(at, open_),
        ),
        StageAnswer(
            name="pinch",
            done=held,
            back_to="turn",
            lost=slipped,
            toward=at,
            opening=SQUEEZE_M,
            noise=0.4,
            code=f"""def state_cost(self):
    terms['stay'] = {stay}
    terms['turn'] = 2.0 * {turn}
    terms['close'] = {number(20 * adjustment.press)} * self.gripper_target
    terms['hold'] = -1.0 * self.{n}_left_contact * self.{n}_right_contact
    terms['leave alone'] = 5.0 * norm(self.{n}_vel)
    return terms
""",
        ),
        StageAnswer(
            name="lift",
            back_to="turn",
            lost=slipped,
            opening=SQUEEZE_M,
            noise=0.5,
            toward=f"self.ee_pos + np.array([0.0, 0.0, {number(rise)}])",
            code=f"""def state_cost(self):
    rear = self.{n}_pos - {number(rear)} * {axis_of(n, axis, sign)}
    lowest = min(rear[2], self.{n}_pos[2])
    terms['lift'] = 10.0 * clip({number(rise)} - lowest, 0.0, 1.0)
    # the end in the hand may come up alone: what is believed too heavy is tried all the same
    terms['raise the end'] = 4.0 * clip({number(rise)} - self.ee_pos[2], 0.0, 1.0)
    terms['carry level'] = 1.0 * quat_angle(self.{n}_quat, self.{n}_init_quat)
    terms['hold'] = {number(20 * adjustment.press)} * self.gripper_target + 6.0 * norm(self.ee_pos - {at})
    terms['turn'] = 0.5 * {turn}
    terms['calm'] = 0.1 * norm(self.ee_vel)
    return terms
""",
        ),
    ]
    entry = grip - thing.room_behind(grip, inward) * inward
    draft.regions.append(
        (
            n,
            Region.model_validate(
                {
                    "center": [round(float(v), 4) for v in entry],
                    "normal": [round(float(v), 4) for v in -inward],
                    "extent": 0.004,
                    "num_samples": 4,
                    "approach": "pinch",
                    "opening": OPEN_M,
                    "stage": "insert",
                    "closing": thing.up,
                }
            ),
        )
    )
    draft.words.append(
        f"the {n} is wider than the hand opens ({100 * MAX_OPENING_M:.0f} cm): push one end "
        f"{100 * overhang:.0f} cm over the edge, pinch it across its thickness, lift"
    )


def _end_to_push(thing: Thing, facts: SceneFacts) -> tuple[int, float, Array]:
    """Choose the end to push out: axis, sign, and grip point in the object's frame.

    This is a named point whose name the instruction mentions, else the end nearest to the edge.
    """
    words = facts["instruction"].lower()
    named = [point for key, point in thing.points.items() if key.replace("_", " ") in words]
    if named:
        point = named[0]
        axis = max(thing.lying, key=lambda k: abs(float(point[k])))
        return axis, 1.0 if point[axis] >= 0 else -1.0, point
    best = max(
        ((k, s) for k in thing.lying for s in (1.0, -1.0)),
        key=lambda end: -_gap_to_edge(thing, facts, end[0], end[1]),
    )
    grip = thing.middle.copy()
    grip[best[0]] = best[1] * (thing.to_face(*best) - 0.02)
    return best[0], best[1], grip


def _gap_to_edge(thing: Thing, facts: SceneFacts, axis: int, sign: float) -> float:
    """Compute the distance from the end to the edge that it points to; a near-side arm reaches left and right."""
    out, edge = _edge(thing, facts, thing.rotation[:, axis] * sign)
    tip = thing.position + thing.rotation[:, axis] * sign * thing.to_face(axis, sign)
    return edge - float(tip @ out) + (0.3 if abs(out[0]) > 0.5 else 0.0)


def _edge(thing: Thing, facts: SceneFacts, direction: Array) -> tuple[Array, float]:
    """Return the outward normal of the table's edge in a direction, and the edge's coordinate along it."""
    k = int(abs(direction[1]) >= abs(direction[0]))
    sign = 1.0 if direction[k] >= 0 else -1.0
    out = np.zeros(3)
    out[k] = sign
    return out, sign * (facts["table"]["x"], facts["table"]["y"])[k][int(sign > 0)]
