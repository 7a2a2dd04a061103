"""Generated programs: the batch agrees with Python bit for bit, and broken ones end in a reason, never in a crash."""

from __future__ import annotations

import os
import random

import numpy as np
import pytest

from coral.contact.cost_program import CostError, CostProgram
from coral.contact.cost_program.errors import CODES

PROGRAMS = int(os.environ.get("CORAL_FUZZ", "60"))
NUMBERS = ["self.time", "self.gripper_opening", "self.box_pos[2]", "self.ee_pos[0]", "self.box_mass", "0.5", "2.0", "3"]
VECTORS = ["self.ee_pos", "self.box_pos", "self.board_vel", "np.array([0.1, -0.2, 0.3])"]
TRUTHS = ["self.box_hand_contact", "self.board_table_contact", "self.time > 0.5", "self.box_pos[0] < self.ee_pos[0]"]


class Writer:
    """Writes a random program whose variables are always set before they are read."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.numbers, self.vectors, self.count = list(NUMBERS), list(VECTORS), 0

    def number(self, depth=3):
        pick = self.random.randrange(9) if depth else 0
        a, b = (lambda: self.number(depth - 1)), (lambda: self.vector(depth - 1))
        if pick in (0, 1):
            return self.random.choice(self.numbers)
        if pick == 2:
            return f"({a()} {self.random.choice('+-*')} {a()})"
        if pick == 3:
            return f"({a()} / (1.0 + abs({a()})))"
        if pick == 4:
            return f"{self.random.choice(['max', 'min'])}({a()}, {a()})"
        if pick == 5:
            return f"np.{self.random.choice(['exp', 'tanh', 'sin', 'square'])}({a()})"
        if pick == 6:
            return f"np.linalg.norm({b()})"
        if pick == 7:
            return f"np.dot({b()}, {b()})"
        return f"({a()} if {self.truth(depth - 1)} else {a()})"

    def vector(self, depth=2):
        pick = self.random.randrange(4) if depth else 0
        if pick < 2:
            return self.random.choice(self.vectors)
        if pick == 2:
            return f"({self.vector(depth - 1)} {self.random.choice('+-')} {self.vector(depth - 1)})"
        return f"({self.number(depth - 1)} * {self.vector(depth - 1)})"

    def truth(self, depth=1):
        pick = self.random.randrange(4) if depth else 0
        if pick < 2:
            return self.random.choice(TRUTHS)
        if pick == 2:
            return f"({self.truth(depth - 1)} {self.random.choice(['and', 'or'])} not {self.truth(depth - 1)})"
        return f"({self.number(1)} <= {self.number(1)})"

    def block(self, indent, depth, loop=False):
        lines, numbers, vectors = [], list(self.numbers), list(self.vectors)
        for _ in range(self.random.randint(1, 4)):
            lines += self.statement(indent, depth, loop)
        self.numbers, self.vectors = numbers, vectors
        return lines

    def statement(self, indent, depth, loop):
        pad, pick = "    " * indent, self.random.randrange(10 if depth else 5)
        if pick == 0:
            self.count += 1
            line = f"{pad}x{self.count} = {self.number()}"
            self.numbers.append(f"x{self.count}")
            return [line]
        if pick == 1:
            self.count += 1
            line = f"{pad}v{self.count} = {self.vector()}"
            self.vectors.append(f"v{self.count}")
            return [line]
        if pick in (2, 3, 4):
            symbols = ["+=", "-=", "*="] if pick == 2 else ["+=", "-="]
            return [f"{pad}cost {self.random.choice(symbols)} {self.number()}"]
        if pick in (5, 6):
            other = self.block(indent + 1, depth - 1, loop)
            return [f"{pad}if {self.truth()}:", *self.block(indent + 1, depth - 1, loop), f"{pad}else:", *other]
        if pick == 7:
            return [f"{pad}for i in range({self.random.randint(1, 3)}):", *self.block(indent + 1, depth - 1, True)]
        if pick == 8:
            leave = self.random.choice(["break", "continue"]) if loop else f"return cost + {self.number()}"
            return [f"{pad}if {self.truth()}:", f"{pad}    {leave}"]
        return [f"{pad}if {self.truth()}:", *self.block(indent + 1, depth - 1, loop)]

    def program(self):
        lines = ["def state_cost(self):", "    cost = 0.0"]
        for _ in range(self.random.randint(2, 7)):
            lines += self.statement(1, 3, False)
        return "\n".join([*lines, "    return cost"])


@pytest.mark.parametrize("seed", range(PROGRAMS))
def test_a_generated_program_agrees_with_python_bit_for_bit(seed, schema, states, exactly):
    source = Writer(seed).program()
    state = states(np.random.default_rng(seed), 3, 4)
    found, wanted = CostProgram(source, schema).evaluate(state), exactly(source, state)
    assert np.array_equal(found.cost, wanted, equal_nan=True), source
    total = sum(found.terms.values())
    scale = 1.0 + sum(np.abs(term) for term in found.terms.values())
    finite = np.isfinite(wanted) & np.isfinite(scale)
    np.testing.assert_allclose((total / scale)[finite], (wanted / scale)[finite], rtol=0, atol=1e-9, err_msg=source)


def outcome(text, schema, state):
    """The code of the error and the terms, one of them empty."""
    try:
        return "empty", CostProgram(text, schema)(state)
    except CostError as error:
        return error.code, {}


@pytest.mark.parametrize("seed", range(PROGRAMS))
def test_a_damaged_program_ends_in_a_reason_or_a_number(seed, schema, states, board):
    chooser = random.Random(seed)
    text = list(chooser.choice([board, Writer(seed).program()]))
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
