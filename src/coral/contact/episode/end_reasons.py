"""End reasons of episodes."""

from __future__ import annotations

END_REASONS = {
    "success": "all of the task's conditions held long enough",
    "timeout": "the task's time limit was reached",
    "dropped": "an object fell off the table",
    "broken": "a condition of success was broken that can never hold again",
    "tunnelling": "an object went through the table or a fixture: the simulation is invalid",
    "diverged": "the evaluation world's simulation diverged",
    "unreachable": "the robot's arm cannot reach its commanded pose",
    "camera-off": "the camera gives no pictures",
    "tracker-failed": "the tracker does not answer, or gives no poses",
    "not-found": "an object could not be found in the first pictures",
    "limit": "the arm was stopped at a limit: joint, speed, workspace, self-collision or contact force",
    "poses-lost": "the arm was stopped because an object was not seen any more",
    "link-lost": "the arm was stopped because no state came from it",
    "watchdog": "the arm was stopped because the program showed no sign of life",
    "arm-fault": "the arm refused to obey",
    "no-strategy": "no answer of the advisor contained a usable plan",
    "no-decision": "the advisor did not decide, and its fallback policy lets nothing else decide",
    "advisor failed": "the advisor did not decide, and the fallback policy ends the run",
    "cost-error": "the strategy's cost could not be evaluated",
    "no-plan": "many plans in a row had no valid rollout, or a plan was not finite",
    "policy": "a served policy gave no valid actions",
    "operator-failure": "the operator said that the task had failed",
    "stopped by the operator": "interrupted",
    "failed": "an error in the program",
}
"""Explanation of each end reason of an episode. A reason may be followed by a colon and the object or the decision."""
