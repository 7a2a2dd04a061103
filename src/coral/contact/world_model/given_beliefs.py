"""Prior beliefs about mass and friction from the command line: `board=2,0.9;cup=0.2,0.4`."""

from __future__ import annotations

from coral.contact.scene.task import Task
from coral.contact.scene.trial import PhysicalParameters
from coral.contact.world_model.parameter_estimates import FRICTION, MASS_KG
from coral.errors import InputError, nearest

FORM = "NAME=MASS,FRICTION, more than one separated by semicolons"


def parse_beliefs(text: str, task: Task, where: str = "--believe") -> dict[str, PhysicalParameters]:
    """Parse the beliefs about a task's objects.

    Raises:
        InputError: The form is wrong, an object is unknown or repeated, or a value is out of bounds.
    """
    names = [item.name for item in task.objects]
    found: dict[str, PhysicalParameters] = {}
    for word in (part.strip() for part in text.split(";") if part.strip()):
        name, _, values = (part.strip() for part in word.partition("="))
        try:
            mass, friction = (float(value) for value in values.split(","))
        except ValueError:
            raise InputError(where, "", repr(word), FORM) from None
        if name not in names:
            raise InputError(
                where, "", repr(name), f"an object of {task.name}: {', '.join(names)}{nearest(name, names)}"
            )
        if name in found:
            raise InputError(where, "", f"{name!r} twice", "each object once")
        for what, value, (low, high) in (("mass (kg)", mass, MASS_KG), ("friction", friction, FRICTION)):
            if not low <= value <= high:
                raise InputError(where, f"{name}, {what}", value, f"a number from {low:g} to {high:g}")
        found[name] = PhysicalParameters(mass, friction)
    if not found:
        raise InputError(where, "", repr(text), FORM)
    return found
