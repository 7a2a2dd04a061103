"""The operator's verdict from the keyboard."""

import os

from coral.commands.operator_verdict import HINT, KeyboardVerdict


def test_the_keyboard_is_read_without_waiting(capsys):
    read, write = os.pipe()
    with os.fdopen(read) as stream:
        verdict = KeyboardVerdict(stream)
        assert verdict() == ""
        os.write(write, b"what?\n")
        assert verdict() == ""
        assert HINT in capsys.readouterr().err
        os.write(write, b" S \n")
        assert verdict() == "success"
        os.write(write, b"no\nf\ns\n")  # all at once
        assert verdict() == "failure"
        os.close(write)
        assert verdict() == "success"
        assert verdict() == ""
