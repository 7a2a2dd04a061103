"""Interpreter for the cost programs that a language model writes: a closed language over batches of states.

Whatever cannot be evaluated raises `CostError`, with its line and what to write instead. The confined process imports
this package: its master is in `worker`, so that it starts in half the time.
"""

from coral.contact.cost_program.errors import CODES, CostError
from coral.contact.cost_program.program import CostProgram

__all__ = ["CODES", "CostError", "CostProgram"]
