import json
import shutil

import pytest

from coral.errors import InputError
from coral.view.live.stream import RunStream
from coral.view.live.task_subject import TaskSubject
from coral.view.run import RunFolder


@pytest.fixture
def subject(recorded_task):
    return TaskSubject(RunFolder.read(recorded_task))


def test_the_scene_has_the_hand_the_objects_and_what_is_fixed(subject):
    head = json.loads(json.dumps(subject.head, allow_nan=False))
    bodies = {solid["body"] for solid in head["solids"]}
    assert {"hand", "left", "right", "box"} <= bodies
    assert head["objects"] == ["box"]
    assert {solid["shape"] for solid in head["solids"]} <= {"box", "ball", "cylinder"}


def test_a_recorded_task_is_told_with_its_terms(recorded_task, subject):
    stream = RunStream(recorded_task, lambda: subject)
    news = stream.news(0, 0)
    stages = {moment["terms"]["stage"] for moment in news["moments"] if "terms" in moment}
    assert stages == {"reach"}
    assert news["moments"][-1]["ended"] == "timeout"
    row = dict(zip(subject.head["columns"], news["rows"][-1], strict=True))
    assert row["force"] == pytest.approx(sum(row[name] ** 2 for name in ("fx", "fy", "fz")) ** 0.5, abs=1e-3)
    assert row["box_qw"] is not None
    stream.close()


def test_events_become_lines(subject):
    told = subject.tell({"event": "verdict", "t": 1, "kind": "cost-function", "verdict": "rejected", "code": "slow"})
    assert told["line"] == "rejected: the cost (slow)"
    assert subject.tell({"event": "contact", "t": 1, "step": 2, "first": "box", "second": "table"}) is None
    assert (
        subject.tell({"event": "contact", "t": 1, "step": 2, "first": "left", "second": "box"})["line"]
        == "box touches left"
    )
    plan = {"event": "plan", "t": 2, "stage": "lift", "cost": 1.5, "ess": 3.0, "terms": {"up": 1.0, "odd": None}}
    assert subject.tell(plan)["terms"] == {"stage": "lift", "values": {"up": 1.0}}
    numbers = subject.tell({"event": "stage", "t": 3, "stage": "lift"})["numbers"]
    assert numbers[:3] == [["stage", "lift", ""], ["cost of the plan", "1.50", ""], ["effective samples", "3.0", ""]]


def test_a_folder_without_a_seed_is_refused_by_name(recorded_task, tmp_path):
    folder = shutil.copytree(recorded_task, tmp_path / "run")
    (folder / "config.yaml").write_text("world: hand\n")
    with pytest.raises(InputError, match="seed"):
        TaskSubject(RunFolder.read(folder))
