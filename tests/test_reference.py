"""The reference names every file, event, key, column and code that a run has."""

import ast
import csv
import importlib
import json
import re
from pathlib import Path
from typing import get_args

import pytest

import coral
from coral.cli import COMMANDS
from coral.contact.franka.stream import StopCause
from coral.contact.franka.world import CODES as STOP_CODES
from coral.contact.tasks import load_task
from coral.reef.sea.operator import WORDS, Word
from coral.reef.sea.transport import FORMS, Medium
from coral.surface import load
from reference import texts

ROOT = Path(__file__).parents[1]
tables = importlib.import_module("tables")


def words(*names):
    """The words that tables show in backticks."""
    found = re.findall(r"`([^`]+)`", " ".join(tables.TABLES[name]() for name in names))
    return {word for cell in found for word in cell.split()}


def keys(text):
    return set(re.findall(r"`(\w+)`", text))


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A survey and a task, cut short, with all that their folders may hold but videos."""
    folder = tmp_path_factory.mktemp("runs")
    survey = coral.run_mission("s1", cfg={"time_limit_s": 3}, out=folder / "survey")
    task = coral.run_task(
        load_task("push-pick-board").model_copy(update={"time_limit_s": 0.5}),
        world="hand",
        cfg={"controller": {"horizon": 10}},
        samples=4,
        out=folder / "task",
    )
    return {"survey": survey.folder, "task": task.folder}


@pytest.mark.parametrize("kind", ["survey", "task"])
def test_every_file_of_a_run_has_a_row(runs, kind):
    named = words(f"files-{kind}")
    left = [str(path.relative_to(runs[kind])) for path in runs[kind].rglob("*") if path.is_file()]
    assert [name for name in left if name not in named and f"{name.split('/')[0]}/" not in named] == []
    assert len(left) > 9


@pytest.mark.parametrize(("kind", "events"), [("survey", texts.SURVEY_EVENTS), ("task", texts.TASK_EVENTS)])
def test_every_event_and_each_of_its_keys_has_a_row(runs, kind, events):
    lines = [json.loads(line) for line in (runs[kind] / "events.jsonl").read_text().splitlines()]
    objects = set(lines[0].get("trial", ()))
    always = {"step", "t", "event", "robot"}
    missing = {(line["event"], key) for line in lines for key in set(line) - keys(events[line["event"]]) - objects}
    assert {(event, key) for event, key in missing if key not in always} == set()


@pytest.mark.parametrize("kind", ["survey", "task"])
def test_every_metric_time_column_and_attempt_has_a_row(runs, kind):
    def of(name):
        return set(json.loads((runs[kind] / name).read_text()))

    assert of("metrics.json") <= words(f"metrics-{kind}")
    assert {re.sub("_(median|p99)$", "", key) for key in of("timing.json")} <= words("timing")
    attempts = [json.loads(line) for line in (runs[kind] / "attempts.jsonl").read_text().splitlines()]
    assert attempts
    assert set().union(*attempts) <= words("attempts")
    objects = re.compile("^board_")
    for path in [runs[kind] / "trajectory.csv", *runs[kind].glob("judge.csv"), *runs[kind].glob("frames/*.csv")]:
        columns = {objects.sub("OBJECT_", name) for name in next(csv.reader(path.open()))}
        assert columns <= words(f"columns-{kind}", f"files-{kind}")


@pytest.mark.parametrize(("room", "events"), [("reef", texts.SURVEY_EVENTS), ("contact", texts.TASK_EVENTS)])
def test_every_event_that_the_code_can_tell_has_a_row(room, events):
    """Those of a short run are few: read the calls that name one."""
    told = set()
    for path in (ROOT / "src/coral" / room).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            match node:
                case ast.Call(func=ast.Name(name) | ast.Attribute(attr=name), args=[ast.Constant(str(event)), *_]):
                    if name.endswith(("emit", "tell")):
                        told |= {(event, word.arg) for word in node.keywords if word.arg}
    assert len(told) > 50
    assert {(event, key) for event, key in told if key not in keys(events.get(event, ""))} == set()
    assert set(events) - {event for event, _ in told} <= {"contact", "contact_end", "track", "frame", "guess", "start"}


@pytest.mark.parametrize(
    ("room", "codes"),
    [
        ("advisor", texts.ADVISOR_CODES),
        ("reef/decide", texts.SURVEY_CODES),
        ("contact", texts.TASK_CODES | texts.POLICY_CODES),
    ],
)
def test_every_code_of_an_attempt_has_a_row(room, codes):
    told = set()
    for path in (ROOT / "src/coral" / room).rglob("*.py"):
        text = path.read_text("utf-8")
        told |= set(
            re.findall(r"(?:Rejection\(\s*code=|(?:BadAnswer|AdvisorUnavailable|PolicyError)\(\s*)\"([\w-]+)\"", text)
        )
        if path.stem in ("region_validation", "parse", "own_parts"):
            told |= set(re.findall(r'(?:return|(?:code|CODE|mend) =|name,)[\s(]*"([a-z-]+)"[,\n]', text))
    assert len(told) > 9
    assert told - set(codes) == set()


def test_every_topic_of_ros_has_a_row():
    text = "".join(path.read_text("utf-8") for path in (ROOT / "src/coral/reef/ros").glob("*.py"))
    told = set(re.findall(r'(?:"|parameter\()"?(coral/[\w/]+|odom|battery|cmd_vel|arm|diagnostics)"', text))
    assert told | {"coral/WORD"} == set(texts.VEHICLE_TOPICS)


@pytest.mark.parametrize(
    ("kinds", "rows"),
    [
        (get_args(Word), WORDS),
        (get_args(Medium), [form.split(":")[1] for form in FORMS]),
        (set(StopCause) - {StopCause.NONE}, STOP_CODES),
    ],
)
def test_every_value_of_a_kind_has_a_row(kinds, rows):
    assert set(kinds) == set(rows)


def test_every_command_that_fails_by_its_result_is_named_beside_the_exit_code():
    [failed] = [line for line in tables.TABLES["exit-codes"]().splitlines() if line.startswith("| `1`")]
    for name, (place, _) in COMMANDS.items():
        if hasattr(load(place), "exit_code"):
            assert f"`coral {name}" in failed
