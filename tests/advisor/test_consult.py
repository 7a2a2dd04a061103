import numpy as np
import pytest
from pydantic import BaseModel, Field

from coral.advisor.clock import SimulatedClock
from coral.advisor.consult import BudgetCfg, consult
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Rejection, Reply, Usage


class Pick(BaseModel):
    index: int


class Scripted:
    name = "scripted"

    def __init__(self, *replies):
        self.replies, self.asked = list(replies), []

    async def answer(self, question, rejections):
        self.asked.append((question.prompt, [r.code for r in rejections]))
        reply = self.replies.pop(0)
        if isinstance(reply, BaseException):
            raise reply
        return Reply(value=Pick(index=reply), raw=f"<{reply}>", usage=Usage(input_tokens=reply))


@pytest.fixture
def decide():
    """Runs one decision; the world is a list of prompts, one per look at it."""
    clocks = []

    def run(advisor, *, latency="1", verify=lambda q, a: None, world=None, **budget):
        clock = SimulatedClock(latency, np.random.default_rng(0))
        clocks.append(clock)
        looks, log = [], []

        def observe(rejections):
            looks.append([r.code for r in rejections])
            if world is not None and len(looks) > len(world):
                return None
            prompt = f"look {len(looks)}" if world is None else world[len(looks) - 1]
            return Question(kind="pick", prompt=prompt, answer_type=Pick, facts={})

        task = clock.start(consult(advisor, observe, verify, BudgetCfg(**budget), clock, log.append, decision=4))
        tick = 0
        while not task.done():
            tick += 1
            clock.advance(tick * 0.1)
        return task.result(), log, clock

    yield run
    for clock in clocks:
        clock.close()


def no(code):
    return lambda question, answer: Rejection(code=code, reason=f"{answer.index} is {code}")


def test_accepted_at_once(decide):
    outcome, log, _ = decide(Scripted(3))
    assert (outcome.answer, outcome.attempts, outcome.failure, outcome.rejections) == (Pick(index=3), 1, "", ())
    (attempt,) = log
    assert (attempt.decision, attempt.attempt, attempt.verdict, attempt.raw) == (4, 0, "accepted", "<3>")
    assert attempt.answer == {"index": 3}
    assert attempt.usage.input_tokens == 3


def test_every_requery_looks_again_and_tells_all_reasons(decide):
    advisor = Scripted(1, 2, 3)
    outcome, log, clock = decide(advisor, verify=lambda q, a: None if a.index == 3 else no(f"not-{a.index}")(q, a))
    assert advisor.asked == [("look 1", []), ("look 2", ["not-1"]), ("look 3", ["not-1", "not-2"])]
    assert outcome.question.prompt == "look 3"
    assert [attempt.question.asked_at_s for attempt in log] == [attempt.asked_at_s for attempt in log]
    assert log[2].asked_at_s > log[0].asked_at_s
    assert [r.code for r in outcome.rejections] == ["not-1", "not-2"]
    assert clock.now() == pytest.approx(3.0)
    assert [a.attempt for a in log] == [0, 1, 2]


@pytest.mark.parametrize("requeries", [0, 2])
def test_requeries_run_out(decide, requeries):
    outcome, log, _ = decide(Scripted(1, 1, 1, 1), verify=no("low"), max_requeries=requeries)
    assert (outcome.answer, outcome.failure, outcome.attempts) == (None, "requeries-used-up", requeries + 1)
    assert len(log) == len(outcome.rejections) == requeries + 1


def test_deadline_holds_over_all_attempts(decide):
    outcome, log, clock = decide(Scripted(1, 1, 1), latency="4", verify=no("low"), deadline_s=10.0)
    assert outcome.failure == "deadline"
    assert clock.now() == pytest.approx(10.0)
    assert [(a.verdict, a.rejection.code) for a in log] == [
        ("rejected", "low"),
        ("rejected", "low"),
        ("unavailable", "deadline"),
    ]


def test_deadline_may_fall_on_a_reply(decide):
    outcome, log, _ = decide(Scripted(1, 1), latency="5", verify=no("low"), deadline_s=5.0)
    assert [(a.verdict, a.rejection.code) for a in log] == [("rejected", "low"), ("unavailable", "deadline")]
    assert outcome.attempts == 2


def test_world_that_needs_no_answer_any_more(decide):
    outcome, log, _ = decide(Scripted(1), verify=no("low"), world=["only look"])
    assert (outcome.failure, outcome.question, outcome.attempts) == ("withdrawn", None, 1)
    assert len(log) == 1


def test_malformed_answers_are_fed_back_and_absence_is_not(decide):
    advisor = Scripted(AdvisorUnavailable("http-500", "down"), BadAnswer("empty", "nothing", "", Usage(requests=2)), 5)
    outcome, log, _ = decide(advisor)
    assert [asked[1] for asked in advisor.asked] == [[], [], ["empty"]]
    assert outcome.answer == Pick(index=5)
    assert [(a.verdict, a.usage.requests) for a in log] == [("unavailable", 0), ("malformed", 2), ("accepted", 1)]


def test_final_absence_ends_the_decision(decide):
    outcome, log, _ = decide(Scripted(AdvisorUnavailable("budget", "used up", final=True)))
    assert (outcome.failure, outcome.attempts, log[0].final) == ("budget", 1, True)


def test_fault_in_an_advisor_costs_its_answer_only(decide):
    outcome, log, _ = decide(Scripted(KeyError("centroids"), 2))
    assert outcome.answer == Pick(index=2)
    assert (log[0].verdict, log[0].rejection.code) == ("unavailable", "advisor-error")
    assert "KeyError: 'centroids'" in log[0].rejection.reason


def test_fault_in_the_mission_is_not_hidden(decide):
    def broken(question, answer):
        raise KeyError("map")

    with pytest.raises(KeyError, match="map"):
        decide(Scripted(1), verify=broken)


def test_a_question_may_take_its_time_on_the_clock():
    clock, log = SimulatedClock("1", np.random.default_rng(0)), []

    async def observe(rejections):
        prompt = await clock.prepare(lambda: "prepared", 0.3)
        return Question(kind="pick", prompt=prompt, answer_type=Pick, facts={})

    task = clock.start(consult(Scripted(1), observe, lambda q, a: None, BudgetCfg(), clock, log.append))
    for tick in range(20):
        clock.advance(tick * 0.1)
    assert task.result().answer == Pick(index=1)
    assert (log[0].asked_at_s, log[0].answered_at_s) == pytest.approx((0.3, 1.3))
    clock.close()


def test_a_question_that_is_withdrawn_before_it_is_asked_ends_the_decision():
    clock = SimulatedClock("1", np.random.default_rng(0))

    async def observe(rejections):
        return await clock.prepare(lambda: None, 5.0)

    task = clock.start(consult(Scripted(1), observe, lambda q, a: None, BudgetCfg(), clock, lambda attempt: None))
    clock.withdraw()
    assert task.result().failure == "withdrawn"
    clock.close()


def test_no_part_of_a_reply_goes_on_with_a_key_in_it(decide, monkeypatch):
    monkeypatch.setenv("SOME_API_KEY", "swordfish1")

    class Told(BaseModel):
        text: str = Field(max_length=10)

    class Echo:
        name, replies = "echo", ["swordfish1", "swordfish1"]

        async def answer(self, question, rejections):
            if self.replies:
                raise BadAnswer("not-json", f"found {self.replies.pop()}", raw="swordfish1")
            return Reply(value=Told(text="swordfish1"), raw="swordfish1")

    seen = []
    outcome, log, _ = decide(Echo(), verify=lambda q, a: seen.append(a.text))
    assert (outcome.answer, seen) == (Told(text="***"), ["***"])
    assert "swordfish" not in repr(log) + repr(outcome)
    assert [a.verdict for a in log] == ["malformed", "malformed", "accepted"]
