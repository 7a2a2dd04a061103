"""Generated programs: a batch agrees with its states, and broken ones end in a reason, never in a crash."""

from __future__ import annotations

import random

import numpy as np
import pytest
from cost_oracles import fuzz_programs

from coral.contact.cost.context import Context
from coral.contact.cost_program import CostError, CostProgram
from coral.contact.cost_program.errors import CODES

PROGRAMS = 40


@pytest.mark.parametrize("seed", range(PROGRAMS))
def test_a_batch_has_the_bits_of_its_single_states(seed):
    state = fuzz_programs.batch(seed)
    try:
        program = CostProgram(fuzz_programs.Programs(seed).program(), fuzz_programs.SCHEMA)
        whole = sum(program.evaluate(state).values())
    except CostError:
        return
    for i, j in np.ndindex(state.shape):
        views = {name: state[name] for name in fuzz_programs.SCHEMA}
        one = Context({n: v[min(i, len(v) - 1) :, min(j, v.shape[1] - 1) :][:1, :1] for n, v in views.items()}, (1, 1))
        assert np.array_equal(sum(program.evaluate(one).values())[0, 0], whole[i, j], equal_nan=True), program.source


def outcome(text, schema, state):
    """The code of the error and the terms, one of them empty."""
    try:
        return "empty", CostProgram(text, schema)(state)
    except CostError as error:
        return error.code, {}


@pytest.mark.parametrize("seed", range(PROGRAMS))
def test_a_damaged_program_ends_in_a_reason_or_a_number(seed, schema, states, board):
    chooser = random.Random(seed)
    text = list(chooser.choice([board, fuzz_programs.Programs(seed).program()]))
    pieces = [
        "(",
        ")",
        "[",
        "]",
        ":",
        ".",
        "self",
        "**",
        "not ",
        "lambda x: ",
        "\n",
        "    ",
        "0",
        "None",
        "yield ",
        "@",
        "for ",
        " if ",
        "{",
        "}",
        "*",
        ", ",
        "'",
        "__",
        "return ",
        "np.",
        "=",
        "-",
        "1e999",
        "\x0c",
        "é",
        "#",
    ]
    for _ in range(chooser.randint(1, 6)):
        at = chooser.randrange(len(text))
        if chooser.random() < 0.5:
            text[at] = chooser.choice(pieces)
        else:
            text[at : at + chooser.randrange(30)] = chooser.choice(pieces)
    state = states(np.random.default_rng(seed), 2, 3)
    code, terms = outcome("".join(text), schema, state)
    assert code in CODES
    assert code != "internal"
    assert all(term.shape == (2, 3) and np.isfinite(term).all() for term in terms.values())
