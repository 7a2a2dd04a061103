"""An experience of a scene, for tests of the memory."""

from recorded import compose

from coral.contact.memory.goal_match import scene_numbers
from coral.contact.memory.memory import Experience


def experience(one, **provenance):
    made, numbers = compose(one.facts), scene_numbers(one.facts)
    return Experience(
        task="t",
        instruction=one.facts["instruction"],
        goals=one.facts["goals"],
        numbers=numbers,
        plan=made.plan,
        regions=made.regions,
        beliefs={"box": (0.2, 0.5)},
        provenance={"success": True, "world": "hand", "seed": 0, **provenance},
    )
