"""The fallback policy of a reef mission if the advisor does not decide; chosen per run or campaign."""

from __future__ import annotations

from typing import Literal

Fallback = Literal["rules", "hold", "fail"]
"""rules: the application's own rules decide instead. hold: nothing decides; the mission keeps its last goal and asks
again at its next trigger. fail: the run ends, and its `end_reason` names the advisor's failure."""

FOR_RUNS: Fallback = "rules"
"""Default of a single run, which should continue; its headline and its last line report the rules' share."""
FOR_BENCHES: Fallback = "hold"
"""Default of a campaign: its rows are named after advisors, so nothing else may decide in them. Not `fail`, which
would turn one slow reply into the end of a mission: with `hold`, an advisor that decides nine times of ten loses a
tenth, and one that never decides covers only what it sees from its first goal."""


def failed(failure: str) -> str:
    """Return the end reason of a run under `fail`, for a failure of the decision as named by `consult`."""
    return f"advisor failed: {failure}"
