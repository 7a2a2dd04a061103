"""The sandboxed process: its messages, and its answers to requests."""

import json
import os

import numpy as np
import pytest

from coral.contact.cost_program.sandbox import (
    HEADER,
    KEPT,
    LONGEST_MESSAGE,
    Sandbox,
    quantities,
    read_message,
    write_message,
)

SCHEMA = {"ee_pos": [3, 0, 0], "time": [0, 0, 0]}


def load(number, source):
    return {"op": "load", "id": number, "source": source, "schema": SCHEMA}


def run(number):
    """A run over two states whose inputs lie at the beginning of the memory, and whose terms come behind them."""
    inputs = [["ee_pos", 0, [1, 2], 3], ["time", 6, [1, 2], 0]]
    return {"op": "run", "id": number, "shape": [1, 2], "inputs": inputs, "output": 8}


@pytest.fixture
def memory():
    found = np.zeros(64)
    found[:8] = [3.0, 0.0, 4.0, 0.0, 0.0, 2.0, 0.1, 0.2]  # x, y, z of two states, then their times
    return found


@pytest.fixture
def pipe():
    ends = os.pipe()
    yield ends
    for end in ends:
        os.close(end)


def test_a_message_is_read_as_it_was_written(pipe):
    message = {"op": "load", "source": "α = 'é'\n", "ids": [1, 2.5, None]}
    write_message(pipe[1], message)
    write_message(pipe[1], {"op": "run"})
    assert read_message(pipe[0]) == message
    assert read_message(pipe[0]) == {"op": "run"}


def test_a_stream_that_ends_or_promises_too_much_holds_no_message(pipe):
    os.write(pipe[1], HEADER.pack(LONGEST_MESSAGE + 1))
    assert read_message(pipe[0]) is None
    reading, writing = os.pipe()
    os.write(writing, HEADER.pack(9) + b"{}")
    os.close(writing)
    assert read_message(reading) is None
    os.close(reading)


def test_a_schema_is_read_from_its_message():
    found = quantities({"touch": [0, 1, 0], "mass": [0, 0, 1], "pos": [3, 0, 0]})
    assert [(q.size, q.truth, q.constant) for q in found.values()] == [
        (0, True, False),
        (0, False, True),
        (3, False, False),
    ]


def test_terms_are_written_behind_the_inputs(memory):
    sandbox = Sandbox(memory)
    loaded = sandbox.answer(load(7, 'def state_cost(self):\n    return {"d": norm(self.ee_pos), "t": -self.time}'))
    assert loaded["reads"] == ["ee_pos", "time"]
    assert sandbox.answer(run(7)) == {"terms": ["d", "t"]}
    assert memory[8:12].tolist() == [5.0, 2.0, -0.1, -0.2]


def test_an_error_is_an_answer_with_its_line(memory):
    sandbox = Sandbox(memory)
    code, text, line, shown = sandbox.answer(load(1, "def state_cost(self):\n    import os\n    return 1.0"))["error"]
    assert (code, line, shown) == ("not_allowed", 2, "import os")
    assert "cannot be imported" in text


@pytest.mark.parametrize("request_", [{}, {"op": "run", "id": 5}, {"op": "load", "id": 1}])
def test_a_request_without_sense_is_answered_with_an_internal_error(request_, memory):
    assert Sandbox(memory).answer(request_)["error"][0] == "internal"


def test_terms_that_do_not_fit_are_refused(memory):
    sandbox = Sandbox(memory[:9])
    sandbox.answer(load(1, "def state_cost(self):\n    return self.time"))
    assert sandbox.answer(run(1))["error"][0] == "memory"


def test_the_program_that_was_not_used_for_longest_is_dropped(memory):
    sandbox = Sandbox(memory)
    for number in range(KEPT):
        assert sandbox.answer(load(number, "def state_cost(self):\n    return self.time"))["dropped"] == []
    sandbox.answer(run(0))
    assert sandbox.answer(load(KEPT, "def state_cost(self):\n    return self.time"))["dropped"] == [1]
    assert "error" not in sandbox.answer(run(0))
    assert "error" in sandbox.answer(run(1))


def test_answers_can_be_sent_as_messages(memory):
    sandbox = Sandbox(memory)
    loaded = sandbox.answer(load(1, "def state_cost(self):\n    return norm(self.ee_pos)"))
    for reply in (loaded, sandbox.answer(run(1)), sandbox.answer({})):
        assert json.loads(json.dumps(reply)) == reply
