import asyncio
import sys
import threading

import numpy as np
import pytest
from pydantic import BaseModel

from coral.advisor.clock import SWITCH_S, SimulatedClock, WallClock
from coral.advisor.consult import BudgetCfg, consult
from coral.advisor.latency import parse_latency
from coral.advisor.question import AdvisorUnavailable, BadAnswer, Question, Rejection, Reply, Withdrawn


class Pick(BaseModel):
    index: int


QUESTION = Question(kind="pick", prompt="which?", answer_type=Pick, facts={})


@pytest.fixture
def make_clock():
    clocks = []

    def make(latency="fixed:1", seed=0, **more):
        clocks.append(SimulatedClock(latency, np.random.default_rng(seed), **more))
        return clocks[-1]

    yield make
    for clock in clocks:
        clock.close()


def run(clock, coroutine, ticks=1000):
    """Tick number at which the coroutine ended."""
    task = clock.start(coroutine)
    for tick in range(ticks):
        clock.advance(tick * 0.1)
        if task.done():
            return tick, task
    return None, task


def answer(value):
    async def asking():
        return value

    return asking


def fail(error):
    async def asking():
        raise error

    return asking


@pytest.mark.parametrize(("latency", "tick"), [("fixed:1", 10), ("fixed:0.95", 10), ("fixed:10", 100), ("0", 0)])
def test_reply_arrives_at_first_tick_after_latency(make_clock, latency, tick):
    clock = make_clock(latency)
    ended, task = run(clock, clock.reply(answer("north"), 60.0))
    assert (ended, task.result()) == (tick, "north")


def test_lognormal_latency_is_seeded(make_clock):
    def ticks(seed):
        clock = make_clock("lognormal:2:0.5", seed)

        async def three():
            at = []
            for _ in range(3):
                await clock.reply(answer(1), 60.0)
                at.append(clock.now())
            return at

        return run(clock, three())[1].result()

    assert ticks(7) == ticks(7)
    assert ticks(7) != ticks(8)


def test_simulated_time_waits_for_a_slow_machine(make_clock):
    clock = make_clock("fixed:0.2")
    gate = threading.Event()

    async def slow():
        await asyncio.to_thread(gate.wait, 10)
        return "late"

    task = clock.start(clock.reply(slow, 60.0))
    clock.advance(0.1)
    assert not task.done()
    threading.Timer(0.02, gate.set).start()
    clock.advance(0.2)
    assert task.result() == "late"


def test_machine_that_never_answers_is_named(make_clock):
    clock = make_clock("fixed:0.1", wall_timeout_s=0.02)
    task = clock.start(clock.reply(asyncio.Event().wait, 60.0))
    with pytest.raises(AdvisorUnavailable, match="wall time"):
        clock.advance(0.1)
    assert task.done()


@pytest.mark.parametrize("error", [BadAnswer("not-json", "prose"), AdvisorUnavailable("http-500", "down")])
def test_failures_take_as_long_as_answers(make_clock, error):
    clock = make_clock("fixed:1")

    async def ask():
        try:
            await clock.reply(fail(error), 60.0)
        except (BadAnswer, AdvisorUnavailable) as caught:
            return caught

    tick, task = run(clock, ask())
    assert tick == 10
    assert task.result() is error


def test_timeout_is_simulated_and_cancels(make_clock):
    clock = make_clock("fixed:10")
    cancelled = threading.Event()

    async def hang():
        try:
            await asyncio.Event().wait()
        finally:
            cancelled.set()

    async def ask():
        with pytest.raises(TimeoutError):
            await clock.reply(hang, 3.0)
        return clock.now()

    tick, task = run(clock, ask())
    assert tick == 30
    assert task.result() == pytest.approx(3.0)
    assert cancelled.wait(5)
    assert not clock.pending


def test_recorded_latency_comes_with_the_reply(make_clock):
    clock = make_clock("recorded")
    tick, _ = run(clock, clock.reply(answer(Reply(value=Pick(index=1), raw="", latency_s=2.5)), 60.0))
    assert tick == 25


def test_measured_latency_paces_the_mission(make_clock, monkeypatch):
    wall, slept = [100.0], []

    def sleep(seconds):
        slept.append(seconds)
        wall[0] += seconds
        if wall[0] >= 100.35 and not done.is_set():
            done.set()
            finished.wait(10)

    done, finished = threading.Event(), threading.Event()
    monkeypatch.setattr("coral.advisor.clock.time.monotonic", lambda: wall[0])
    monkeypatch.setattr("coral.advisor.clock.time.sleep", sleep)
    clock = make_clock("measured")

    async def asking():
        await asyncio.to_thread(done.wait, 10)
        return "here"

    task = clock.start(clock.reply(asking, 60.0))
    clock._requests[0].future.add_done_callback(lambda _: finished.set())
    ticks = 0
    while not task.done():
        ticks += 1
        clock.advance(ticks * 0.1)
    assert slept == pytest.approx([0.1] * 4)
    assert clock.waited_s == pytest.approx(0.4)
    assert ticks == 4


def test_withdrawn_request_ends_at_once(make_clock):
    clock = make_clock("fixed:10")

    async def ask():
        with pytest.raises(Withdrawn):
            await clock.reply(answer(1), 60.0)

    task = clock.start(ask())
    clock.withdraw()
    assert task.done()
    assert not clock.pending


def test_error_of_the_mission_surfaces(make_clock):
    clock = make_clock("0")

    async def broken():
        await clock.reply(answer(1), 1.0)
        raise KeyError("bug")

    with pytest.raises(KeyError, match="bug"):
        clock.start(broken())


class Sequence_:
    """Answers from a list, in order."""

    name = "list"

    def __init__(self, *replies):
        self.replies = list(replies)
        self.heard = []

    async def answer(self, question, rejections):
        self.heard.append([r.code for r in rejections])
        reply = self.replies.pop(0)
        if isinstance(reply, Exception):
            raise reply
        return Reply(value=Pick(index=reply), raw=str(reply))


def test_consult_on_simulated_time(make_clock):
    clock = make_clock("fixed:2")
    advisor = Sequence_(1, BadAnswer("empty", "nothing there"), 3)
    log = []

    def verify(question, pick):
        return Rejection(code="backward", reason="behind") if pick.index == 1 else None

    tick, task = run(clock, consult(advisor, lambda _: QUESTION, verify, BudgetCfg(), clock, log.append))
    assert tick == 60
    assert task.result().answer == Pick(index=3)
    assert advisor.heard == [[], ["backward"], ["backward", "empty"]]
    assert [(a.verdict, a.asked_at_s, a.answered_at_s) for a in log] == [
        ("rejected", 0.0, pytest.approx(2.0)),
        ("malformed", pytest.approx(2.0), pytest.approx(4.0)),
        ("accepted", pytest.approx(4.0), pytest.approx(6.0)),
    ]


def test_an_interrupt_in_a_coroutine_is_raised_once(make_clock):
    async def interrupted():
        raise KeyboardInterrupt

    clock = make_clock()
    task = clock.start(clock.reply(answer(4), 60.0))
    with pytest.raises(KeyboardInterrupt):
        clock.start(interrupted())
    clock.advance(1.0)
    assert task.result() == 4


def test_wall_clock_steps_without_waiting():
    clock = WallClock()
    gate = threading.Event()

    async def asking():
        await asyncio.to_thread(gate.wait, 10)
        return 5

    task = clock.start(clock.reply(asking, 60.0))
    clock.advance()
    assert not task.done()
    gate.set()
    while not task.done():
        clock.advance()
    assert task.result() == 5
    clock.close()


def test_on_the_wall_clock_an_answer_is_given_no_earlier_than_configured():
    clock, gate = WallClock(latency=parse_latency("fixed:5")), threading.Event()

    async def asking():
        await asyncio.to_thread(gate.wait, 10)
        return 5

    quick, slow = clock.start(clock.reply(answer(4), 60.0)), clock.start(clock.reply(asking, 60.0))
    clock._start_s -= 4.0  # 4 s pass
    clock.advance()
    assert not quick.done()
    clock._start_s -= 1.0
    while not quick.done():  # the other thread may not have got to it
        clock.advance()
    assert quick.result() == 4
    assert not slow.done()  # the answer is late: nothing waits for it
    gate.set()
    while not slow.done():
        clock.advance()
    assert slow.result() == 5
    clock.close()


@pytest.mark.parametrize(("after_s", "tick"), [(0.0, 0), (0.3, 3), (0.25, 3)])
def test_what_is_prepared_is_there_at_its_simulated_time_however_slow_the_machine_is(make_clock, after_s, tick):
    clock, go = make_clock(), threading.Event()
    threading.Timer(0.05, go.set).start()
    ended, task = run(clock, clock.prepare(lambda: go.wait(60.0), after_s))
    assert ended == tick
    assert task.result() is True


def test_a_run_that_was_suspended_while_something_was_prepared_continues(make_clock):
    clock, go = make_clock(wall_timeout_s=0.02), threading.Event()
    threading.Timer(0.2, go.set).start()
    _, task = run(clock, clock.prepare(lambda: go.wait(60.0), 0.1))
    assert task.result() is True


def test_preparations_are_made_in_order_on_one_other_thread(make_clock):
    clock = make_clock()

    async def asking():
        return [await clock.prepare(threading.get_ident, 0.0) for _ in range(3)]

    _, task = run(clock, asking())
    assert len(set(task.result())) == 1
    assert task.result()[0] != threading.get_ident()
    assert sys.getswitchinterval() <= SWITCH_S + 1e-9, "the control thread gets the interpreter soon"


def test_what_is_prepared_can_be_withdrawn(make_clock):
    clock, go = make_clock(), threading.Event()

    async def asking():
        try:
            return await clock.prepare(lambda: go.wait(60.0), 10.0)
        except Withdrawn:
            return "withdrawn"

    task = clock.start(asking())
    clock.withdraw()
    go.set()
    assert task.result() == "withdrawn"


def test_on_the_wall_clock_what_is_prepared_is_there_when_it_is_ready():
    clock, go = WallClock(), threading.Event()
    task = clock.start(clock.prepare(lambda: go.wait(60.0), 1000.0))
    clock.advance()
    assert not task.done()
    go.set()
    while not task.done():
        clock.advance()
    assert task.result() is True
    clock.close()
