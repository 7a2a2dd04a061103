"""Text from models, files and file names that no file, terminal or font takes as it is."""

import io
import json
from types import SimpleNamespace

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from coral.advisor.consult import Attempt
from coral.advisor.log import AttemptRecorder, attempt_to_json, prompt_digest
from coral.advisor.parse import parse_answer
from coral.advisor.question import Question, Usage
from coral.cli import main
from coral.commands.progress import MissionProgress
from coral.desk.inbox import Inbox
from coral.odd_text import encodable, encodable_values, printable
from coral.reef.answers import WaypointChoice
from coral.runs import RunWriter

ODD = "a\ud800b\x00\x1b[31m\u202e\uffff"
ANY = st.text(st.characters(codec=None, categories=None), max_size=30)


@given(ANY)
def test_encodable_text_can_be_encoded_and_other_text_stays(text):
    assert encodable(text).encode().decode() == encodable(text)
    if not any("\ud800" <= letter <= "\udfff" for letter in text):
        assert encodable(text) == text


def test_two_halves_that_were_parted_are_one_letter_again():
    assert encodable("\ud83d\ude00 \ude00") == "😀 \ufffd"


@given(ANY, st.integers(1, 40))
def test_printable_text_is_printable_and_short(text, longest):
    shown = printable(text, longest)
    assert shown.isprintable()
    assert len(shown) <= longest
    if text.isprintable() and len(text) <= longest:
        assert shown == text


def test_values_are_made_encodable_all_through():
    found = encodable_values({"\ud800": ["\udfff", {"x": ("\ud800", 1, None, True, 0.5)}]})
    assert found == {"\ufffd": ["\ufffd", {"x": ["\ufffd", 1, None, True, 0.5]}]}


def test_a_run_folder_takes_any_text(tmp_path):
    writer = RunWriter(tmp_path / "run", ("step", "name"))
    writer.event(0, 0.0, "verdict", reason=ODD, answer={ODD: [ODD]})
    writer.row(0, ODD.replace("\ud800", "\udcff"))
    writer.yaml("config.yaml", {"world": ODD})
    writer.json("metrics.json", {"end_reason": ODD})
    writer.text("report.html", ODD)
    writer.close()
    for name in ("events.jsonl", "metrics.json"):
        told = (tmp_path / "run" / name).read_text(encoding="utf-8")
        assert "\\ud800" not in told
        assert json.loads(told)
    assert (
        "\ufffd" in yaml.load((tmp_path / "run" / "config.yaml").read_text(encoding="utf-8"), yaml.CSafeLoader)["world"]
    )
    assert (tmp_path / "run" / "report.html").read_text(encoding="utf-8") == ODD.replace("\ud800", "\ufffd")


def test_an_answer_holds_only_what_can_be_written():
    text = '{"forward_m": 2, "left_m": 0, "reason": "on\\ud800ward"}'
    assert parse_answer(text, WaypointChoice).reason == "on\ufffdward"
    assert parse_answer(text.replace("\\ud800", "\ud800"), WaypointChoice).reason == "on\ufffdward"


def test_an_attempt_is_logged_whatever_it_says(tmp_path):
    question = Question(kind="reef-waypoint", prompt=ODD, answer_type=WaypointChoice, facts={ODD: ODD})
    attempt = Attempt(
        decision=0,
        attempt=0,
        question=question,
        asked_at_s=0.0,
        answered_at_s=1.0,
        verdict="accepted",
        answer={"reason": ODD},
        raw=ODD,
        usage=Usage(),
    )
    recorder = AttemptRecorder(tmp_path / "run")
    recorder(attempt)
    recorder.close()
    told = (tmp_path / "run" / "attempts.jsonl").read_text(encoding="utf-8")
    assert "\\ud800" not in told
    assert json.loads(told)["raw"] == ODD.replace("\ud800", "\ufffd")
    assert attempt_to_json(attempt)["prompt_digest"] == prompt_digest(ODD)


def test_the_desk_takes_any_text(tmp_path):
    folder = tmp_path / "inbox" / "000001-pick"
    folder.mkdir(parents=True)
    (folder / "question.json").write_text(json.dumps({"answer_schema": {"type": "object"}, "kind": ODD}))
    inbox = Inbox(tmp_path / "inbox")
    inbox.answer("000001-pick", {"reason": ODD}, ODD)
    assert json.loads((folder / "answer.json").read_text(encoding="utf-8"))["reason"].startswith("a\ufffdb")
    assert [entry.state for entry in inbox.entries()] == ["sent"]


@pytest.mark.parametrize("name", ["a\udcffb", "a\x1b[31mb"])
def test_messages_are_printable(capsys, name):
    assert main(["reef", "run", f"{name}.yaml"]) == 2
    told = capsys.readouterr().err
    assert told.rstrip("\n").isprintable()
    assert told.isascii() or "\ufffd" in told


def test_names_are_no_markup_of_the_progress_bar(tmp_path):
    """A world may be named after a tag, which the bar would otherwise take for its own."""

    class Running:
        step, t, end_reason, coverage, collisions, calls = 0, 0.0, "", 0.0, 0, 0
        world = SimpleNamespace(name="[/bold]\x1b[2J")
        cfg = SimpleNamespace(time_limit_s=1.0)

    progress = MissionProgress()
    progress._bar.console.file, progress._bar.console.width = io.StringIO(), 200
    progress.tick(Running())
    progress.close()
    assert "[/bold]\ufffd[2J" in progress._bar.console.file.getvalue()
