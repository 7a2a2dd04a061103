"""Errors of a cost program: one exception type, and every code it may carry."""

from __future__ import annotations

CODES: dict[str, str] = {
    "empty": "there is no code in the text",
    "too_large": "the program is longer or more deeply nested than allowed",
    "syntax": "the text is not Python",
    "no_function": "there is no `def state_cost(self)`, nor one function alone of another name",
    "not_allowed": "a part of Python that costs do not have",
    "unknown_name": "a name that is neither a variable nor one of the functions",
    "unknown_state": "a quantity that the state does not have",
    "unknown_attribute": "an attribute or method that the value does not have",
    "unset": "a variable that is not set in every state in which it is read",
    "wrong_call": "a function called with arguments it does not take",
    "wrong_type": "an operation on a value it does not apply to",
    "wrong_size": "vectors whose lengths do not match, or an index outside one",
    "mixed": "a value of one kind in some states and of another kind in others",
    "shared": "a change in place that another name would see",
    "not_fixed": "a loop, index, size or key that depends on the state",
    "too_large_number": "a whole number beyond 2**53",
    "division_by_zero": "a division of Python's own numbers whose divisor is zero",
    "steps": "more steps than a cost may take",
    "memory": "more arrays or longer containers than a cost may make",
    "calls": "functions calling one another too deeply",
    "no_return": "some state gets no cost",
    "wrong_return": "something else than a number or a dict of named numbers is returned",
    "missing_state": "the batch lacks a quantity that its schema promises",
    "shape": "a term is not one number per state",
    "not_finite": "a term is nan or infinite in some state",
    "constant": "the cost is the same for every sampled rollout",
    "unreachable": "the cost leads the hand into something solid; told, not refused",
    "barrier": "the cost jumps up around what it leads the hand to, with nothing cheaper nearer",
    "raised": "a NumPy function raised an exception",
    "deadline": "the cost took too long and its process was killed",
    "killed": "the process of the cost died",
    "internal": "the interpreter itself failed",
}
LONGEST_NAME = 60


def printable(text: str, longest: int = 4000) -> str:
    """Escape what a terminal, a log or a page cannot show: control characters and lone surrogates."""
    if not text.isprintable():
        text = "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in text)
    return text[:longest]


def line_of(source: str, number: int) -> str:
    """Return the text of a line of a program, from 1; "" if there is none."""
    lines = source.split("\n")
    return lines[number - 1].strip()[:80] if 0 < number <= len(lines) else ""


def is_term_name(name: object) -> bool:
    """Check whether reports, logs and terminals can show the text as the name of a term."""
    return isinstance(name, str) and 0 < len(name) <= LONGEST_NAME and name.isprintable() and bool(name.strip())


class CostError(RuntimeError):
    """A cost that cannot be used, with the reason that is sent back to its author.

    The code is one of CODES; the text names the fault, and the accepted form; the line, `shown`, counts from 1: it is 0
    if the fault is in no single line.
    """

    def __init__(self, code: str, text: str, line: int = 0, shown: str = "") -> None:
        self.code, self.text, self.line, self.shown = code, printable(text), line, printable(shown)
        super().__init__(self.code, self.text, line, self.shown)

    def __str__(self) -> str:
        if not self.line:
            return self.text
        return f"line {self.line}{f' (`{self.shown}`)' if self.shown else ''}: {self.text}"
