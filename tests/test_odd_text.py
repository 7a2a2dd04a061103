"""Text from models, files and file names that no file, terminal or font takes as it is."""

import json

from hypothesis import given
from hypothesis import strategies as st

from coral.advisor.parse import parse_answer
from coral.desk.inbox import Inbox
from coral.odd_text import encodable, encodable_values, printable
from coral.reef.decide.answers import WaypointChoice

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


def test_an_answer_holds_only_what_can_be_written():
    text = '{"forward_m": 2, "left_m": 0, "reason": "on\\ud800ward"}'
    assert parse_answer(text, WaypointChoice).reason == "on\ufffdward"
    assert parse_answer(text.replace("\\ud800", "\ud800"), WaypointChoice).reason == "on\ufffdward"


def test_the_desk_takes_any_text(tmp_path):
    folder = tmp_path / "inbox" / "000001-pick"
    folder.mkdir(parents=True)
    (folder / "question.json").write_text(json.dumps({"answer_schema": {"type": "object"}, "kind": ODD}))
    inbox = Inbox(tmp_path / "inbox")
    inbox.answer("000001-pick", {"reason": ODD}, ODD)
    assert json.loads((folder / "answer.json").read_text(encoding="utf-8"))["reason"].startswith("a\ufffdb")
    assert [entry.state for entry in inbox.entries()] == ["sent"]
