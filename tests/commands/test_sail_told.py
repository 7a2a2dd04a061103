from types import SimpleNamespace

import pytest

from coral.commands.sail_told import TOLD, lines, survey_told


@pytest.mark.parametrize(
    ("event", "said"),
    [
        ({"event": "state", "state": "holding", "reason": "pose stale"}, "holding: pose stale"),
        ({"event": "awaited", "ends_when": "continues only on your word"}, "continues only on your word"),
        ({"event": "limit", "reason": "leak", "action": "surface"}, "limit: leak; surface"),
        ({"event": "recording_stopped", "reason": "disk full"}, "the vehicle has not: disk full"),
        ({"event": "order_refused", "order": "hold", "reason": "busy"}, "refused hold: busy"),
        ({"event": "alignment", "status": "proposed"}, "Use it?"),
        ({"event": "alignment", "status": "used"}, "continues with the saved map"),
        ({"event": "alignment", "status": "unaligned", "reason": "ambiguous"}, "without the saved map: ambiguous"),
        ({"event": "alignment", "status": "none yet", "reason": "too little"}, "yet: too little"),
    ],
)
def test_each_event_has_its_words(event, said):
    assert event["event"] in TOLD
    assert said in "\n".join(lines({"t": 65.0, **event}, asked="5 of 5 bodies. Use it?"))


def test_surveying_has_nothing_to_await():
    assert lines({"t": 1.0, "event": "awaited", "ends_when": ""}) == []


def test_what_happens_is_said_and_the_rest_is_not():
    said, shown, mission = [], [], SimpleNamespace(record=SimpleNamespace(listeners=[]), alignment=None)
    with survey_told(mission, said.append, shown.append):
        for event in ({"event": "state", "t": 3.0, "state": "holding", "reason": "x"}, {"event": "goal", "t": 3.0}):
            mission.record.listeners[0](event)
    assert [line.partition(" ")[2] for line in said] == ["holding: x"]
    assert shown == [{"event": "state", "t": 3.0, "state": "holding", "reason": "x"}]
