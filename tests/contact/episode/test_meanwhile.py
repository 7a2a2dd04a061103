"""Steps go on while a block lasts."""

import threading

import pytest

from coral.contact.episode.meanwhile import Meanwhile


def test_steps_are_taken_until_the_block_ends():
    three = threading.Event()
    taken = []

    def step():
        taken.append(1)
        if len(taken) >= 3:
            three.set()
        return True

    meanwhile = Meanwhile(step)
    with meanwhile:
        assert three.wait(10.0)
    assert meanwhile.steps == len(taken) >= 3
    with meanwhile:
        pass
    assert meanwhile.steps <= len(taken) - 3


def test_a_step_that_says_so_is_the_last():
    ended, taken = threading.Event(), []

    def step():
        taken.append(1)
        ended.set()
        return False

    meanwhile = Meanwhile(step)
    with meanwhile:
        assert ended.wait(10.0)
    assert len(taken) == 1
    assert meanwhile.steps == 0


def test_what_a_step_raises_is_raised_at_the_end_of_the_block():
    raised = threading.Event()

    def step():
        raised.set()
        raise ValueError("no arm")

    with pytest.raises(ValueError, match="no arm"), Meanwhile(step):
        assert raised.wait(10.0)


def test_an_error_of_the_block_takes_precedence():
    def step():
        raise ValueError("no arm")

    with pytest.raises(KeyError, match="plan"), Meanwhile(step):
        raise KeyError("plan")
