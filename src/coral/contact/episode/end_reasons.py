"""End reasons of episodes."""

from __future__ import annotations

END_REASONS = {
    "success": "all of the task's conditions held long enough",
    "timeout": "the task's time limit was reached",
    "dropped": "an object fell off the table",
    "broken": "a condition of success was broken that can never hold again",
    "tunnelling": "an object went through the table or a fixture: the simulation cannot be trusted",
    "diverged": "the evaluation world's simulation diverged",
    "unreachable": "the arm stays away from its commanded pose although it touches nothing",
    "camera-off": "poses come from a camera, and no picture arrived for half a second",
    "tracker-failed": "the server of the tracker does not answer, or gives no poses",
    "not-found": "poses come from a camera, and no object was found within the first second",
    "limit": "the arm was stopped at a limit: joint, speed, workspace, self-collision or contact force",
    "poses-lost": "the arm was stopped because an object was not seen any more",
    "link-lost": "the arm was stopped because no state came from it",
    "watchdog": "the arm was stopped because the program showed no sign of life",
    "arm-fault": "the arm refused to obey",
    "no-strategy": "no answer of the advisor contained a usable plan",
    "no-decision": "the advisor did not decide, and nothing else could or was allowed to",
    "advisor failed": "the advisor did not decide, and the fallback policy ends the run",
    "cost-error": "the cost could not be evaluated, and no repair was left or none helped",
    "no-plan": "25 plans in a row had no usable rollout, or a plan contained a value that is not a number",
    "policy": "a served policy gave no valid actions",
    "operator-failure": "the operator judges, and said that the task had failed",
    "stopped by the operator": "Ctrl-C or the stop button; of another signal its name: `stopped by SIGTERM`",
    "failed": "an error in the program",
    "killed": "the program was killed, or still runs",
}
"""Explanation of each end reason of an episode. A reason may be followed by a colon and what or why."""
