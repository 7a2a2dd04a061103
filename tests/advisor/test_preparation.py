"""The preparation thread."""

import sys
import threading

import pytest

from coral.advisor.preparation import SWITCH_S, PreparationThread


@pytest.fixture
def thread():
    made = PreparationThread()
    yield made
    made.close()


def test_work_is_done_in_order_on_one_other_thread(thread):
    done = [thread.submit(threading.get_ident) for _ in range(3)]
    assert len({each.result(60.0) for each in done}) == 1
    assert done[0].result() != threading.get_ident()


def test_an_exception_is_kept_for_the_asker(thread):
    assert isinstance(thread.submit(lambda: 1 // 0).exception(60.0), ZeroDivisionError)


def test_the_control_thread_gets_the_interpreter_soon(thread):
    thread.submit(lambda: None).result(60.0)
    assert sys.getswitchinterval() <= SWITCH_S + 1e-9


def test_what_has_not_begun_is_dropped_at_the_end():
    thread, go, began = PreparationThread(), threading.Event(), threading.Event()
    first = thread.submit(lambda: (began.set(), go.wait(60.0)))
    second = thread.submit(lambda: None)
    assert began.wait(60.0)
    closing = threading.Thread(target=thread.close)
    closing.start()
    while not second.cancelled():
        second.cancel()
    go.set()
    closing.join(60.0)
    assert first.done()
    assert second.cancelled()
