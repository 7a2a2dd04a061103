"""What the reference says of events, keys, codes and topics; `tests/test_reference.py` holds it against the code."""

from __future__ import annotations

SURVEY_EVENTS = {
    "start": "`world`, `advisor`, `variant`, `preset`, `seed`, `clusters_total`; `own_parts`: parts exchanged in "
    "Python. At sea also `judged_by`, `vehicle`, `camera`, `sonar` and `resumed`.",
    "instruction": "The words of a mission, at the start or changed under way: `text`, and `by` whom.",
    "question": "A question was asked: number of the `decision`, `attempt` (0: the first), `mode`, digests of its "
    "`pictures`, `centroids` of the chain.",
    "verdict": "An answer was judged: `decision`, `attempt`, `verdict`, `code` of a refusal, `tokens_in`, "
    "`tokens_out`, `cost_usd`, `faults` of a bad reply; `reason` of a refusal, the `answer`, and when it was "
    "`asked_at` (s).",
    "goal": "A goal was adopted: `x`, `y` (m); its `source` (an advisor or fallback, `initial`, `tour`, `home`), "
    "`decision`, `reason`; `index` of the cluster; `centroids`; `violates`: whether it goes back or off the trend "
    "(Eqs. 4-8); `waits`: goals before it; `then`: goals after it; `later_s`: what it costs; `expect`: what the "
    "advisor expects there; in a mission in words also the side it is to `look` from, and what was `said` of things.",
    "held": "A decision without a goal: `source`, `decision`, `reason`; in a mission in words also its `answer`, "
    "`said`, `look`, `violates`.",
    "fallback": "The advisor did not decide: `decision`, `failure`, and the `policy` that took over.",
    "guess": "What an advisor expected at `x`, `y` was checked: `what`, how `sure`, whether it was a `hit`.",
    "mode": "The `mode` of questions changed: centroids or free waypoints.",
    "trigger": "The smart trigger's verdict changed (Eq. 12): `cause`, `fired`, `held_by`.",
    "monitor": "The reference path was planned anew: `deviation_m`.",
    "planner_failure": "No rollout was feasible, and the vehicle brakes: `reason`.",
    "doubt": "The robot looks again at doubtful places before it ends: `look`.",
    "cluster_covered": "A true cluster was covered: `name`, `fraction` of its area.",
    "collision": "Contact with `obstacle` at `x`, `y` (m).",
    "state": "The vehicle's state changed: the new `state`, the old one (`was`), `cause`, `by` whom, `reason`.",
    "sensor": "An `input` of the pilot was `refused`, and why (empty: it is accepted again); `detail`.",
    "blind": "The sonar alone shows the way (`blind`), or no longer: `reason`.",
    "deaf": "The sonar is silent (`deaf`), or no longer: `reason`.",
    "sight": "How far the eyes tell oysters from sea floor, `reach_m`, by a network's doubt; nothing farther away "
    "counts as explored.",
    "awaited": "At sea, what ends a state: `state`, `reason`, `ends_when`.",
    "operator": "At sea, the operator said a `word`, from a `source` (keyboard, page, ROS).",
    "unwind": "At sea, the vehicle turns on the spot against `turns` of its tether.",
    "limit": "At sea, a limit was reached: `cause`, `reason`, and the `action` taken.",
    "vehicle_text": "At sea, a message of the autopilot: `severity`, `text`.",
    "late_tick": "At sea, a tick ended late: by `behind_ms`, of which it began `woken_ms` late and computed for "
    "`control_ms`.",
    "place": "At sea, whether a resumed survey has found itself on the saved map: its `landmarks`, those that were "
    "`recognised`, and what the odometry is off by: `x`, `y` (m), `theta` (rad).",
    "recording_stopped": "At sea, nothing more is recorded, for instance because the disk is full: `reason`.",
    "order": "At sea, the vehicle was given an `order`.",
    "order_refused": "At sea, the vehicle refused an `order`: `reason`.",
    "left": "At the end, `clusters` that were not finished, each with why; `centroids` of the chain.",
    "judged": "At the end, the truth: `clusters` with the share imaged and inspected, the robot's `tracks` and "
    "`phantoms` among them, time of a tour that knows the reef (`oracle_time_to_90_s`); in a mission in words "
    "`instruction` with its conditions.",
    "end": "The last line: `reason`.",
}
"""What `events.jsonl` of a survey holds: each event with its keys, which stand in backticks.

Every line also has `step` and `t` (simulated seconds).
"""
SURVEY_ENDS = {
    "nothing left to explore": "the robot finds no cluster and no open water that it could still reach, and no "
    "doubtful obstacle hides any",
    "the advisor ended the survey": "an answer said so, or declared a mission in words done",
    "coverage complete": "with `--cfg.stop-when-covered`: every true cluster has been covered, which only the "
    "experimenter knows",
    "the tour is done": "a blind sweep or the oracle reached the end of its path",
    "all lanes are done": "of the variant `lawnmower`",
    "time limit": "`--cfg.time-limit-s`, 600 by default",
    "advisor failed": "the advisor did not decide, with `--fallback fail`",
    "surfaced": "a sensor was silent for too long, or a limit sent the vehicle up; the simulated vehicle of `coral "
    "reef run` keeps its depth, so this ends its survey",
    "left to surface": "at sea, the same, and the ascent was not seen to end",
    "back at the start": "at sea, a limit or the operator sent the vehicle back",
    "disarmed by the operator": "at sea, the operator's word",
    "stopped by the operator": "Ctrl-C, the stop button, or at sea the operator's word; of another signal its name: "
    "`stopped by SIGTERM`",
    "failed": "an error in the program, which the command line shows",
}
"""Explanation of each end reason of a survey. A reason may be followed by a colon and why, or in brackets by whom."""
_ASKED = "`decided` and `source`: what was decided, by whom; `attempts`, `failure` and the reasons of the `refused`"
TASK_EVENTS = {
    "start": "`task`, `instruction`, `world`, `variant`, `advisor`, `seed`, `time_limit_s`, source of the `poses`, "
    "the `tracker`; `judged_by`, if not the truth; `trial`: true mass, friction and size of each object.",
    "verdict": "An answer was judged: `kind` of the question, `decision`, `attempt`, `verdict`, `code` of a refusal, "
    "`tokens_in`, `tokens_out`, `cost_usd`, `faults` of a bad reply; `thinking_s`.",
    "thinking": "Simulated `seconds` passed while the advisor thought, and what happened `meanwhile`.",
    "fallback": "The advisor did not decide `what` (`decided` says the same): why (`because`), the `policy`, and "
    "what stands in (`by`, `source`).",
    "poses": f"Poses guessed from a picture, by object; {_ASKED}.",
    "beliefs": f"Masses and frictions, by object; {_ASKED}.",
    "plan_answer": f"A plan or a repair (`kind`): its `code`, `explanation`, `advice` of the check; {_ASKED}.",
    "regions": f"Contact `regions`, by object and stage; {_ASKED}.",
    "candidates": "Points of `regions` that cannot be touched, and why.",
    "recall": "A remembered plan was tried: `id`, `similarity`, `distance`, times `used` and `helped`, "
    "`outcome` of the imagined run and its time (`rehearsed_s`), why it was `refused`; `decided`, `source`.",
    "recall_repair": "The remembered plan was stuck, and its remembered repair was tried: why it was `refused`, its "
    "`explanation`; `decided`, `source`.",
    "remembered": "The success was stored: `id`, `file`.",
    "strategy": "A strategy is followed: `name`, `stages`, `beliefs`.",
    "stage": "A `stage` begins: `index`, and the one `before`.",
    "plan": "The planner planned: `stage`, `cost` and its `terms`, effective sample size (`ess`), `diverged` "
    "rollouts, whether it is `ok`, where it leads the hand (`aim`), what is `touched`; `ahead_s`: how much "
    "later it begins.",
    "weight": "A person changed a cost's weight on the live page: `stage`, `term`, `factor`, `by`.",
    "policy": "A served policy was asked: `call`, actions in its `chunk`, the `actions` executed.",
    "contact": "A contact of `first` and `second` began: `force_n`, `point` (m).",
    "contact_end": "It ended: `first`, `second`, `begun_s`, `ended_s`, largest and mean force (`peak_n`, `mean_n`).",
    "track": "The tracker `lost` an `object` (`reason`, whether the hand `held` it), or found it `after_s`.",
    "stuck": "The outer loop found no progress: `attempts`, `stage`, `object`, `diagnosis` with its `text`, "
    "`evidence`, `cost`, `history`.",
    "correction": "Mass and friction of an `object` were replayed with the history: whether new ones were "
    "`accepted`, `text`, `errors` of both, values `before` and `after`; `decided`, `source`, `failure`, `refused`.",
    "cost_error": "A cost failed in use: `stage`, `code`, `reason`.",
    "end": "The last line: `reason`, `detail`, `advisor_calls`, `repairs`, `memory_hit`.",
}
"""What `events.jsonl` of a contact task holds: each event with its keys, which stand in backticks.

Every line also has `step` and `t` (simulated seconds). Beliefs and poses have a key for each object.
"""
ATTEMPT_KEYS = {
    "decision attempt": "number of the decision, and of the attempt at it (0: the first)",
    "asked_at_s answered_at_s": "when, on the clock of the run (s)",
    "kind prompt_version schema prompt_digest pictures facts_digest": "the identity of the question, by which a "
    "recording finds it; `pictures` are digests, the names of files in `pictures/`",
    "verdict": "`accepted`, `rejected` by a check, `malformed`, `unavailable` or `withdrawn`",
    "code reason details": "of a refusal",
    "final": "whether the decision ended with this attempt",
    "answer raw raw_chars": "the answer as parsed and as it came (at most 65,536 characters), and its whole length",
    "usage": "tokens, cost, requests, faults",
    "prompt captions facts": "what was asked: the text, names and captions of the pictures, and the facts as numbers",
}
"""Keys of a line of attempts.jsonl."""
QUESTION_KEYS = {
    "id kind": "the folder's name, and which template made the question",
    "prompt prompt_version": "what a model would read",
    "answer_schema": "JSON schema of the answer",
    "images captions": "file names in the same folder, and what they show",
    "picture_frames": "for a picture that is a map: `pixel_from_world`, two rows A with (column, row) = A (x, y, 1), "
    "metres",
    "facts": "what the pictures show, as numbers",
    "rejections": "why earlier answers to this decision were rejected: `code`, `reason`, `details`",
    "asked_at asker": "Unix time, and the process that waits",
}
"""Keys of question.json."""
ADVISOR_CODES = {
    "empty": "The reply was empty.",
    "not-json": "The reply holds no JSON object.",
    "missing-field": "A field is missing in the answer.",
    "wrong-type": "A field has the wrong type.",
    "out-of-range": "A field is out of its range, or none of the choices.",
    "invalid": "The answer does not fit its format otherwise, or it held a key of this environment.",
    "cut-off": "The reply broke off; if it happens often, raise `max_output_tokens` or let the model think less.",
    "refusal": "The model declined.",
    "too-large": "The reply had more bytes than are read.",
    "too-long": "The reply had more characters than are read.",
    "bad-reply": "The reply did not follow the API.",
    "not-yours": "`answer.json` at the desk belongs to another user.",
    "timeout": "No reply in time.",
    "connection": "The server was not reached, or the connection broke.",
    "http-STATUS": "The server answered with an error; 408, 409, 425, 429 and 500 or more are tried again.",
    "key-refused": "The key was refused; not tried again.",
    "no-such-model": "There is no such model; not tried again.",
    "budget": "The budget of the run is used up; not tried again.",
    "deadline": "The time for the whole decision was up.",
    "wall-timeout": "The simulated world waited ten minutes.",
    "client-error": "The client library failed.",
    "advisor-error": "The advisor's own program failed.",
    "no-rule": "The rules have none for this question.",
    "not-recorded": "The recording has no answer to this question.",
    "silence": "A simulated or recorded silence.",
    "desk": "The inbox cannot be written.",
    "closed": "The run ended.",
}
"""Why an attempt gave no answer: the codes of attempts.jsonl that no verifier gave."""
SURVEY_CODES = {
    "blocked": "The point lies in an obstacle, or obstacles cut it off.",
    "outside": "The point lies outside the survey area.",
    "no-such-centroid": "There is no such dot on the map.",
    "visited": "The dot is done.",
    "finished": "Within 3 m of the point everything is known and done, and nothing that is left is nearer from there.",
    "too-dear": "To look where something is expected costs more than is allowed.",
    "too-close": "The point is where the robot will be, or at the last goal.",
    "contradiction": "The answer contradicts itself.",
    "not-done": "The survey cannot end, or be left to the robot, while dots are left.",
    "behind-robot": "`paper`: the point is behind the robot.",
    "behind-previous": "`paper`: the point leads back from the previous goal.",
    "deviation": "`paper`: the point deviates from the trend of the chain.",
    "own": "A verifier of your own refuses it.",
}
"""Why a verifier of a survey refuses an answer."""
TASK_CODES = {
    "objects": "An object is missing, unknown, or named twice.",
    "bounds": "A mass or friction is outside its bounds.",
    "density": "No material has this mass in this size.",
    "replay": "Replayed with these values, the history is explained no better.",
    "stages": "Stages where one function is asked for.",
    "imagined-run": "A remembered plan fails in its imagined run.",
    "none": "There is no region.",
    "too-many": "There are too many regions on an object.",
    "not-finite": "A region holds a value that is not a finite number.",
    "normal": "The normal of a region has not length 1.",
    "extent": "A region is too small or too large.",
    "stage": "The plan has no stage of this name.",
    "opening": "The fingers do not open so far.",
    "off-surface": "A region is off the object's surface.",
    "inward": "The normal points into the object.",
    "underside": "The normal points down at the table.",
    "too-wide": "The object is too wide there for the fingers.",
    "below-table": "A region lies below the table's top.",
    "missed": "No point of a region meets the object.",
    "out-of-reach": "The hand reaches no point of a region.",
    "buried": "Something is in the way of every point of a region.",
    "pose": "A pose holds something that is no number.",
    "place": "An object would be off the table.",
}
"""Why an answer about a task is refused, besides the errors of a cost."""
POLICY_CODES = {
    "unreachable": "No connection.",
    "silence": "No answer within `--cfg.policy.client.answer-s` (90 s; a server may compile at its first question).",
    "closed": "The server closed the connection.",
    "error": "The server sent an error message instead of actions.",
    "too-large": "A message of more than `most-bytes` (4 MiB).",
    "bad-message": "Not MessagePack, or an array that is not plain numbers.",
    "bad-actions": "No actions, or not n × 7.",
    "not-finite": "Actions with a value that is not a finite number.",
}
"""Why a policy failed."""
VEHICLE_TOPICS = {
    "odom": (
        "nav_msgs/Odometry",
        "Read: x east, y north, z up, z = 0 at the surface; twist in the body's frame (REP-103).",
    ),
    "battery": ("sensor_msgs/BatteryState", "Read; optional."),
    "cmd_vel": ("geometry_msgs/Twist", "10 Hz: forward, up (to hold the depth), yaw rate."),
    "arm": ("std_srvs/SetBool", "Called if it exists."),
    "coral/map": ("nav_msgs/OccupancyGrid", "Latched: free 0, oysters 50, obstacle 100, unexplored −1."),
    "coral/path": ("nav_msgs/Path", "In the survey's own frame, `map`, as the next two."),
    "coral/oysters": ("visualization_msgs/MarkerArray", "The clusters."),
    "coral/goal": ("geometry_msgs/PoseStamped", "The goal at hand."),
    "coral/events": ("std_msgs/String", "Each event of the run as JSON, decisions included."),
    "coral/instruction": ("std_msgs/String", "Latched, of a mission in words: its instruction, as it is now."),
    "coral/instruct": ("std_msgs/String", "Read: another instruction; `coral/events` tells a refusal."),
    "diagnostics": ("diagnostic_msgs/DiagnosticArray", "The state and its reason, late ticks."),
    "coral/WORD": (
        "std_srvs/Trigger",
        "The operator's commands: `start`, `hold`, `resume`, `home`, `surface`, `stop`, `disarm`.",
    ),
}
"""Topics and services of a vehicle over ROS 2, in its namespace: type of each, and what is on it."""
TIMING = {
    "wall_time_s": "Wall time of the run (s).",
    "realtime_factor": "Simulated time over wall time.",
    "control_ms": "Time of the controller in a tick of a survey (ms): `_median` and `_p99`, as of the others below.",
    "tick_ms": "Time of the whole tick.",
    "picture_age_ms": "Age of the camera's picture at sea.",
    "plan_ms": "Time of a plan of the hand, or of an answer of a served policy.",
    "pictures_ms": "Time to draw the pictures for a served policy.",
}
"""Keys of timing.json."""
PRODUCTS = {
    "recording": "Name of the run or recording.",
    "lens": "How the lens disagrees with the pictures, if it does.",
    "keyframes": "Number of its pictures.",
    "oyster_area_m2 oyster_area_low_m2 oyster_area_high_m2": "Area of oysters, null if not judged; its interval.",
    "not_judged pictures_unlike": "Why nothing is judged, if so, and the number of pictures unlike those learned from.",
    "seen_m2": "Sea floor seen near enough.",
    "outlines outlines_low outlines_high": "Oysters that can be told apart from above, with the interval.",
    "oysters oysters_low oysters_high": "Number of oysters; null where too few lie apart, or not judged.",
    "oysters_per_m2 oysters_per_m2_low oysters_per_m2_high": "The same per sea floor seen.",
    "shell_length_mm shell_length_mm_low shell_length_mm_high": "Mean length of a shell.",
    "oyster_cells clusters": "Cells of the map with oysters, and clusters.",
    "colour perception calibrated_reefs": "Whether there are colours, what found the oysters, and on how many reefs "
    "its areas were calibrated.",
    "latitude longitude epsg": "The start on Earth, and the zone; null without `--datum`.",
}
"""Keys of products.json."""
