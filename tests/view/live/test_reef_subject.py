import json

import pytest

from coral.reef.mission.metrics import OWN_MAP, TRUTH
from coral.view.live.reef_subject import COLUMNS, ReefSubject
from coral.view.run import RunFolder


@pytest.fixture
def subject(finished):
    return ReefSubject(RunFolder.read(finished))


def test_the_head_says_what_never_changes(subject):
    head = json.loads(json.dumps(subject.head, allow_nan=False))
    assert head["kind"] == "reef"
    assert head["title"] == "made-up <reef>"
    assert len(head["truth"]) > 0
    assert head["truth"][0][0] == head["truth"][0][-1]


def test_contacts_are_numbers_only_where_somebody_judges_them(subject):
    verdict = {"event": "verdict", "t": 3, "verdict": "accepted", "answer": {}}
    for judge, shown in ((TRUTH, True), (OWN_MAP, False)):
        subject.tell({"event": "start", "t": 0, "clusters_total": 3, "judged_by": judge})
        assert ("collisions" in [name for name, *_ in subject.tell(verdict)["numbers"]]) is shown


def test_events_become_lines_and_numbers(subject):
    subject.tell({"event": "start", "t": 0, "clusters_total": 3})
    assert subject.tell({"event": "trigger", "t": 1, "fired": True, "cause": "stuck"}) is None
    spots = [{"index": 2, "x": 1.0, "y": 3.0, "visited": True}]
    question = {
        "event": "question",
        "t": 2,
        "mode": "centroid",
        "attempt": 1,
        "centroids": spots,
        "pictures": ["ab", "/"],
    }
    asked = subject.tell(question)
    assert asked["asked"]["cause"] == "stuck"
    assert (asked["dots"], asked["pictures"]) == ([["2", 1.0, 3.0, True]], ["ab"])
    assert ["advisor calls", "1 (1 again)", ""] in asked["numbers"]
    answer = {"selected_centroid_index": 2, "reason": "near"}
    told = subject.tell({"event": "verdict", "t": 3, "verdict": "accepted", "answer": answer})
    assert told["asked"] is None
    assert told["answered"] == {"verdict": "accepted", "said": "centroid 2", "reason": "near", "at": 3}
    subject.tell({"event": "cluster_covered", "t": 4, "name": "c1"})
    hit = subject.tell({"event": "collision", "t": 5, "x": 0, "y": 0})
    assert ["collisions", "1", "bad"] in hit["numbers"]
    assert ["clusters", "1 of 3", ""] in hit["numbers"]
    assert subject.tell({"event": "state", "t": 6, "state": "holding", "reason": "blind"})["numbers"][-1][2] == "bad"
    assert subject.tell({"event": "goal", "t": 6, "source": "fallback"})["line"].endswith("the rules")
    assert subject.tell({"event": "goal", "t": 0, "source": "initial"})["line"] == "first goal, straight ahead"
    assert subject.tell({"event": "goal", "t": 6, "source": "advisor"}) is None
    assert subject.tell({"event": "end", "t": 7, "reason": "time limit"})["ended"] == "time limit"
    assert subject.tell({"event": "of another program", "t": 8}) is None


def test_the_robot_is_where_it_believes_it_is(subject):
    row = {"t": 1.0, "x": 5.0, "y": 5.0, "theta": 0.0, "est_x": 5.2, "est_y": 5.1, "est_theta": 0.1}
    assert subject.row(row)[: COLUMNS.index("goal_x")] == [1.0, 5.2, 5.1, 0.1]
    assert subject.row({**row, "est_x": float("nan")})[1] == 5.0


def test_a_mission_in_words_tells_its_instruction_and_its_marks(subject):
    told = subject.tell({"event": "instruction", "t": 0, "text": "Find the net.", "by": "page"})
    assert told["instruction"] == "Find the net."
    said = [{"dot": 1, "x": 4.0, "y": 5.0, "label": "net", "skip": False, "why": "meshes"}]
    assert subject.tell({"event": "goal", "t": 1, "source": "advisor", "said": said})["marks"] == [["net", 4.0, 5.0]]
    ended = subject.tell({"event": "held", "t": 2, "answer": "one net", "said": said})
    assert (ended["line"], ended["marks"]) == ("answered: one net", [["net", 4.0, 5.0]])
