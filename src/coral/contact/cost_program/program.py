"""A cost program as a cost of the planner: text in, named terms over a batch of states out."""

from __future__ import annotations

import numpy as np

from coral.contact.cost.context import Array, Context, Schema, Terms
from coral.contact.cost_program.calls import leave, outcome
from coral.contact.cost_program.errors import LONGEST_NAME, CostError, is_term_name, line_of
from coral.contact.cost_program.limits import MOST_TERMS, Meter
from coral.contact.cost_program.machine import Machine, filled
from coral.contact.cost_program.parse import parse
from coral.contact.cost_program.statements import run_block
from coral.contact.cost_program.values import Function, Scope, State, Value, is_number, kind


class CostProgram:
    """A cost program that is checked and ready to be evaluated in this process.

    It satisfies `coral.contact.cost.context.Cost`. Code for one state is run for all states at once: a number is an
    array over the batch, a vector has one more axis, and an `if` on the state runs both branches and joins them. The
    source may be a model's reply that contains `def state_cost(self)`.

    Raises:
        CostError: The text is not a program of the accepted language.
    """

    def __init__(self, source: str, schema: Schema, name: str = "program") -> None:
        self.name, self.schema = name, dict(schema)
        self.parsed = parse(source)
        self.source = self.parsed.source
        self.reads = sorted(self.parsed.attributes & self.schema.keys())

    def __call__(self, state: Context) -> Terms:
        """Return the terms of every state, each Shape=(K, H).

        Raises:
            CostError: The cost cannot be evaluated on this batch, or is not finite.
        """
        terms = self.evaluate(state)
        if not np.isfinite(sum(terms.values())).all():
            raise self.not_finite(state)
        return terms

    def evaluate(self, state: Context, meter: Meter | None = None) -> Terms:
        """Return the terms of every state, finite or not; `meter` tells what it took.

        Raises:
            CostError: The cost cannot be evaluated on this batch.
        """
        meter = meter or Meter(state)
        try:
            with np.errstate(all="ignore"):
                return self._run(meter)
        except CostError as error:
            raise CostError(error.code, error.text, error.line, self.line(error.line)) from None
        except RecursionError:
            raise CostError("too_large", "too deeply nested", meter.line, self.line(meter.line)) from None
        except MemoryError:
            raise CostError("memory", "the program needs too much memory", meter.line, self.line(meter.line)) from None

    def not_finite(self, state: Context) -> CostError:
        """Make the error that names where the cost stops being finite."""
        meter = Meter(state, watched=True)
        self.evaluate(state, meter)
        if meter.lost is None:
            return CostError("not_finite", "the cost is nan or infinite in some state")
        line, text = meter.lost
        return CostError(
            "not_finite",
            f"`{text}` is nan or infinite in some state; guard divisions, logarithms, roots "
            "and arc cosines with max, min or a small number",
            line,
            self.line(line),
        )

    def line(self, number: int) -> str:
        """Return the text of a line."""
        return line_of(self.source, number)

    def _run(self, meter: Meter) -> Terms:
        own_names = self.parsed.own_names
        module = Scope(None, own_names[id(self.parsed.tree)])
        machine = Machine(meter, self.schema, own_names, run_block, [module])
        if not run_block(machine, self.parsed.tree.body):
            raise meter.fault("syntax", "not Python: `return`, `break` or `continue` outside a function")
        entry = self.parsed.entry
        function = module.variables[entry.name]
        assert isinstance(function, Function)
        variables: dict[str, Value] = {**function.defaults, function.arguments[0]: State()}
        frame = Scope(module, function.names, variables)
        if "terms" not in frame.names and "terms" not in module.names:
            variables["terms"] = {}
        machine.stack.append(frame)
        if run_block(machine, entry.body):
            filled_terms = frame.variables.get("terms")
            leave(machine, filled_terms if isinstance(filled_terms, dict) and filled_terms else None)
        value = outcome(machine, frame, entry.name)
        meter.line = 0
        return {name: self._batch(meter, term) for name, term in self._terms(meter, value).items()}

    def _terms(self, meter: Meter, value: Value) -> dict[str, Value]:
        if value is None:
            raise meter.fault("no_return", "some state reaches the end of the function without a return")
        if is_number(value):
            return {"cost": value}
        if not isinstance(value, dict):
            raise meter.fault("wrong_return", f"the cost is a number or a dict of named numbers, not {kind(value)}")
        if len(value) > MOST_TERMS:
            raise meter.fault("memory", f"a cost has at most {MOST_TERMS} terms")
        found: dict[str, Value] = {}
        for name, one in value.items():
            term = filled(meter, one, 0.0)
            if not is_number(term) or not isinstance(name, str):
                raise meter.fault("wrong_return", f"the term {_short(name)} is {kind(term)}, not a number")
            if not is_term_name(name):
                raise meter.fault(
                    "wrong_return",
                    f"the name of a term has 1 to {LONGEST_NAME} printable characters, not {_short(name)}",
                )
            found[name] = term
        return found

    def _batch(self, meter: Meter, value: Value) -> Array:
        meter.made()
        return np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), meter.context.shape))


def _short(name: Value) -> str:
    text = ascii(name)
    return text if len(text) <= LONGEST_NAME else f"{text[:LONGEST_NAME]}..."
