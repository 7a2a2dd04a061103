"""What the tests of the skills share: a table with bricks on it, and the terms of a stage in a given state."""

import numpy as np

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostProgram
from coral.contact.rules.scene_reading import Draft, SkillAdjustment, Thing
from coral.contact.scene.task import Task

AS_IS = SkillAdjustment()


def bricks(*bricks, **more):
    """A task with bricks on the table.

    Args:
        bricks: Of each its name, size (m) and place (x, y).
        more: Further fields of the task.
    """
    return Task.model_validate(
        {
            "name": "new",
            "title": "New",
            "instruction": "Do it.",
            "time_limit_s": 20,
            "objects": [
                {"name": name, "parts": [{"size": list(size)}], "mass_kg": 0.2, "friction": 0.5, "x": x, "y": y}
                for name, size, (x, y) in bricks
            ],
            "places": {"there": [0.1, 0.15, 0.0]},
            "success": {"conditions": [{"kind": "released", "object": bricks[0][0]}]},
            **more,
        }
    )


class Skill:
    """Stages of one skill, evaluated in states that differ from the present one in some quantities."""

    def __init__(self, one, add, *args, name="brick", adjustment=AS_IS):
        self.one, self.draft, self.thing = one, Draft(), Thing(name, one.facts)
        add(self.draft, self.thing, one.facts, *args, adjustment)
        present = one.world.present(one.now)
        self.now = {key: present.source(key) for key in present.names()}  # clearances follow a changed state

    @property
    def regions(self):
        return [region for _, region in self.draft.regions]

    def stage(self, name):
        return next(stage for stage in self.draft.stages if stage.name == name)

    def terms(self, name, **changed):
        """The terms of a stage's cost."""
        program = CostProgram(self.stage(name).code, self.one.world.schema, name)
        return {key: float(np.asarray(value).flat[0]) for key, value in program(self._state(changed)).items()}

    def done(self, name, **changed):
        """Whether a stage counts as done."""
        code = f"def state_cost(self):\n    return 1.0 * ({self.stage(name).done})"
        (value,) = CostProgram(code, self.one.world.schema, name)(self._state(changed)).values()
        return bool(np.asarray(value).flat[0])

    def _state(self, changed):
        values = {key: np.asarray(value, dtype=float).reshape(self.now[key].shape) for key, value in changed.items()}
        return Context({**self.now, **values}, (1, 1))
