import asyncio

import numpy as np
import pytest

from coral.advisor.latency import LatencyCfg
from coral.advisor.question import AdvisorUnavailable, Reply, Withdrawn
from coral.advisor.rules import RuleAdvisor
from coral.contact.thinker.thinking_clock import ThinkingClock, thinking_latency
from coral.errors import InputError


class Going:
    """An episode that lasts so long."""

    def __init__(self, ends_s=100.0):
        self.clock_s, self.ends_s = 0.0, ends_s

    def go_on(self, seconds):
        self.clock_s += seconds
        return self.clock_s < self.ends_s


def reply(clock, kind="cost-function", said=None, timeout_s=60.0, error=None):
    async def answer():
        if error is not None:
            raise error
        return Reply(value=None, raw="", latency_s=said)

    clock.begin(kind, 60.0)
    return asyncio.run(clock.reply(answer, timeout_s))


def clock(latency, going):
    return ThinkingClock(latency, np.random.default_rng(0), going)


@pytest.mark.parametrize(
    ("latency", "kind", "said", "seconds"),
    [
        (LatencyCfg(kind="fixed", median_s=4.0), "cost-function", 9.0, 4.0),
        (LatencyCfg(kind="recorded"), "cost-function", 9.0, 9.0),
        (LatencyCfg(kind="fixed", median_s=0.0), "cost-function", 9.0, 0.0),
        (None, "contact-regions", 9.0, 2.3),
        (None, "cost-function", 9.0, 1.5),
        (None, "cost-repair", 9.0, 3.0),
    ],
)
def test_so_much_simulated_time_passes_before_a_reply(latency, kind, said, seconds):
    going = Going()
    reply(clock(latency, going), kind, said)
    assert going.clock_s == seconds


def test_a_failure_takes_as_long_as_an_answer():
    going = Going()
    with pytest.raises(AdvisorUnavailable):
        reply(clock(LatencyCfg(kind="fixed", median_s=4.0), going), error=AdvisorUnavailable("gone", "x"))
    assert going.clock_s == 4.0


def test_what_would_come_too_late_never_comes():
    going = Going()
    with pytest.raises(TimeoutError):
        reply(clock(LatencyCfg(kind="fixed", median_s=4.0), going), timeout_s=3.0)
    assert going.clock_s == 3.0


def test_an_answer_to_an_episode_that_has_ended_is_withdrawn():
    with pytest.raises(Withdrawn):
        reply(clock(LatencyCfg(kind="fixed", median_s=4.0), Going(ends_s=1.0)))


def test_a_fault_of_the_episode_is_kept_and_is_not_the_advisors():
    class Broken(Going):
        def go_on(self, seconds):
            raise ZeroDivisionError

    broken = clock(LatencyCfg(kind="fixed", median_s=4.0), Broken())
    with pytest.raises(Withdrawn):
        reply(broken)
    assert isinstance(broken.fault, ZeroDivisionError)


class Model:
    name, latency = "m", "measured"


def test_rules_take_no_time_models_theirs_and_for_a_person_time_stands_still():
    assert thinking_latency("auto", RuleAdvisor({}), "heuristic").median_s == 0.0
    assert thinking_latency("auto", Model(), "local:http://x/v1#m").kind == "measured"
    assert thinking_latency("auto", Model(), "desk") == LatencyCfg(kind="fixed", median_s=0.0)
    assert thinking_latency("paper", Model(), "x") is None
    assert thinking_latency("fixed:2", RuleAdvisor({}), "heuristic").median_s == 2.0
    with pytest.raises(InputError, match="auto, paper"):
        thinking_latency("papier", Model(), "x")
