"""What `events.jsonl` of a contact task holds: each event with its keys, which stand in backticks."""

from __future__ import annotations

_ASKED = "`decided` and `source`: what was decided, by whom; `attempts`, `failure` and the reasons of the `refused`"

EVENTS = {
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
    "recall": "A remembered plan was tried: `id`, `similarity`, `distance`, `embedder`, times `used` and `helped`, "
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
"""Every line also has `step` and `t` (simulated seconds). Beliefs and poses have a key for each object."""
