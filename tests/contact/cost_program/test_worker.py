"""The process that runs costs: it gives what this process gives, it cannot do more, and it is replaced when it dies."""

from __future__ import annotations

import os
import signal
import struct
import sys

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError, CostProgram
from coral.contact.cost_program.errors import LONGEST_NAME
from coral.contact.cost_program.limits import MOST_CHARACTERS
from coral.contact.cost_program.sandbox import KEPT
from coral.contact.cost_program.worker import CostWorker, WorkerCfg
from coral.errors import InputError

LINUX = sys.platform.startswith("linux")


@pytest.fixture(scope="module")
def worker():
    with CostWorker() as found:
        yield found


def test_it_gives_the_same_bits_as_this_process(worker, board, schema, states):
    state = states(np.random.default_rng(1), 20, 10)
    cost, program = worker.load(board, schema), CostProgram(board, schema)
    found, wanted = cost(state), program(state)
    assert list(found) == list(wanted)
    assert all(np.array_equal(found[name], wanted[name]) for name in wanted)


def test_more_programs_than_are_kept_at_a_time_are_all_evaluated(worker, schema, states):
    state = states(np.random.default_rng(3), 2, 2)
    costs = [worker.load(f"def state_cost(self):\n    return {k}.0 + 0.0 * self.time", schema) for k in range(KEPT + 3)]
    for _ in range(2):
        assert [sum(term[0, 0] for term in cost(state).values()) for cost in costs] == list(range(KEPT + 3))


def test_a_refusal_comes_back_with_its_line(worker, schema):
    with pytest.raises(CostError) as caught:
        worker.load("def state_cost(self):\n    x = 1\n    import os\n    return x", schema)
    assert (caught.value.code, caught.value.line, caught.value.shown) == ("not_allowed", 3, "import os")


def test_a_killed_process_is_started_again_with_its_programs(worker, board, schema, states):
    state = states(np.random.default_rng(3))
    cost = worker.load(board, schema)
    before, starts = cost(state), worker.starts
    os.kill(worker.pid, signal.SIGKILL)
    os.waitid(os.P_PID, worker.pid, os.WEXITED | os.WNOWAIT)
    after = cost(state)
    assert worker.starts == starts + 1
    assert all(np.array_equal(before[name], after[name]) for name in before)


@pytest.mark.skipif(not LINUX, reason="processor time is limited by a Linux timer here")
def test_a_cost_that_takes_too_long_takes_only_its_process_down(schema, states):
    loop = "    for i in range(64):\n        s = np.tan(np.exp(s))\n"
    slow = "def state_cost(self):\n    s = self.time\n" + loop * 55 + "    return s"
    state = states(np.random.default_rng(4), 100, 100)
    with CostWorker(WorkerCfg(cpu_s=0.05)) as one:
        cost = one.load(slow, schema)
        with pytest.raises(CostError, match="processor time") as caught:
            cost(state)
        assert caught.value.code == "deadline"
        assert one.load("def state_cost(self):\n    return self.time", schema)(state)["cost"].shape == (100, 100)
        assert one.starts == 2


@pytest.mark.skipif(not LINUX, reason="memory is limited on Linux here")
def test_memory_ends_at_the_limit(schema, states):
    state = states(np.random.default_rng(5), 400, 200)
    keeping = (
        "def state_cost(self):\n    xs = ["
        + ", ".join(["self.time * 2.0"] * 60)
        + "]\n    ys = ["
        + ", ".join(["self.time * 3.0"] * 60)
        + "]\n    return sum(xs) + sum(ys)"
    )
    with CostWorker(WorkerCfg(memory_bytes=40 << 20, shared_bytes=1 << 20)) as one:
        cost = one.load(keeping, schema)
        with pytest.raises(CostError) as caught:
            cost(state)
    assert caught.value.code in ("memory", "killed")


def test_a_larger_batch_gets_more_shared_memory(schema, states):
    state = states(np.random.default_rng(6), 50, 40)
    with CostWorker(WorkerCfg(shared_bytes=4096)) as one:
        cost = one.load("def state_cost(self):\n    return self.time + norm(self.ee_pos)", schema)
        assert next(iter(cost(state).values())).shape == (50, 40)


def test_limits_hold_in_the_process_too(schema):
    with CostWorker() as one, pytest.raises(CostError) as caught:
        one.load("def state_cost(self):\n    return self.time" + " " * MOST_CHARACTERS, schema)
    assert caught.value.code == "too_large"


def test_a_quantity_of_the_wrong_shape_is_named(worker, schema, states):
    state = states(np.random.default_rng(7))
    cost = worker.load("def state_cost(self):\n    return norm(self.ee_pos)", schema)
    wrong = Context({name: state[name] for name in state.names()} | {"ee_pos": np.zeros((4, 5, 2))}, (4, 5))
    with pytest.raises(CostError, match="ee_pos has shape"):
        cost(wrong)


def impostor(*answers):
    """A process that gives these answers, one after the other and then the last one for ever."""
    framed = [struct.pack("<I", len(answer)) + answer for answer in answers]
    return (
        f"import os,struct\nanswers = {framed!r}\nwhile True:\n"
        "    os.write(1, answers.pop(0) if len(answers) > 1 else answers[0])\n"
        "    if not (h := os.read(0, 4)): break\n    os.read(0, struct.unpack('<I', h)[0])\n"
    )


READY, LOADED = b'{"ready": true, "filtered": true}', b'{"reads": [], "source": "", "dropped": []}'
NO_RUN = [
    b'{"terms": []}',
    b'{"terms": ["\\ud800"]}',
    b'{"terms": ["\\u001b[2J"]}',
    b'{"terms": ["a"], "lines": {}}',
    b'{"terms": ["a", "a"]}',
    b'{"terms": [1e400]}',
    b'{"terms": 3}',
    b'{"error": ["made up", "x", 1e400, "z"]}',
    b'{"error": [[], "x", 1, "z"]}',
    b'{"error": null}',
    b"[]",
    b"not json",
    b"\xff\xfe",
    b"[" * 100_000,
]
NO_LOAD = [
    b"{}",
    b'{"reads": 3, "source": "", "dropped": []}',
    b'{"reads": [[]], "source": "", "dropped": []}',
    b'{"reads": [], "dropped": []}',
    b'{"reads": [], "source": "", "dropped": [[]]}',
    b'{"reads": [], "source": "", "dropped": [1e400]}',
]
NO_START = [b"null", b"3", b'{"ready": true}', b'{"ready": true, "filtered": 1}']


@pytest.mark.parametrize(
    "answers",
    [(READY, LOADED, answer) for answer in NO_RUN]
    + [(READY, answer) for answer in NO_LOAD]
    + [(answer,) for answer in NO_START],
)
def test_an_answer_of_a_process_that_was_taken_over_is_not_believed(answers, schema, states, monkeypatch):
    monkeypatch.setattr("coral.contact.cost_program.worker.START", impostor(*answers))
    with CostWorker() as one:
        with pytest.raises(CostError, match="nonsense") as caught:
            one.load("def state_cost(self):\n    return 1.0", schema)(states(np.random.default_rng(8)))
        assert caught.value.code == "killed"
        assert one.pid is None


def test_an_error_of_an_unknown_code_is_an_internal_one(schema, monkeypatch):
    answers = (READY, b'{"error": ["made up", "x", 1, "z"]}')
    monkeypatch.setattr("coral.contact.cost_program.worker.START", impostor(*answers))
    with CostWorker() as one, pytest.raises(CostError) as caught:
        one.load("def state_cost(self):\n    return 1.0", schema)
    assert (caught.value.code, caught.value.line) == ("internal", 1)


UNUSUAL = {
    "greek": "α, Δ, π = 1.0, 2.0, 3.0\n    return α * self.time + Δ * π",
    "wide letters": "ｘ = self.time\n    return ｘ",
    "named character": "d = {'\\N{DEGREE SIGN}': self.time}\n    return d['°']",
    "long name": f"{'x' * 300} = self.time\n    cost = 0.0\n    cost += {'x' * 300}\n    return cost",
    "comment that cannot be shown": "cost = 0.0\n    cost += self.time  # \x1b[2J\x07\n    return cost",
}


@pytest.mark.parametrize("what", sorted(UNUSUAL))
def test_unusual_python_runs_in_the_process_too(what, worker, schema, states):
    starts = worker.starts
    terms = worker.load(f"def state_cost(self):\n    {UNUSUAL[what]}\n", schema)(states(np.random.default_rng(0)))
    assert worker.starts == max(1, starts)
    assert all(name.isprintable() and len(name) <= LONGEST_NAME for name in terms)


FAULTY = {
    "too many digits": ("def state_cost(self):\n    return " + "9" * 5000, "syntax", "digits"),
    "unfinished": ("def state_cost(self):\n    return 1 +", "syntax", "not Python"),
    "open text": ("def state_cost(self):\n    return f'{x'", "syntax", "not Python"),
    "indentation": ("def state_cost(self):\n    return 1\n  y = 2", "syntax", "not Python"),
    "async": ("async def state_cost(self):\n    return 1.0", "not_allowed", "no async"),
    "async inside": ("def state_cost(self):\n    async def f(): pass\n    return 1.0", "not_allowed", "no async"),
    "unknown letter": ("def state_cost(self):\n    return self.timé", "unknown_state", "no 'timé'"),
    "lone surrogate": (r"def state_cost(self):" "\n    " r"return {'reach\ud800': 1.0}", "wrong_return", "printable"),
    "bell": (r"def state_cost(self):" "\n    " r"terms['\x07'] = 1.0", "wrong_return", "printable"),
    "long term": (f"def state_cost(self):\n    return {{'{'y' * 300}': 1.0}}", "wrong_return", "1 to 60"),
    "no name": ("def state_cost(self):\n    return {'': 1.0}", "wrong_return", "printable"),
}


@pytest.mark.parametrize("what", sorted(FAULTY))
def test_a_faulty_program_gets_its_reason_from_the_process(what, worker, schema, states):
    source, code, words = FAULTY[what]
    with pytest.raises(CostError, match=words) as caught:
        worker.load(source, schema)(states(np.random.default_rng(0)))
    assert caught.value.code == code
    assert str(caught.value).isprintable()
    assert worker.pid is not None


def test_a_machine_without_a_filter_runs_no_cost_unless_told_to(schema, monkeypatch):
    unfiltered = (
        "from coral.contact.cost_program import sandbox, seccomp\nseccomp.available = lambda: False\nsandbox.main()"
    )
    monkeypatch.setattr("coral.contact.cost_program.worker.START", unfiltered)
    monkeypatch.delenv("CORAL_ALLOW_UNFILTERED_COSTS", raising=False)
    source = "def state_cost(self):\n    return 1.0"
    with CostWorker() as one:
        with pytest.raises(InputError, match="CORAL_ALLOW_UNFILTERED_COSTS=1"):
            one.load(source, schema)
        assert one.pid is None
        assert not one.check()
    with CostWorker(WorkerCfg(allow_unfiltered=True)) as one:
        assert one.load(source, schema).source.startswith("def state_cost")
        assert not one.filtered
    monkeypatch.setenv("CORAL_ALLOW_UNFILTERED_COSTS", "1")
    assert WorkerCfg().allow_unfiltered
