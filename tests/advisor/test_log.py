import hashlib
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from pydantic import BaseModel

from coral.advisor.consult import Attempt
from coral.advisor.log import RAW_LIMIT, AttemptRecorder, attempt_to_json, plain_json, question_key
from coral.advisor.question import Picture, Question, Rejection, Usage

ODD = "a\ud800b\x00\x1b[31m\u202e\uffff"


class Pick(BaseModel):
    index: int
    reason: str = ""


class Other(BaseModel):
    number: int


MAP = Picture(name="map", png=b"png", caption="from above")
QUESTION = Question(
    kind="pick",
    prompt="which?",
    answer_type=Pick,
    facts={"bearing": np.float32(0.5), "path": math.inf},
    pictures=(MAP,),
)
ATTEMPT = Attempt(
    decision=3,
    attempt=1,
    question=QUESTION,
    asked_at_s=0.0,
    answered_at_s=1.0,
    verdict="rejected",
    answer={"index": 9},
    rejection=Rejection(code="low", reason="too low", details={"least": 2}),
    raw="9",
    usage=Usage(input_tokens=7, faults=("http-429",)),
)


def logged(folder, *attempts):
    recorder = AttemptRecorder(folder)
    for attempt in attempts:
        recorder(attempt)
    recorder.close()
    lines = (folder / "attempts.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line, parse_constant=pytest.fail) for line in lines]


def test_a_line_is_strict_json_and_complete(tmp_path):
    (line,) = logged(tmp_path, ATTEMPT)
    assert line["facts"] == {"bearing": 0.5, "path": None}
    assert line["usage"]["faults"] == ["http-429"]
    assert (line["verdict"], line["code"], line["reason"], line["details"]) == (
        "rejected",
        "low",
        "too low",
        {"least": 2},
    )
    assert line["captions"] == [["map", "from above"]]
    assert (tmp_path / "pictures" / f"{line['pictures'][0]}.png").read_bytes() == b"png"


def test_a_picture_is_written_once(tmp_path):
    recorder = AttemptRecorder(tmp_path)
    recorder(ATTEMPT)
    (written,) = (tmp_path / "pictures").iterdir()
    written.unlink()
    recorder(ATTEMPT)
    recorder.close()
    assert not written.exists()


def test_a_raw_reply_is_kept_up_to_its_limit(tmp_path):
    (line,) = logged(tmp_path, replace(ATTEMPT, raw="x" * (RAW_LIMIT + 1)))
    assert (len(line["raw"]), line["raw_chars"]) == (RAW_LIMIT, RAW_LIMIT + 1)


@pytest.mark.parametrize(
    ("changes", "same"),
    [
        ({"facts": {"bearing": 1.0}}, True),
        ({"prompt": "which one?"}, False),
        ({"answer_type": Other}, False),
        ({"pictures": (replace(MAP, caption="from below"),)}, True),
        ({"pictures": (replace(MAP, png=b"other"),)}, False),
        ({"asked_at_s": 9.0}, True),
    ],
)
def test_a_recording_knows_a_question_by_its_words_form_and_pictures(changes, same):
    assert (question_key(replace(QUESTION, **changes)) == question_key(QUESTION)) is same


def test_without_a_picture_facts_tell_one_question_from_another():
    blind = replace(QUESTION, pictures=())
    assert question_key(blind) != question_key(replace(blind, facts={"bearing": 1.0}))
    assert question_key(blind) == question_key(replace(blind, facts={"bearing": 0.5, "path": None}))


def test_numbers_of_numpy_become_plain_ones():
    value = {1: np.arange(3), "a": np.float64("nan"), "b": (np.int64(2), True, None)}
    assert plain_json(value) == '{"1": [0, 1, 2], "a": null, "b": [2, true, null]}'


def test_the_digest_of_a_schema_tells_types_apart():
    one, other = (question_key(replace(QUESTION, answer_type=kind))["schema"] for kind in (Pick, Other))
    assert one != other


def test_an_attempt_is_logged_whatever_it_says(tmp_path):
    question = Question(kind="pick", prompt=ODD, answer_type=Pick, facts={ODD: ODD})
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
    assert attempt_to_json(attempt)["prompt_digest"] == hashlib.sha256(ODD.encode("utf-8", "surrogatepass")).hexdigest()
