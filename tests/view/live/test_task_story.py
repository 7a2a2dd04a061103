"""What a viewer reads of a contact episode."""

from coral.view.live.story import Story
from coral.view.live.task_story import told_of_task


def story(*events):
    found = Story()
    for k, event in enumerate(events):
        found = told_of_task(found, {"t": float(k), "step": k, **event})
    return found


def test_stages_diagnoses_and_interventions_are_told():
    told = story(
        {"event": "stage", "stage": "reach"},
        {"event": "stuck", "stage": "reach", "text": "the hand never touched the object"},
        {"event": "weight", "stage": "reach", "term": "off", "factor": 2.0},
        {"event": "plan", "stage": "reach"},
        {"event": "end", "reason": "timeout", "detail": "not held: at of box"},
    )
    assert told.state == "reach"
    assert told.ended == "timeout"
    assert [line.partition(" ")[2] for line in told.log] == [
        "ended: timeout (not held: at of box)",
        "operator: 2.0 × “off” in “reach”",
        "stuck in “reach”: the hand never touched the object",
        "stage “reach”",
    ]


def test_answers_are_counted_with_what_was_asked():
    told = story({"event": "verdict", "kind": "cost-function", "verdict": "refused", "code": "unreachable"})
    assert (told.calls, told.log[0]) == (1, "0:00 refused: the plan (unreachable)")


def test_what_lies_on_the_table_is_no_news():
    assert not story({"event": "contact", "first": "box", "second": "table", "t": 1.0, "step": 3}).log
    assert "box touches left" in story({"event": "contact", "first": "box", "second": "left", "t": 1, "step": 3}).log[0]
