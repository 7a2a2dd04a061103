"""A mission inside a running event loop, as in a notebook: the same mission, and the loop goes on as before."""

import asyncio
import threading

import pytest

from coral.advisor.clock import SimulatedClock
from coral.advisor.consult import BudgetCfg
from coral.advisor.question import AdvisorUnavailable
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.pilot.pilot_cfg import PilotCfg
from coral.reef.world.world import load_world

SHORT = MissionCfg(time_limit_s=6.0, latency="fixed:1", record=RecordCfg(pictures=False, frames=False))


class Silent:
    """Never answers, so that the rules decide in its place."""

    name, latency = "silent", "0"

    async def answer(self, question, rejections):
        raise AdvisorUnavailable("silence", "nobody is there")


def mission(folder, advisor=None):
    cfg = (
        SHORT if advisor is None else MissionCfg(**{**vars(SHORT), "pilot": PilotCfg(budget=BudgetCfg(deadline_s=2.0))})
    )
    return Mission(load_world("l1"), cfg, advisor or RuleAdvisor(REEF_RULES), folder).run()


@pytest.mark.parametrize("advisor", [None, Silent()])
def test_a_mission_in_a_running_loop_is_the_same_mission(tmp_path, advisor):
    async def cell():
        me, ticks = asyncio.current_task(), []
        other = asyncio.create_task(count(ticks))
        mission(tmp_path / "cell", advisor)
        assert asyncio.current_task() is me
        await other
        return ticks

    async def count(ticks):
        for k in range(3):
            await asyncio.sleep(0)
            ticks.append(k)

    mission(tmp_path / "script", advisor)
    assert asyncio.run(cell()) == [0, 1, 2]
    for name in ("metrics.json", "trajectory.csv", "events.jsonl"):
        assert (tmp_path / "cell" / name).read_bytes() == (tmp_path / "script" / name).read_bytes()


def test_an_error_comes_out_and_the_outer_loop_goes_on(tmp_path):
    async def wrong():
        await asyncio.sleep(0)
        raise ValueError("from within")

    async def cell():
        from coral.advisor.inner_loop import run_alone

        with pytest.raises(ValueError, match="from within"):
            run_alone(wrong())
        return await asyncio.wait_for(asyncio.sleep(0, "after"), 5)

    assert asyncio.run(cell()) == "after"


def test_loops_may_lie_in_one_another():
    from coral.advisor.inner_loop import run_alone

    async def at_depth(n):
        me = asyncio.current_task()
        found = [n] if n == 0 else [n, *run_alone(at_depth(n - 1))]
        assert asyncio.current_task() is me
        async with asyncio.timeout(5):
            await asyncio.sleep(0)
        return found

    assert run_alone(at_depth(3)) == [3, 2, 1, 0]
    with pytest.raises(RuntimeError):
        asyncio.get_running_loop()


def test_a_loop_that_runs_is_not_entered_twice():
    from coral.advisor.inner_loop import run_on

    async def cell():
        waiting = asyncio.sleep(0)
        try:
            with pytest.raises(RuntimeError, match="already running"):
                run_on(asyncio.get_running_loop(), waiting)
        finally:
            waiting.close()
        return asyncio.current_task() is not None

    assert asyncio.run(cell())


def test_a_clock_is_closed_inside_a_running_loop():
    import numpy as np

    async def cell():
        clock = SimulatedClock("fixed:5", np.random.default_rng(0))
        gate = threading.Event()

        async def ask():
            await asyncio.to_thread(gate.wait)

        task = clock.start(clock.reply(ask, 60.0))
        clock.advance(1.0)
        gate.set()
        clock.close()
        return task.cancelled()

    assert asyncio.run(cell())
