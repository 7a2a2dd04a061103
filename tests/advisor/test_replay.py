import asyncio
import json
import math
import os

import numpy as np
import pytest
from pydantic import BaseModel, Field

from coral.advisor.attribution import source_of
from coral.advisor.clock import SimulatedClock
from coral.advisor.consult import BudgetCfg, consult
from coral.advisor.log import AttemptRecorder
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Picture, Question, Rejection, Reply, Usage
from coral.advisor.registry import make_advisor
from coral.advisor.replay import RecordedAdvisor, ReplayAdvisor
from coral.errors import InputError
from coral.reef.decide.heuristic import REEF_RULES


class Pick(BaseModel):
    index: int = Field(ge=0)


class Other(BaseModel):
    index: int


def question(prompt="which?", kind="pick", version="1", picture=b"png", answer_type=Pick):
    return Question(
        kind=kind,
        prompt=prompt,
        prompt_version=version,
        answer_type=answer_type,
        facts={"bearing": np.float32(0.5), "path": math.inf},
        pictures=(Picture(name="map", png=picture),),
    )


class Scripted:
    name = "scripted"

    def __init__(self, *replies):
        self.replies = list(replies)

    async def answer(self, question, rejections):
        reply = self.replies.pop(0)
        if isinstance(reply, Exception):
            raise reply
        return Reply(value=Pick(index=reply), raw=f"I say {reply}", usage=Usage(input_tokens=7, faults=("http-429",)))


def mission(advisor, latency, log, prompts):
    """Outcome and time of each decision, one after the other."""
    clock = SimulatedClock(latency, np.random.default_rng(3))
    told = []
    try:
        tick = 0
        for number, prompt in enumerate(prompts):
            task = clock.start(
                consult(
                    advisor,
                    lambda _, prompt=prompt: question(prompt),
                    lambda _, a: Rejection(code="low", reason="too low") if a.index < 2 else None,
                    BudgetCfg(max_requeries=2, deadline_s=30.0),
                    clock,
                    log,
                    number,
                )
            )
            while not task.done():
                tick += 1
                clock.advance(tick * 0.1)
                if number == 3 and tick * 0.1 > told[-1][0] + 1:
                    clock.withdraw()
            outcome = task.result()
            told.append((clock.now(), outcome.answer, outcome.failure, outcome.rejections, outcome.attempts))
    finally:
        clock.close()
    return told


SCRIPT = (
    5,
    1,
    BadAnswer("not-json", "prose", "raw text", Usage(requests=2)),
    4,
    AdvisorUnavailable("silence", "", latency_s=math.inf),
    6,
    AdvisorUnavailable("http-500", "down"),
    9,
    3,
)
PROMPTS = ("a", "a", "b", "c", "d", "a")


def test_replayed_mission_is_the_recorded_one(tmp_path):
    recorder = AttemptRecorder(tmp_path / "one")
    first = mission(Scripted(*SCRIPT), "lognormal:2:0.4", recorder, PROMPTS)
    recorder.close()
    second_recorder = AttemptRecorder(tmp_path / "two")
    second = mission(ReplayAdvisor(tmp_path / "one"), "recorded", second_recorder, PROMPTS)
    second_recorder.close()
    assert second == first
    assert [t[2] for t in first] == ["", "", "deadline", "withdrawn", "", ""]
    assert (tmp_path / "one/attempts.jsonl").read_text() == (tmp_path / "two/attempts.jsonl").read_text()
    assert len(list((tmp_path / "one/pictures").iterdir())) == 1


def test_attempt_that_was_too_late_to_ask_is_not_replayed(tmp_path):
    def run_all(advisor, latency, log):
        clock = SimulatedClock(latency, np.random.default_rng(0))
        answers = []
        try:
            tick = 0
            for deadline_s in (2.0, 9.0):
                task = clock.start(
                    consult(
                        advisor,
                        lambda _: question(),
                        lambda _, a: Rejection(code="low", reason="low") if a.index < 2 else None,
                        BudgetCfg(deadline_s=deadline_s),
                        clock,
                        log,
                    )
                )
                while not task.done():
                    tick += 1
                    clock.advance(tick * 0.1)
                answers.append((task.result().answer, task.result().failure, clock.now()))
        finally:
            clock.close()
        return answers

    recorder = AttemptRecorder(tmp_path)
    first = run_all(Scripted(1, 5), "2", recorder)
    recorder.close()
    assert [failure for _, failure, _ in first] == ["deadline", ""]
    assert run_all(ReplayAdvisor(tmp_path), "recorded", lambda _: None) == first


@pytest.fixture
def recording(tmp_path):
    recorder = AttemptRecorder(tmp_path)
    mission(Scripted(5, 6), "0", recorder, ("a", "a"))
    recorder.close()
    return tmp_path


async def _direct(advisor, asked):
    return await advisor.answer(asked, ())


def run(advisor, asked):
    return asyncio.run(_direct(advisor, asked))


def test_same_question_is_answered_in_order(recording):
    advisor = ReplayAdvisor(recording / "attempts.jsonl")
    assert [run(advisor, question("a")).value.index for _ in range(2)] == [5, 6]
    with pytest.raises(AdvisorUnavailable, match="asked more often") as gone:
        run(advisor, question("a"))
    assert (gone.value.code, gone.value.final) == ("not-recorded", True)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (question("z"), "differs in prompt$"),
        (question("a", picture=b"other"), "differs in pictures$"),
        (question("a", version="2"), r"differs in prompt version \(2 now, 1 recorded\)$"),
        (question("a", answer_type=Other), "differs in answer schema$"),
        (question("a", kind="place"), "no question of kind 'place' was recorded, only pick$"),
    ],
)
def test_unknown_question_is_explained(recording, asked, says):
    with pytest.raises(AdvisorUnavailable, match=says) as gone:
        run(ReplayAdvisor(recording), asked)
    assert gone.value.code == "not-recorded"


def test_recording_of_a_killed_run_is_read(recording):
    file = recording / "attempts.jsonl"
    file.write_text(file.read_text() + '{"kind": "pi')
    assert run(ReplayAdvisor(file), question("a")).value.index == 5


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"kind"\n{}\n', "line 1: found no JSON"),
        ("[1]\n", "line 1: found no "),
        ('{"kind": "pick"}\n', "line 1: found no answer, "),
    ],
)
def test_file_that_is_no_recording(tmp_path, text, says):
    (tmp_path / "attempts.jsonl").write_text(text)
    with pytest.raises(InputError, match=says):
        ReplayAdvisor(tmp_path)


ODD = ["x", 1, None, [1], {"a": 1}, [{}], 1e400, -1e300, 10**400, True, "\ud800", [[]]]


def test_odd_values_in_a_recording_are_one_line_or_an_answer(tmp_path):
    """Each field of a recorded attempt, each odd value in it: refused when it is read, or repeated without harm."""
    recorder = AttemptRecorder(tmp_path / "run")
    mission(Scripted(2), "fixed:1", recorder, ["one"])
    recorder.close()
    (line,) = (tmp_path / "run" / "attempts.jsonl").read_text().splitlines()
    entry = json.loads(line)
    spoilt = [{**entry, key: odd} for key in entry for odd in ODD]
    spoilt += [{**entry, "usage": {**entry["usage"], key: odd}} for key in (*entry["usage"], "more") for odd in ODD]
    spoilt += [{**entry, "verdict": verdict, "code": "x"} for verdict in ("malformed", "withdrawn", "unavailable", "?")]
    refused = 0
    for content in spoilt:
        file = tmp_path / "odd.jsonl"
        file.write_text(json.dumps(content) + "\n")
        try:
            advisor = ReplayAdvisor(file)
        except InputError:
            refused += 1
            continue
        try:
            asyncio.run(advisor.answer(question("one"), ()))
        except (AdvisorUnavailable, BadAnswer) as told:
            assert told.latency_s is None or told.latency_s >= 0  # noqa: PT017
    assert refused > 50


def test_a_pipe_is_no_recording(tmp_path):
    os.mkfifo(tmp_path / "pipe.jsonl")
    with pytest.raises(InputError, match="a named pipe"):
        ReplayAdvisor(tmp_path / "pipe.jsonl")


def line(kind, answer, verdict="accepted", code="", asked=0.0, answered=2.0):
    return {
        "kind": kind,
        "prompt_version": "1",
        "schema": "s",
        "pictures": ["of another question"],
        "facts_digest": "",
        "prompt_digest": "p",
        "asked_at_s": asked,
        "answered_at_s": answered,
        "verdict": verdict,
        "code": code,
        "reason": "as it was",
        "raw": json.dumps(answer),
        "answer": answer,
        "usage": {"input_tokens": 3},
        "final": False,
    }


@pytest.fixture
def kinds(tmp_path):
    lines = [
        line("pick", {"index": 1}, "rejected", "low"),
        line("place", {"index": 7}),
        line("pick", None, "withdrawn"),
        line("pick", None, "unavailable", "deadline"),
        line("pick", {"index": 2}),
        line("pick", None, "malformed", "not-json"),
        line("pick", {"other": 2}),
    ]
    path = tmp_path / "attempts.jsonl"
    path.write_text("".join(json.dumps(one) + "\n" for one in lines))
    return path


def ask_new(advisor, kind="pick"):
    question = Question(kind=kind, prompt="asked nowhere before", answer_type=Pick, facts={})

    async def one():
        return await advisor.answer(question, [Rejection(code="low", reason="too low")])

    return asyncio.run(one())


def test_answers_come_in_their_order_kind_by_kind_whatever_is_asked(kinds):
    advisor = ReplayAdvisor(kinds.parent, in_order=True)
    first = ask_new(advisor)
    assert (first.value.index, first.latency_s, first.usage.input_tokens) == (1, 2.0, 3)
    assert ask_new(advisor).value.index == 2  # what was withdrawn or too late is left out
    with pytest.raises(BadAnswer):
        ask_new(advisor)
    assert ask_new(advisor, "place").value.index == 7
    with pytest.raises(AdvisorUnavailable, match="no longer validates"):
        ask_new(advisor)
    with pytest.raises(AdvisorUnavailable, match="no answer to a pick question is left") as gone:
        ask_new(advisor)
    assert (gone.value.code, gone.value.final) == ("not-recorded", True)


def test_it_is_a_recording_and_says_which(kinds):
    advisor = make_advisor(f"in-order:{kinds}", rules={}, rng=np.random.default_rng(0))
    assert (advisor.name, source_of(advisor)) == (f"in-order:{kinds}", "recording")


def test_a_shipped_recording_goes_by_its_name_unless_a_file_has_it(tmp_path, monkeypatch, kinds):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(AdvisorUnavailable, match=r"recordings/reef-o2.jsonl: .* no longer validates"):
        ask_new(ReplayAdvisor("reef-o2", in_order=True), "reef-waypoint")
    (tmp_path / "reef-o2").write_bytes(kinds.read_bytes())
    assert ask_new(ReplayAdvisor("reef-o2", in_order=True)).value.index == 1


def test_a_name_that_nothing_has_is_refused_with_those_that_there_are():
    with pytest.raises(InputError, match=r"contact-flip-wall, .*reef-s1"):
        ReplayAdvisor("reef-o9")


class Anything(BaseModel):
    """Any answer."""

    model_config = {"extra": "allow"}


def ask(advisor, task, kind="cost-function", **facts):
    question = Question(kind=kind, prompt="?", answer_type=Anything, facts={"task": task, **facts})
    return asyncio.run(advisor.answer(question, ())).value.model_dump()


def test_each_task_gets_its_own_plan_once():
    advisor = RecordedAdvisor()
    assert ask(advisor, "pick-box")["stages"][0]["name"] == "above"
    assert ask(advisor, "flip-box") != ask(advisor, "flip-wall")
    with pytest.raises(AdvisorUnavailable, match="no answer to a cost-function question is left"):
        ask(advisor, "pick-box")


def test_answers_that_were_refused_then_are_left_out():
    assert ask(RecordedAdvisor(), "push-pick-board", "parameter-repair")
    with pytest.raises(AdvisorUnavailable):
        [ask(advisor, "push-pick-board", "parameter-repair") for advisor in [RecordedAdvisor()] for _ in range(2)]


def test_the_variants_unified_and_unguided_have_recordings_of_their_own():
    guided = ask(RecordedAdvisor(), "pick-box")
    unguided = RecordedAdvisor()
    assert ask(unguided, "pick-box", "physical-parameters") == ask(RecordedAdvisor(), "pick-box", "physical-parameters")
    assert ask(unguided, "pick-box", contact_strategy=False) != guided
    assert set(ask(RecordedAdvisor(), "pick-box", "unified")) >= {"parameters", "stages"}


def test_a_folder_of_the_name_of_a_recording_is_not_read(tmp_path, monkeypatch):
    (tmp_path / "contact-pick-box").mkdir()
    monkeypatch.chdir(tmp_path)
    assert ask(RecordedAdvisor(), "pick-box")["stages"]


def test_what_was_read_in_one_picture_answers_for_no_other():
    with pytest.raises(AdvisorUnavailable, match="this object-poses question was not recorded"):
        ask(RecordedAdvisor(), "pick-box", "object-poses")


@pytest.mark.parametrize(("task", "facts"), [("pull-cart", {}), ("open-door", {"contact_strategy": False})])
def test_what_nobody_answered_is_not_answered(task, facts):
    with pytest.raises(AdvisorUnavailable, match="nobody answered"):
        ask(RecordedAdvisor(), task, **facts)


def test_a_reef_has_no_recorded_advisor():
    with pytest.raises(InputError, match="in-order:reef-"):
        make_advisor("recorded", rules=REEF_RULES, rng=np.random.default_rng(0))
