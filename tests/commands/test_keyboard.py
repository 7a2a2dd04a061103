import os
import pty
import signal

import pytest

from coral.commands.keyboard import Keyboard, conduct, signals_as_words
from coral.errors import RunError
from coral.reef.sea.operator import OperatorWords


@pytest.fixture
def words():
    return OperatorWords()


@pytest.fixture
def pipe():
    reading, writing = os.pipe()
    with os.fdopen(reading) as source:
        yield source, lambda text: os.write(writing, text.encode())
    os.close(writing)


def listening(times):
    left = iter(range(times))
    return lambda: next(left, None) is None


def test_words_on_a_pipe(words, pipe, capsys):
    source, write = pipe
    write("hold\nnonsense\nresume\nq\n")
    Keyboard(words, source).listen(listening(2))
    assert "type arm, hold, resume, home, stop, surface, disarm" in capsys.readouterr().err
    assert words.take() == [("hold", "keyboard"), ("resume", "keyboard"), ("stop", "keyboard")]


def test_keys_on_a_terminal_need_no_enter(words):
    master, slave = pty.openpty()
    with os.fdopen(slave) as source:
        keyboard = Keyboard(words, source)
        typed = iter([b" ", b"r", b"x", b"q"])

        def until():
            key = next(typed, None)
            if key is not None:
                os.write(master, key)
            return key is None

        keyboard.listen(until)
    os.close(master)
    assert [word for word, _ in words.take()][:2] == ["hold", "resume"]


@pytest.mark.parametrize(("typed", "armed"), [("arm\n", True), ("ARM \n", True), ("q\n", False), ("yes\narm\n", True)])
def test_arming_takes_the_word(words, pipe, typed, armed):
    source, write = pipe
    write(typed)
    assert Keyboard(words, source).wait_for_arm() is armed


def test_arming_may_come_from_the_page(words, pipe):
    source, _ = pipe
    words.say("hold", "page")
    words.say("arm", "page")
    assert Keyboard(words, source).wait_for_arm()


@pytest.mark.parametrize("after", ["stop", "surface", "disarm"])
def test_what_ends_a_survey_prevails_over_arm_before_it_begins(words, pipe, after):
    source, write = pipe
    write(f"arm\n{after}\n")
    assert not Keyboard(words, source).wait_for_arm()


def test_a_hold_after_arm_takes_it_back(words, capsys):
    reading, writing = os.pipe()
    os.write(writing, b"arm\nhold\n")
    os.close(writing)
    with os.fdopen(reading) as source:
        assert not Keyboard(words, source).wait_for_arm()
    assert "type arm to begin" in capsys.readouterr().err


def test_the_end_of_the_input_arms_nothing(words):
    with open(os.devnull) as source:
        assert not Keyboard(words, source).wait_for_arm()


def test_a_signal_becomes_a_word_and_the_handler_is_put_back():
    words = OperatorWords()
    found = signal.signal(signal.SIGINT, signal.default_int_handler)  # a process in the background ignores it
    try:
        with signals_as_words(words):
            signal.raise_signal(signal.SIGINT)
        assert words.take() == [("stop", "SIGINT")]
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, found)


def test_a_failure_of_the_control_loop_is_told():
    class Broken:
        def run(self, observers):
            raise ValueError("no way")

    with pytest.raises(RunError, match="ValueError: no way"):
        conduct(Broken(), [], OperatorWords())
