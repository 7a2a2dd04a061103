import os
import signal
import threading

import pytest

from coral.interrupts import Terminated, holding_interrupts, interruptible, orderly_termination, uninterrupted


@pytest.fixture(autouse=True)
def handlers():
    """As in a process of its own; every block leaves the handlers as they were."""
    ours = {
        signal.SIGINT: signal.default_int_handler,
        signal.SIGTERM: signal.SIG_DFL,
        signal.SIGHUP: signal.SIG_DFL,
    }
    before = {number: signal.signal(number, handler) for number, handler in ours.items()}
    yield
    assert {number: signal.getsignal(number) for number in ours} == ours
    for number, handler in before.items():
        signal.signal(number, handler)


def interrupt(number=signal.SIGINT):
    os.kill(os.getpid(), number)


def test_an_interrupt_waits_for_the_end_of_the_step():
    steps = []

    def run():
        with uninterrupted():
            interrupt()
            steps.append("whole")
        steps.append("next")

    with holding_interrupts(), pytest.raises(KeyboardInterrupt):
        run()
    assert steps == ["whole"]


def test_the_signals_own_exception_is_raised():
    numbers = []

    def run():
        with uninterrupted():
            interrupt(signal.SIGTERM)
            numbers.append(len(received))

    with orderly_termination() as received, holding_interrupts(), pytest.raises(Terminated, match="SIGTERM"):
        run()
    assert numbers == [0]
    assert received == [signal.SIGTERM]


def test_a_second_interrupt_acts_at_once():
    steps = []

    def run():
        with uninterrupted():
            interrupt()
            steps.append("held back")
            interrupt()
            steps.append("never")

    with holding_interrupts(), pytest.raises(KeyboardInterrupt):
        run()
    assert steps == ["held back"]


def interrupted_step():
    with uninterrupted():
        interrupt()


@pytest.mark.parametrize("when", ["before", "during"])
def test_a_wait_lets_interrupts_through(when):
    steps = []

    def run():
        with uninterrupted():
            if when == "before":
                interrupt()
            steps.append("waits")
            with interruptible():
                interrupt()
                steps.append("never")

    with holding_interrupts(), pytest.raises(KeyboardInterrupt):
        run()
    assert steps == ["waits"]


def test_after_a_wait_interrupts_are_held_back_again():
    steps = []

    def run():
        with uninterrupted():
            with interruptible():
                pass
            interrupt()
            steps.append("whole")

    with holding_interrupts(), pytest.raises(KeyboardInterrupt):
        run()
    assert steps == ["whole"]


def test_an_error_of_the_step_takes_precedence():
    def fail():
        with uninterrupted():
            interrupt()
            raise ValueError("mine")

    with holding_interrupts():
        with pytest.raises(ValueError, match="mine"):
            fail()
        with pytest.raises(KeyboardInterrupt):
            interrupted_step()


def test_other_threads_leave_the_gate_alone():
    failures, steps = [], []

    def beside():
        try:
            with holding_interrupts(), uninterrupted(), interruptible():
                pass
        except BaseException as error:
            failures.append(error)

    def run():
        with uninterrupted():
            interrupt()
            thread = threading.Thread(target=beside)
            thread.start()
            thread.join()
            steps.append("whole")

    with holding_interrupts(), pytest.raises(KeyboardInterrupt):
        run()
    assert (failures, steps) == ([], ["whole"])


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_the_first_signal_ends_and_later_ones_do_not_disturb(number):
    with orderly_termination() as received:
        with pytest.raises(Terminated, match=f"stopped by {number.name}"):
            os.kill(os.getpid(), number)
        os.kill(os.getpid(), signal.SIGTERM)
        os.kill(os.getpid(), signal.SIGHUP)
    assert received == [number]
    assert signal.getsignal(number) is signal.SIG_DFL


def test_nohup_and_handlers_of_others_stay():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    heard = []
    signal.signal(signal.SIGTERM, lambda number, frame: heard.append(number))
    with orderly_termination() as received:
        os.kill(os.getpid(), signal.SIGHUP)
        os.kill(os.getpid(), signal.SIGTERM)
    for number in (signal.SIGHUP, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)
    assert heard == [signal.SIGTERM]
    assert received == []


def test_other_threads_leave_signals_alone():
    found = []

    def enter():
        with orderly_termination():
            found.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=enter)
    thread.start()
    thread.join()
    assert found == [signal.SIG_DFL]
