import os
import signal
import threading

import pytest

from coral.termination import Terminated, orderly_termination


@pytest.fixture
def free():
    """As in a process of its own: nobody has decided upon these signals."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in (signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_the_first_signal_ends_and_later_ones_do_not_disturb(free, number):
    with orderly_termination() as received:
        with pytest.raises(Terminated, match=f"stopped by {number.name}"):
            os.kill(os.getpid(), number)
        os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGHUP)
    assert received.exit_code(0) == 128 + number
    assert signal.getsignal(number) is signal.SIG_DFL


def test_nohup_and_handlers_of_others_stay(free):
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    heard = []
    signal.signal(signal.SIGTERM, lambda number, frame: heard.append(number))
    with orderly_termination() as received:
        os.kill(os.getpid(), signal.SIGHUP)
        os.kill(os.getpid(), signal.SIGTERM)
    assert heard == [signal.SIGTERM]
    assert received.exit_code(1) == 1


def test_other_threads_leave_signals_alone(free):
    found = []

    def enter():
        with orderly_termination():
            found.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=enter)
    thread.start()
    thread.join()
    assert found == [signal.SIG_DFL]
