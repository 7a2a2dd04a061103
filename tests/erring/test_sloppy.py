import asyncio
from collections import Counter

import numpy as np
import pytest
from pydantic import BaseModel

from coral.advisor.attribution import source_of
from coral.advisor.latency import default_latency
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Reply
from coral.advisor.setting import Mistake
from coral.erring.sloppy import Rates, SloppyAdvisor, parse_rates


class Pick(BaseModel):
    index: int


class Right:
    """Says what the facts say."""

    name = "right"
    latency = "0"
    source = "recording"

    async def answer(self, question, rejections):
        value = Pick(index=question.facts["n"])
        return Reply(value=value, raw=value.model_dump_json())


def shift(by):
    return lambda question, right, earlier, rng: {"index": right["index"] + by}


def repeat(question, right, earlier, rng):
    old = [one for one in earlier if question.asked_at_s - one.at_s >= 10.0]
    return old[-1].answer if old else None


MISTAKES = (
    Mistake(name="up", what="", found_in="", questions=("pick",), err=shift(100)),
    Mistake(name="never", what="", found_in="", questions=("pick", "place"), err=lambda *_: None),
    Mistake(name="late", what="", found_in="", questions=("pick",), err=repeat),
    Mistake(name="down", what="", found_in="", questions=("place",), err=shift(-100)),
)


def ask(rates, n=1, kind="pick", seed=0, every_s=4.0):
    advisor = SloppyAdvisor(Right(), rates, np.random.default_rng(seed), MISTAKES)

    async def run():
        return [
            await advisor.answer(
                Question(kind=kind, prompt="", answer_type=Pick, facts={"n": k}, asked_at_s=every_s * k), ()
            )
            for k in range(n)
        ]

    return asyncio.run(run())


def test_rates_are_read_as_they_are_written():
    assert parse_rates("0.3", MISTAKES) == Rates(level=0.3)
    assert parse_rates("up=0.6+down=0.7", MISTAKES) == Rates(each={"up": 0.6, "down": 0.7})  # never of one question
    assert str(Rates(each={"up": 0.25, "down": 1.0})) == "up=0.25+down=1"


def test_a_level_is_met_over_the_mistakes_that_can_be_made():
    replies = ask(Rates(level=0.3), 3000, every_s=0.0)
    wrong = [reply for k, reply in enumerate(replies) if reply.value.index != k]
    assert len(wrong) / 3000 == pytest.approx(0.3, abs=0.03)
    assert Counter(fault for reply in replies for fault in reply.usage.faults) == {"sloppy-up": len(wrong)}
    assert ask(Rates(level=0.3), 50, every_s=0.0) == replies[:50]
    assert ask(Rates(level=0.3), 50, every_s=0.0, seed=1) != replies[:50]


def test_rates_by_kind_are_met_by_each():
    replies = ask(Rates(each={"up": 0.2, "late": 0.3}), 3000)
    made = Counter(fault for reply in replies for fault in reply.usage.faults)
    assert made["sloppy-up"] / 3000 == pytest.approx(0.2, abs=0.03)
    assert made["sloppy-late"] / 3000 == pytest.approx(0.3, abs=0.03)
    assert set(made) == {"sloppy-up", "sloppy-late"}


def test_an_answer_of_the_past_is_the_right_one_of_then():
    replies = ask(Rates(each={"late": 1.0}), 6)
    assert [reply.value.index for reply in replies] == [0, 1, 2, 0, 1, 2]
    assert [bool(reply.usage.faults) for reply in replies] == [False, False, False, True, True, True]


def test_a_mistake_stays_with_its_kinds_of_question_and_is_not_logged_when_it_is_none():
    assert [reply.value.index for reply in ask(Rates(each={"down": 1.0}), 2)] == [0, 1]
    (reply,) = ask(Rates(each={"down": 1.0}), kind="place")
    assert (reply.value.index, reply.usage.faults) == (-100, ("sloppy-down",))
    (reply,) = ask(Rates(each={"never": 1.0}))
    assert (reply.value.index, reply.usage.faults) == (0, ())


def test_it_is_still_its_inner_advisor():
    advisor = SloppyAdvisor(Right(), Rates(level=0.5), np.random.default_rng(0), MISTAKES)
    assert (advisor.name, str(default_latency(advisor)), source_of(advisor)) == (
        "sloppy:0.5:right",
        "fixed:0",
        "recording",
    )


class Both(BaseModel):
    left: int = 0
    right: int = 0


def spoil(side):
    return lambda question, right, earlier, rng: {**right, side: 1}


def test_each_part_of_an_answer_errs_on_its_own():
    """A question that asks for two things has as many chances of error as two questions."""

    class Sure(Right):
        async def answer(self, question, rejections):
            return Reply(value=Both(), raw=Both().model_dump_json())

    both = tuple(
        Mistake(name=side, what="", found_in="", questions=("both",), err=spoil(side), part=side)
        for side in ("left", "right")
    )
    advisor = SloppyAdvisor(Sure(), Rates(level=0.4), np.random.default_rng(0), both)
    question = Question(kind="both", prompt="", answer_type=Both, facts={})

    async def run():
        return [await advisor.answer(question, ()) for _ in range(2000)]

    counts = Counter((reply.value.left, reply.value.right) for reply in asyncio.run(run()))
    expected = {(0, 0): 0.36, (1, 0): 0.24, (0, 1): 0.24, (1, 1): 0.16}
    assert {key: count / 2000 for key, count in counts.items()} == pytest.approx(expected, abs=0.03)
    assert parse_rates("left=0.7+right=0.8", both) == Rates(each={"left": 0.7, "right": 0.8})


def fate(advisor, question):
    """What came of asking once: "good", or the code of the failure."""
    try:
        asyncio.run(advisor.answer(question, ()))
    except BadAnswer as bad:
        return bad.rejection.code
    except AdvisorUnavailable as gone:
        return gone.code
    return "good"


PICK = Question(kind="any", prompt="", answer_type=Pick, facts={"n": 1})


@pytest.mark.parametrize(
    ("error", "codes"),
    [("malformed", {"not-json", "cut-off"}), ("refusal", {"refusal"}), ("silence", {"silence"})],
)
def test_a_reply_that_is_no_answer_looks_like_a_real_one(error, codes):
    advisor = SloppyAdvisor(Right(), Rates(each={error: 1.0}), np.random.default_rng(0), ())
    assert {fate(advisor, PICK) for _ in range(30)} <= codes


def test_no_answer_is_given_at_its_rate_whatever_is_asked():
    rates = parse_rates("up=0.3+refusal=0.2+silence=0.1", MISTAKES)
    advisor = SloppyAdvisor(Right(), rates, np.random.default_rng(5), MISTAKES)
    counts = Counter(fate(advisor, PICK) for _ in range(3000))
    shares = {code: count / 3000 for code, count in counts.items()}
    assert shares == pytest.approx({"good": 0.7, "refusal": 0.2, "silence": 0.1}, abs=0.03)


def test_a_question_cancelled_early_does_not_shift_the_next_error():
    def fates(cancelled):
        advisor = SloppyAdvisor(Right(), Rates(each={"refusal": 0.5}), np.random.default_rng(2), ())
        for number in range(20):
            if number in cancelled:
                advisor.answer(PICK, ()).close()
            else:
                yield number, fate(advisor, PICK)

    whole, partly = dict(fates(())), dict(fates((0, 5, 6)))
    assert partly == {number: whole[number] for number in partly}
