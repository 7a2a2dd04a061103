"""What a process tells the program before it works; a thread stands for it."""

import pytest

from coral.contact.franka.child_process import ChildProcess, get_ready, leave_interrupts_to_the_program
from coral.errors import InputError, RunError


def body(prepare, connection):
    leave_interrupts_to_the_program()
    get_ready(connection, prepare, lambda made: 2 * made)
    assert connection.recv() == "end"


def test_it_is_ready_with_what_it_made_and_ends(in_threads):
    child = ChildProcess("a child", body, (lambda: 21,))
    assert child.answer == 42
    child.connection.send("end")
    child.end()
    assert not child.process.is_alive()


def refuse():
    raise InputError("--robot", "", "nobody", "somebody")


def fail():
    raise RunError("the arm speaks another version")


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # it ends by SystemExit
@pytest.mark.parametrize(
    ("prepare", "error", "told"),
    [
        (refuse, InputError, "--robot: found nobody, expected somebody"),
        (fail, RunError, "^the arm speaks another version$"),
        (lambda: 1 // 0, RunError, "^ZeroDivisionError: "),
    ],
)
def test_why_it_is_not_ready_is_told(in_threads, prepare, error, told):
    with pytest.raises(error, match=told):
        ChildProcess("a child", body, (prepare,))
