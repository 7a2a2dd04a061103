"""Which thread does what during a survey."""

import signal

import pytest

from coral.commands.sail_conduct import conduct, signals_as_words
from coral.errors import RunError
from coral.reef.sea.operator import OperatorWords


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
