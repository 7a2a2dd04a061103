import asyncio
import gc

import pytest
from written_facts import brick, written

from coral.advisor.consult import BudgetCfg
from coral.advisor.latency import LatencyCfg
from coral.advisor.question import AdvisorUnavailable, Picture, Rejection, Reply, Usage
from coral.advisor.rules import RuleAdvisor
from coral.contact.thinker.asker import Asker, EpisodeOver
from coral.contact.thinker.thinking_clock import ThinkingClock
from coral.contact.world_model.parameter_estimates import ParameterEstimates, belief_prompt

FACTS = written({"brick": brick()})
LIGHT = Rejection(code="density", reason="lighter than air")


class Scripted:
    """Estimates these masses one after the other, and minds what it is asked."""

    name = "scripted"

    def __init__(self, *masses, usage=None):
        self.masses, self.usage = list(masses), usage or Usage()
        self.questions, self.reasons, self.closed = [], [], False

    async def answer(self, question, rejections):
        self.questions.append(question)
        self.reasons.append([rejection.reason for rejection in rejections])
        one = {"mass_kg": self.masses.pop(0), "friction_coeff": 0.5}
        return Reply(value=ParameterEstimates.model_validate({"brick": one}), raw="", usage=self.usage)

    async def aclose(self):
        self.closed = True


def ask(asker, **more):
    """The outcome of a question about masses, of which those below 1 kg are refused."""

    def verify(answer):
        return LIGHT if answer.root["brick"].mass_kg < 1.0 else None

    return asker.ask("physical-parameters", ParameterEstimates, FACTS, belief_prompt(FACTS), verify, **more)


@pytest.fixture
def made():
    """Makes askers and closes them."""
    askers = []

    def make(advisor, **more):
        askers.append(Asker(advisor, **more))
        return askers[-1]

    yield make
    for one in askers:
        one.close()


def test_a_refused_answer_is_asked_for_again_with_the_reason(made):
    advisor, heard = Scripted(0.1, 2.0), []
    asker = made(advisor, log=heard.append)
    outcome = ask(asker)
    assert outcome.answer.root["brick"].mass_kg == 2.0
    assert [attempt.verdict for attempt in heard] == ["rejected", "accepted"]
    assert advisor.reasons == [[], ["lighter than air"]]
    assert asker.calls == 2


def test_an_advisor_without_the_rule_fails_by_name(made):
    assert ask(made(RuleAdvisor({}))).failure == "no-rule"


def test_no_more_attempts_are_made_than_the_budget_allows(made):
    asker = made(Scripted(0.1, 0.2, 0.3), budget=BudgetCfg(max_requeries=1))
    outcome = ask(asker)
    assert (outcome.answer, outcome.failure, asker.calls) == (None, "requeries-used-up", 2)


def test_every_attempt_is_reported_with_its_verdict_and_cost(made):
    told = []
    asker = made(
        Scripted(0.1, 2.0, 2.0, usage=Usage(input_tokens=7, output_tokens=3, cost_usd=0.5, faults=("http-429",)))
    )
    asker.emit = lambda event, **fields: told.append((event, fields))
    ask(asker)
    ask(asker)
    assert {event for event, _ in told} == {"verdict"}
    assert [(one["decision"], one["attempt"], one["verdict"], one["code"]) for _, one in told] == [
        (0, 0, "rejected", "density"),
        (0, 1, "accepted", ""),
        (1, 0, "accepted", ""),
    ]
    first = told[0][1]
    assert (first["tokens_in"], first["tokens_out"], first["cost_usd"], first["faults"]) == (7, 3, 0.5, ["http-429"])


def test_a_picture_is_taken_only_for_a_question_that_wants_one(made):
    before, now = (Picture(name=name, png=b"") for name in ("before", "now"))
    advisor = Scripted(2.0, 2.0)
    asker = made(advisor, pictures=lambda labels: (now,))
    ask(asker, pictures=(before,))
    ask(asker, pictures=(before,), with_picture=True)
    assert [question.pictures for question in advisor.questions] == [(before,), (before, now)]


class Episode:
    """An episode that ends after so many seconds of thinking."""

    def __init__(self, ends_s, fault=None):
        self.clock_s, self.ends_s, self.fault = 0.0, ends_s, fault

    def go_on(self, seconds):
        if self.fault is not None:
            raise self.fault
        self.clock_s += seconds
        return self.clock_s < self.ends_s


def thinking(episode):
    return ThinkingClock(LatencyCfg(kind="fixed", median_s=4.0), None, episode)


def test_an_answer_to_an_episode_that_has_ended_is_no_answer(made):
    with pytest.raises(EpisodeOver, match="physical-parameters"):
        ask(made(Scripted(2.0), clock=thinking(Episode(ends_s=1.0))))


def test_while_the_advisor_thinks_the_episode_goes_on(made):
    episode, told = Episode(ends_s=99.0), []
    asker = made(Scripted(0.1, 2.0), clock=thinking(episode))
    asker.emit = lambda event, **fields: told.append(fields["thinking_s"])
    ask(asker)
    assert episode.clock_s == 8.0
    assert told == [4.0, 4.0]


def test_a_fault_of_the_episode_is_raised_as_it_is(made):
    with pytest.raises(ZeroDivisionError):
        ask(made(Scripted(2.0), clock=thinking(Episode(99.0, ZeroDivisionError()))))


def test_an_advisor_is_closed_once_it_has_been_asked_and_only_then():
    asked, unasked = Scripted(2.0), Scripted()
    for advisor in (asked, unasked):
        asker = Asker(advisor)
        if advisor is asked:
            ask(asker)
        asker.close()
        asker.close()
    assert (asked.closed, unasked.closed) == (True, False)


class Recorded:
    name, source = "recorded", "recording"

    async def answer(self, question, rejections):
        raise AdvisorUnavailable("used-up", "nothing is left", final=True)


def test_ctrl_c_while_the_advisor_thinks_leaves_no_task_behind(made, caplog):
    class Interrupted(Scripted):
        async def answer(self, question, rejections):
            asyncio.get_running_loop().call_soon(ctrl_c)
            await asyncio.Future()

    def ctrl_c():
        raise KeyboardInterrupt

    asker = made(Interrupted())
    with pytest.raises(KeyboardInterrupt):
        ask(asker)
    asker.close()
    del asker
    gc.collect()
    assert "Task was destroyed" not in caplog.text


def test_its_answers_belong_to_whom_the_advisor_says(made):
    assert made(Scripted()).source == "advisor"
    assert made(Recorded()).source == "recording"
