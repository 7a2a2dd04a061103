"""The scene in words and numbers, as prompts show it: everything that the rules read from a question's facts, and why.

A test walks the facts and finds each of their values here, so that the rules never know more than a model.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coral.contact.control.hand_controllers import PlannerLimits
from coral.contact.control.hand_model import FLANGE_TO_TOOL_M, MAX_OPENING_M, SQUEEZE_M, HandCfg
from coral.contact.cost.context import Schema
from coral.contact.scene.condition import BaseCondition
from coral.contact.scene.facts import ObjectFacts, SceneFacts
from coral.contact.scene.geometry import column_of
from coral.contact.scene.mujoco_scene import FINGER_FRICTION
from coral.contact.scene.task import Task
from coral.contact.thinker.interface_text import interface_text
from coral.contact.thinker.think_cfg import ThinkCfg

SQUEEZE = HandCfg()
AXES = (
    "World frame: metres, z up, the table's top at z = 0. x points away from the robot, y to its left: nearer means "
    "smaller x, left means larger y."
)
HAND = (
    "The hand: two fingers, the left one towards the hand's y axis; ee_pos lies between their tips, 8 mm before the "
    "ends. A finger is 2 cm wide, 1.2 cm thick (along the opening), 4.5 cm long. The palm, 20 cm along the opening, "
    "6 cm across and 7 cm deep, begins 4 cm behind ee_pos; a wrist 10 cm thick follows. "
    f"Fingers rub with friction {FINGER_FRICTION:g} on everything (elsewhere an object's own counts, of two objects "
    f"the larger). gripper_target is {SQUEEZE_M:g} to {MAX_OPENING_M:g} m; each squeezes with "
    f"{SQUEEZE.finger_stiffness_n_m / 2:g} N/m of gripper_opening - gripper_target, "
    f"{SQUEEZE.finger_force_n:g} N at most."
)

SHOULDER_UP_M = 0.333
"""Height of the Panda's shoulder above its base."""


def planner_text(limits: PlannerLimits) -> str:
    """Describe what the planner of this run can do: horizon, speeds, force, workspace."""
    cfg = limits.controller
    corners = zip("xyz", cfg.workspace_low_m, cfg.workspace_high_m, strict=True)
    bounds = ", ".join(f"{axis} {low:g} to {high:g}" for axis, low, high in corners)
    late = f"; a plan takes {limits.late_s:.3g} s, in which the hand follows the one before" if limits.late_s else ""
    kept = (
        ""
        if limits.free_n is None
        else f" It avoids pressing with more than {limits.free_n:g} N on table and fixed things unless the cost "
        "reads the hand's force or contact there."
    )
    wrist = (
        f" The wrist {FLANGE_TO_TOOL_M:.3f} m behind it stays within {cfg.reach_m:g} m of "
        f"{_vector(cfg.shoulder_m)}{_arm_text(cfg.shoulder_m) if limits.arm else ''}."
        if cfg.reach_m
        else ""
    )
    return (
        f"The planner compares {cfg.mppi.samples} futures of {limits.horizon_s:g} s in steps of {limits.step_s:g} s, "
        f"sees nothing beyond, and plans anew every {limits.replan_s:g} s{late}. The hand moves at most "
        f"{cfg.speed_m_s:g} m/s, turns {cfg.turn_rad_s:g} rad/s, has its target {100 * cfg.lead_m:g} cm ahead "
        f"at most, presses with {limits.press_n:g} N; fingers open at {cfg.opening_m_s:g} m/s. ee_pos stays within "
        f"{bounds} m.{wrist} It wanders by up to 1 cm about where a distance would be 0: let conditions allow 2. "
        f"At a face, half a finger keeps ee_pos 1 cm off: a distance to the face itself presses.{kept}"
    )


def _arm_text(shoulder_m: Sequence[float]) -> str:
    """Describe the arm whose shoulder this is: its base, and what bounds the hand beside its reach."""
    base = (*shoulder_m[:2], shoulder_m[2] - SHOULDER_UP_M)
    return f" (shoulder of a Panda based at {_vector(base)}, whose joint limits and links exclude more)"


def world_prompt(
    facts: SceneFacts | Mapping[str, Any], task: Task, schema: Schema, cfg: ThinkCfg, limits: PlannerLimits
) -> dict[str, Any]:
    """Return the placeholders that all questions about a plan share."""
    shown = {"task": facts["instruction"], "hand": "", "planner": "", "contact_strategy": cfg.strategy, "staged": False}
    if cfg.prompt == "paper":
        return {**shown, "scene": poses_text(facts), "interface": interface_text(schema)}
    goals = success_text(facts, task.success.hold_s, task.time_limit_s) if cfg.prompt == "full" else []
    return {
        **shown,
        "scene": "\n".join([scene_text(facts), *goals]),
        "hand": HAND,
        "planner": planner_text(limits),
        "interface": interface_text(schema, told_in_scene(facts)),
        "staged": cfg.strategy,
    }


def poses_text(facts: SceneFacts | Mapping[str, Any]) -> str:
    """Give poses and parameters alone, as the paper's prompts do (A.8); its objects have labels too (A.7)."""
    objects = facts["objects"]
    poses = {"hand": facts["hand"]["pose"]} | {name: item["pose"] for name, item in objects.items()}
    poses |= dict.fromkeys(_unseen(facts), "not seen yet")
    poses |= {name: item["position"] for name, item in facts["fixtures"].items()} | facts["places"]
    held = {
        name: {"label": item["label"], "mass_kg": item["mass_kg"], "friction": item["friction"]}
        for name, item in objects.items()
        if "mass_kg" in item
    }
    return (
        "Poses (world frame, metres, z up: x, y, z, then the quaternion w, x, y, z):\n"
        f"{json.dumps(poses)}\nPhysical parameters:\n{json.dumps(held)}"
    )


def scene_text(facts: SceneFacts | Mapping[str, Any]) -> str:
    """Describe the scene: axes, table, objects, fixtures, places, numbers, hand."""
    table, hand = facts["table"], facts["hand"]
    lines = [
        AXES,
        f"Table: x {_range(table['x'])}, y {_range(table['y'])} (corners self.table_min, self.table_max).",
        "Objects (position and quaternion (w, x, y, z) of its frame; extents along its axes; shape):",
        *(_object_line(name, item) for name, item in facts["objects"].items()),
    ]
    if _unseen(facts):
        names = _unseen(facts)
        where = ", ".join(name + _area(facts["objects"][name]) for name in names)
        lines.append(
            f"Not seen yet, its pose a guess: {where}. Costs and conditions that read it wait until a "
            f"picture shows it (self.{names[0]}_seen): first uncover it."
        )
    if _lost(facts):
        lines.append(f"Out of sight now, its pose the last one seen: {', '.join(_lost(facts))}.")
    if facts["fixtures"]:
        lines.append("Fixed things (centre; full extents):")
        lines += [
            f"- self.{name}_pos = {_vector(item['position'])}; self.{name}_size = {_vector(item['size_m'])}"
            + (f"; turned about z by {item['yaw_deg']:g} deg" if item["yaw_deg"] else "")
            for name, item in facts["fixtures"].items()
        ]
    if facts["places"]:
        lines.append(
            "Places: " + "; ".join(f"self.{name}_pos = {_vector(at)}" for name, at in facts["places"].items()) + "."
        )
    if facts["numbers"]:
        lines.append(
            "Numbers: " + "; ".join(f"self.{name} = {value:g}" for name, value in facts["numbers"].items()) + "."
        )
    palm, opening = (_vector(np.round(column_of(hand["pose"][3:], axis), 2).tolist()) for axis in (2, 1))
    lines.append(
        f"Hand now: at {_vector(hand['pose'][:3])}, turned {_vector(hand['pose'][3:])}: its z axis along {palm}, its y "
        f"axis along {opening}; open by {hand['opening_m']:g} m."
    )
    return "\n".join(lines)


def success_text(facts: SceneFacts | Mapping[str, Any], hold_s: float, time_limit_s: float) -> list[str]:
    """Describe the conditions of success, a line each."""
    lines = [f"Success, within {time_limit_s:g} s: all of these at once, for {hold_s:g} s:"]
    told: set[str] = set()
    before: Mapping[str, Any] = {}
    for number, goal in enumerate(facts["goals"], 1):
        if {**goal, "object": ""} == {**before, "object": ""}:
            lines.append(f"{number}. The same of {goal['object']}.")
            continue
        lines.append(f"{number}. {condition_text(goal, brief=goal['kind'] in told)}")
        before = goal
        told.add(goal["kind"])
        for inner in _inner_conditions(goal):
            if inner["kind"] not in told:
                lines.append(f"   {inner['kind']}: {_meaning(inner)}")
                told.add(inner["kind"])
    return lines


def _unseen(facts: SceneFacts | Mapping[str, Any]) -> list[str]:
    return [name for name, item in facts["objects"].items() if item.get("unseen")]


def _lost(facts: SceneFacts | Mapping[str, Any]) -> list[str]:
    return [name for name, item in facts["objects"].items() if item.get("lost")]


def _area(item: ObjectFacts | Mapping[str, Any]) -> str:
    """Tell from where to where an object may be, as far as that is known."""
    area = item.get("somewhere")
    return f" (somewhere in x {_range(area['x'])}, y {_range(area['y'])})" if area else ""


def told_in_scene(facts: SceneFacts | Mapping[str, Any]) -> set[str]:
    """Return the names that a cost may use and `scene_text` tells with their values, or that have an only value."""
    fixed = {f"{name}_{what}" for name in facts["fixtures"] for what in ("pos", "size")}
    seen = {f"{name}_seen" for name in facts["objects"]} if not _unseen(facts) + _lost(facts) else set()
    return {"table_min", "table_max"} | seen | fixed | {f"{name}_pos" for name in facts["places"]} | {*facts["numbers"]}


def condition_text(goal: Mapping[str, Any], brief: bool = False) -> str:
    """Describe a condition of success: its kind, all its values, and what it asks for."""
    values = ", ".join(f"{key} {_value(value)}" for key, value in goal.items() if key != "kind" and value is not None)
    return f"{goal['kind']} ({values}): {'' if brief else _meaning(goal)}".rstrip(": ")


def _meaning(goal: Mapping[str, Any]) -> str:
    """Return what a kind of condition asks for, without what is said of the fields that are not set."""
    kinds = {cls.model_fields["kind"].default: cls for cls in BaseCondition.__subclasses__()}
    kind = kinds.get(goal["kind"])
    text = "" if kind is None else re.sub(r"\s+", " ", kind.__doc__ or "").strip()
    sentences = re.split(r"(?<=\.) (?=[A-Z`])", text)
    return " ".join(one for one in sentences if not _is_about_unset(one, goal))


def _is_about_unset(sentence: str, goal: Mapping[str, Any]) -> bool:
    about = re.match(r"With `(\w+)`", sentence)
    return about is not None and goal.get(about[1]) is None


def _inner_conditions(goal: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Return the conditions that are values of a condition, at any depth."""

    def found(value: Any) -> list[Mapping[str, Any]]:
        if isinstance(value, Mapping):
            return [value, *_inner_conditions(value)]
        return [one for item in value for one in found(item)] if isinstance(value, list | tuple) else []

    return [one for key, value in goal.items() if key != "kind" for one in found(value)]


def _object_line(name: str, item: ObjectFacts | Mapping[str, Any]) -> str:
    label = f' "{item["label"]}"' if item["label"] != name else ""
    parts = [
        f"- {name}{label}: at {_vector(item['pose'][:3])}, turned {_vector(item['pose'][3:])}",
        _vector(item["size_m"]),
        " and ".join(item["shapes"])
        + ("" if item["solid_share"] == 1 else f", {item['solid_share']:g} of its bounding box"),
    ]
    if "middle_m" in item:
        parts.append(f"centre of the box at {_vector(item['middle_m'])} in its frame")
    if "mass_kg" in item:
        parts.append(f"believed mass {_number(item['mass_kg'])} kg, friction {_number(item['friction'])}")
    if "joint" in item:
        parts.append(_joint_text(item["joint"]))
    if len(item["parts"]) > 1 or (item["parts"] and _differs(item)):
        parts += [f"part {_vector(part['size_m'])} at {_vector(part['position'])}" for part in item["parts"]]
    parts += [f"its {point} at {_vector(at)} in its frame" for point, at in item["points"].items()]
    return "; ".join(parts)


def _joint_text(joint: Mapping[str, Any]) -> str:
    unit, force = ("deg", "N m") if joint["kind"] == "hinge" else ("m", "N")
    now, friction = _number(joint["now"]), _number(joint["friction"])
    return (
        f"on a {joint['kind']} along {_vector(joint['axis'])} through {_vector(joint['point'])} in its frame, from "
        f"{_range(joint['range'])} {unit}, now at {now}, friction {friction} {force}"
    )


def _differs(item: ObjectFacts | Mapping[str, Any]) -> bool:
    """Check whether an object's only part is not simply its bounding box."""
    (part,) = item["parts"]
    return list(part["size_m"]) != list(item["size_m"]) or any(part["position"])


def _range(ends: Sequence[float]) -> str:
    return f"{_number(ends[0])} to {_number(ends[1])}"


def _value(value: Any) -> str:
    if isinstance(value, float):
        return _number(value)
    if isinstance(value, Mapping):
        return condition_text(value, brief=True)
    return _vector(value) if isinstance(value, list | tuple) else str(value)


def _vector(values: Sequence[Any]) -> str:
    return "[" + ", ".join(_component(value) if isinstance(value, float) else _value(value) for value in values) + "]"


def _component(value: float) -> str:
    """Show a component to the third decimal (a millimetre), and a small one, such as a thickness, to two digits."""
    return f"{round(value, 3) + 0.0:.10g}" if abs(value) >= 0.01 else f"{float(f'{round(value, 4):.2g}') + 0.0:.10g}"


def _number(value: float) -> str:
    """Show a number to the third decimal, and a small one to three digits."""
    return f"{round(value, 3) + 0.0:.10g}" if abs(value) >= 0.1 else f"{float(f'{value:.3g}') + 0.0:.10g}"
