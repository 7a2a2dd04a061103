"""Names that a cost may read: quantities of the hand, of each object, and of fixed things."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Literal

from coral.contact.cost.context import Quantity, Schema

HAND: Schema = {
    "ee_pos": Quantity(3, "m", "point midway between the two fingertips"),
    "ee_quat": Quantity(
        4, "", "orientation of the hand: its z axis points out of the palm, its y axis along the opening"
    ),
    "ee_vel": Quantity(3, "m/s", "velocity of ee_pos"),
    "ee_angvel": Quantity(3, "rad/s", "angular velocity of the hand, world axes"),
    "gripper_opening": Quantity(0, "m", "distance between the finger pads, 0 to 0.08"),
    "gripper_target": Quantity(0, "m", "the commanded one"),
    "ee_force": Quantity(3, "N", "force that everything touched exerts on the hand, world axes"),
    "ee_torque": Quantity(3, "N m", "torque about ee_pos that everything touched exerts on the hand, world axes"),
    "ee_stage_pos": Quantity(3, "m", "ee_pos when the active stage began", constant=True),
    "time": Quantity(0, "s", "time since the episode began"),
    "stage_time": Quantity(0, "s", "time since the active stage began"),
    "current_step": Quantity(0, "", "control steps so far"),
    "last_action": Quantity(
        7, "", "commanded over this step: velocity (m/s), angular velocity (rad/s), opening speed (m/s)"
    ),
}


def object_quantities(
    name: str,
    points: Iterable[str] = (),
    fixtures: Iterable[str] = (),
    others: Iterable[str] = (),
    joint: Literal["", "hinge", "slide"] = "",
) -> dict[str, Quantity]:
    """Describe the quantities of one movable object, with named points such as `handle` on a board.

    It may touch the fixtures, such as `table` and `wall`, and the others; a joint may hold it.
    """
    found = {
        f"{name}_pos": Quantity(3, "m", f"origin of the {name}'s frame: its middle, unless its parts lie elsewhere"),
        f"{name}_quat": Quantity(4, "", f"orientation of the {name}"),
        f"{name}_vel": Quantity(3, "m/s", f"velocity of the {name}"),
        f"{name}_angvel": Quantity(3, "rad/s", f"angular velocity of the {name}, world axes"),
        f"{name}_init_pos": Quantity(3, "m", f"{name}_pos when the episode began", constant=True),
        f"{name}_init_quat": Quantity(4, "", f"{name}_quat when the episode began", constant=True),
        f"{name}_stage_pos": Quantity(3, "m", f"{name}_pos when the active stage began", constant=True),
        f"{name}_stage_quat": Quantity(4, "", f"{name}_quat when the active stage began", constant=True),
        f"{name}_size": Quantity(3, "m", f"full extents of the {name} along its own axes", constant=True),
        f"{name}_mass": Quantity(0, "kg", f"believed mass of the {name}", constant=True),
        f"{name}_friction": Quantity(0, "", f"believed friction coefficient of the {name}", constant=True),
        f"{name}_seen": Quantity(
            0, "", f"whether the {name} is seen: found, and not lost now", truth=True, constant=True
        ),
        **hand_quantities(name),
        f"{name}_left_contact": Quantity(0, "", f"whether the left finger touches the {name}", truth=True),
        f"{name}_right_contact": Quantity(0, "", f"whether the right finger touches the {name}", truth=True),
    }
    if joint:
        unit = "deg" if joint == "hinge" else "m"
        found[f"{name}_joint"] = Quantity(0, unit, f"where the {joint} of the {name} stands, as the task counts it")
    for point in points:
        found[f"{name}_{point}_pos"] = Quantity(3, "m", f"the {point} of the {name}")
    for thing in (*fixtures, *others):
        found[f"{name}_{thing}_contact"] = Quantity(0, "", f"whether the {name} touches the {thing}", truth=True)
    for thing in (*fixtures, *others):
        found[f"{name}_{thing}_clearance"] = Quantity(0, "m", f"shortest distance of the {name} and the {thing}")
    return found


def hand_quantities(name: str) -> dict[str, Quantity]:
    """Describe what the hand has to do with a thing: an object, a fixture, the table."""
    return {
        f"{name}_hand_force": Quantity(3, "N", f"net force of the hand on the {name}, world axes"),
        f"{name}_hand_contact": Quantity(0, "", f"whether the hand touches the {name}", truth=True),
        f"{name}_palm_contact": Quantity(0, "", f"whether the palm (or wrist) touches the {name}", truth=True),
        f"{name}_hand_clearance": Quantity(0, "m", f"shortest distance of fingers and palm to the {name}"),
    }


def scenery_quantities(
    fixtures: Iterable[str] = (), places: Iterable[str] = (), numbers: Iterable[str] = ()
) -> dict[str, Quantity]:
    """Describe the quantities of fixed things: table, fixtures, and the places and numbers of the task file."""
    found = {
        "table_min": Quantity(3, "m", "corner of the table with the smallest coordinates", constant=True),
        "table_max": Quantity(3, "m", "corner of the table with the largest coordinates", constant=True),
        **hand_quantities("table"),
    }
    for name in fixtures:
        found[f"{name}_pos"] = Quantity(3, "m", f"centre of the {name}", constant=True)
        found[f"{name}_size"] = Quantity(3, "m", f"full extents of the {name}", constant=True)
        found |= hand_quantities(name)
    for name in places:
        found[f"{name}_pos"] = Quantity(3, "m", f"the place {name} of the task", constant=True)
    for name in numbers:
        found[name] = Quantity(0, "", f"the number {name} of the task", constant=True)
    return found


def objects_of(names: Collection[str]) -> list[str]:
    """Return the movable objects among the names of quantities."""
    return [
        name.removesuffix("_quat")
        for name in names
        if name.endswith("_quat")
        and name != "ee_quat"
        and f"{name.removesuffix('_quat')}_pos" in names
        and not name.endswith(("_init_quat", "_stage_quat"))
    ]
