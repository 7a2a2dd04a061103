"""The scene in words and numbers, as prompts show it: everything that the rules read from a question's facts, and why.

A test walks the facts and finds each of their values here, so that the rules never know more than a model.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from coral.contact.control.hand_model import MAX_OPENING_M
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.cost.context import Schema
from coral.contact.scene.condition import BaseCondition
from coral.contact.scene.facts import ObjectFacts, SceneFacts
from coral.contact.scene.task import Task
from coral.contact.thinker.scene_facts import interface_text
from coral.contact.thinker.think_cfg import ThinkCfg

AXES = (
    "World frame: metres, z up, the table's top at z = 0. x points away from the robot, which stands at negative x, "
    "and y to its left: nearer means smaller x, left means larger y."
)
HAND = (
    f"The hand: two fingers, opening 0 to {MAX_OPENING_M:g} m. self.ee_pos lies between the fingertips, 8 mm "
    "before their ends; a finger is 2 cm wide, 1.2 cm thick (along the opening) and 4.5 cm long; the palm is 20 cm "
    "along the opening and 6 cm across, and begins 4 cm behind ee_pos. The hand's z axis points out of the palm, its "
    "y axis along the opening: palm down is quat_axis(self.ee_quat, 2) = (0, 0, -1)."
)


def planner_text(cfg: ControllerCfg, step_s: float) -> str:
    """Describe what the planner can do: horizon, speeds, workspace.

    Args:
        cfg: The controller.
        step_s: One control step.
    """
    low, high = cfg.workspace_low_m, cfg.workspace_high_m
    bounds = ", ".join(f"{axis} {a:g} to {b:g}" for axis, a, b in zip("xyz", low, high, strict=True))
    return (
        f"The planner looks {cfg.horizon * step_s:g} s ahead, in steps of {step_s:g} s, and plans anew every 0.04 s. "
        f"The hand moves at most {cfg.speed_m_s:g} m/s and turns {cfg.turn_rad_s:g} rad/s; its fingers open at "
        f"{cfg.opening_m_s:g} m/s. It stays within {bounds} m. It comes to rest 1 to 2 cm from where a distance "
        "would be 0: let conditions allow for that."
    )


def world_prompt(
    facts: SceneFacts | Mapping[str, Any], task: Task, schema: Schema, cfg: ThinkCfg, step_s: float
) -> dict[str, Any]:
    """Return the placeholders that all questions about a plan share.

    Args:
        facts: The scene as last observed.
        task: The task file.
        schema: The quantities of the state.
        cfg: Which parts of the method are enabled.
        step_s: One control step.
    """
    return {
        "task": facts["instruction"],
        "scene": scene_text(facts, task.success.hold_s, task.time_limit_s),
        "hand": HAND,
        "planner": planner_text(ControllerCfg(), step_s),
        "interface": interface_text(schema),
        "contact_strategy": cfg.strategy,
    }


def scene_text(facts: SceneFacts | Mapping[str, Any], hold_s: float, time_limit_s: float) -> str:
    """Describe the scene: axes, table, objects, fixtures, places, numbers, hand, conditions of success.

    Args:
        facts: The scene as last observed.
        hold_s: How long all conditions have to hold.
        time_limit_s: Time for the task.
    """
    table, hand = facts["table"], facts["hand"]
    lines = [
        AXES,
        f"Table: x {_range(table['x'])}, y {_range(table['y'])}.",
        "Objects (position and quaternion (w, x, y, z) of the object's frame, extents along its own axes):",
        *(_object_line(name, item) for name, item in facts["objects"].items()),
    ]
    if facts["fixtures"]:
        lines.append("Fixed things (centre, extents, turned about z):")
        lines += [
            f"- {name}: at {_vector(item['position'])}, {_vector(item['size_m'])}, {item['yaw_deg']:g} deg"
            for name, item in facts["fixtures"].items()
        ]
    if facts["places"]:
        lines.append("Places: " + "; ".join(f"{name} {_vector(at)}" for name, at in facts["places"].items()) + ".")
    if facts["numbers"]:
        lines.append(
            "Numbers: " + "; ".join(f"self.{name} = {value:g}" for name, value in facts["numbers"].items()) + "."
        )
    lines.append(
        f"Hand now: at {_vector(hand['pose'][:3])}, turned {_vector(hand['pose'][3:])}; widest opening "
        f"{hand['widest_opening_m']:g}."
    )
    lines.append(f"Success, within {time_limit_s:g} s: all of these at once, for {hold_s:g} s:")
    told: set[str] = set()
    for number, goal in enumerate(facts["goals"], 1):
        lines.append(f"{number}. {condition_text(goal, brief=goal['kind'] in told)}")
        told.add(goal["kind"])
    return "\n".join(lines)


def condition_text(goal: Mapping[str, Any], brief: bool = False) -> str:
    """Describe a condition of success: its kind, all its values, and what it asks for.

    Args:
        goal: The condition as facts have it.
        brief: Whether to leave out what its kind asks for.
    """
    values = ", ".join(f"{key} {_value(value)}" for key, value in goal.items() if key != "kind" and value is not None)
    kinds = {cls.model_fields["kind"].default: cls for cls in BaseCondition.__subclasses__()}
    kind = kinds.get(goal["kind"])
    meaning = "" if kind is None or brief else re.sub(r"\s+", " ", kind.__doc__ or "").strip()
    return f"{goal['kind']} ({values}): {meaning}".rstrip(": ")


def _object_line(name: str, item: ObjectFacts | Mapping[str, Any]) -> str:
    label = f' "{item["label"]}"' if item["label"] != name else ""
    parts = [
        f"- {name}{label}: at {_vector(item['pose'][:3])}, turned {_vector(item['pose'][3:])}",
        _vector(item["size_m"]),
        f"{' and '.join(item['shapes'])}, {item['solid_share']:g} of its bounding box",
    ]
    if "middle_m" in item:
        parts.append(f"centre of the box at {_vector(item['middle_m'])} in its frame")
    if "mass_kg" in item:
        parts.append(f"believed mass {item['mass_kg']:g} kg, friction {item['friction']:g}")
    if "joint" in item:
        parts.append(_joint_text(item["joint"]))
    if len(item["parts"]) > 1 or (item["parts"] and _differs(item)):
        parts += [f"part {_vector(part['size_m'])} at {_vector(part['position'])}" for part in item["parts"]]
    parts += [
        f"its {point} (self.{name}_{point}_pos) at {_vector(at)} in its frame" for point, at in item["points"].items()
    ]
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
    return "[" + ", ".join(_value(value) for value in values) + "]"


def _number(value: float) -> str:
    return f"{value:.10g}"
