"""Questions without an acceptable choice, late refusals and overtaken goals, counted from events."""

from typing import Any

from coral.reef.pilot.timeliness import DEFINITIONS, timeliness_of


def test_a_question_is_unanswerable_only_if_no_choice_would_pass() -> None:
    events = [{"event": "question", "acceptable": count} for count in (0, 1, 3, 0)]
    assert timeliness_of([*events, {"event": "question"}])["unanswerable"] == 2


def test_only_refusals_for_obstacles_are_late() -> None:
    def verdict(what: str, code: str = "") -> dict[str, Any]:
        return {"event": "verdict", "verdict": what, "code": code}

    events = [verdict("accepted"), verdict("rejected", "regret"), verdict("rejected", "visited")]
    assert timeliness_of(events)["refused_late"] == 0
    assert timeliness_of([*events, verdict("rejected", "blocked")])["refused_late"] == 1


def test_a_goal_seen_meanwhile_is_overtaken() -> None:
    assert timeliness_of([{"event": "goal"}, {"event": "goal", "overtaken": True}])["overtaken"] == 1


def test_every_count_is_defined() -> None:
    assert timeliness_of([]) == dict.fromkeys(DEFINITIONS, 0)
