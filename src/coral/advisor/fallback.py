"""The fallback policy: what decides if the advisor does not; chosen per run or campaign, the same in both systems."""

from __future__ import annotations

from typing import Literal

Fallback = Literal["rules", "hold", "fail"]
"""rules: the application's own rules decide in the advisor's place. hold: nobody does; a reef mission keeps its last
goal and asks again at its next trigger, a contact episode ends and says so. fail: the run ends, and its `end_reason`
says that the advisor failed."""

FOR_RUNS: Fallback = "rules"
"""Of a single run, which is to go on; its headline and its last line say how much the rules decided."""
FOR_BENCHES: Fallback = "hold"
"""Of a campaign: its rows are named after advisors, so that no one else may decide in them. Not `fail`, which would
turn one slow reply into the end of a mission: with `hold` an advisor that decides nine times of ten loses a tenth, and
one that never decides covers what it sees from its first goal."""


def failed(failure: str) -> str:
    """Return the end reason of a run under `fail`.

    Args:
        failure: Of the decision, as `consult` names it.
    """
    return f"advisor failed: {failure}"
