"""End reasons of episodes."""

from __future__ import annotations

END_REASONS = {
    "success": "all of the task's conditions held long enough",
    "timeout": "the task's time was up",
    "dropped": "an object fell off the table",
    "tunnelling": "an object went through the table or a fixture: the simulation is not to be believed",
    "diverged": "the evaluation world's simulation diverged",
    "unreachable": "the robot's arm cannot go on",
    "camera-off": "the camera gives no pictures",
    "tracker-failed": "what follows the objects in the pictures does not answer, or with no poses",
    "not-found": "an object could not be found in the first pictures",
    "no-strategy": "nobody found a way to what is asked",
    "no-decision": "the advisor did not decide, and its fallback policy lets nothing else decide",
    "advisor failed": "the advisor did not decide, and the run was to end then",
    "cost-error": "the strategy's cost could not be evaluated",
    "no-plan": "no rehearsal could be used for many plans in a row, or the plan was no motion",
    "policy": "a served policy gave no actions that could be taken",
    "stopped by the operator": "interrupted",
    "failed": "an error in the program",
}
"""Why an episode ends; after a colon may follow which object, or what was not decided."""
