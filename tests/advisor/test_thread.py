import asyncio
import threading

import pytest

from coral.advisor.thread import AdvisorThread


@pytest.fixture
def thread():
    thread = AdvisorThread()
    yield thread
    thread.close()


def test_the_draw_is_made_in_the_callers_thread_and_the_answer_in_its_own(thread):
    made = []

    def asking():
        made.append(threading.current_thread())

        async def answer():
            return threading.current_thread().name

        return answer()

    assert thread.submit(asking).result(5) == "coral-advisor"
    assert made == [threading.main_thread()]


def test_cancelling_the_future_cancels_the_coroutine(thread):
    started, cancelled = threading.Event(), threading.Event()

    async def hang():
        started.set()
        try:
            await asyncio.Event().wait()
        finally:
            cancelled.set()

    future = thread.submit(hang)
    assert started.wait(5)
    future.cancel()
    assert cancelled.wait(5)


class Connected:
    """Connects on a loop, and must be closed on the same."""

    def __init__(self, fails=False):
        self.loops, self.fails = [], fails

    async def warm_up(self):
        self.loops.append(asyncio.get_running_loop())

    async def aclose(self):
        self.loops.append(asyncio.get_running_loop())
        if self.fails:
            raise OSError("gone")


def test_closing_ends_what_is_pending_and_closes_each_advisor_on_the_loop_it_was_warmed_on():
    thread = AdvisorThread()
    advisors = [Connected(fails=True), Connected()]
    for advisor in advisors:
        thread.warm_up(advisor)
    pending = thread.submit(asyncio.Event().wait)
    thread.close()
    assert pending.cancelled()
    assert [len(advisor.loops) for advisor in advisors] == [2, 2]
    assert len({loop for advisor in advisors for loop in advisor.loops}) == 1
    thread.close()


def test_an_advisor_that_never_gets_warm_is_an_error(thread):
    cancelled = threading.Event()

    class Cold:
        async def warm_up(self):
            try:
                await asyncio.Event().wait()
            finally:
                cancelled.set()

    with pytest.raises(TimeoutError):
        thread.warm_up(Cold(), timeout_s=0.2)
    assert cancelled.wait(5)
    thread.warm_up(object())
