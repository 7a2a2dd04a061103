"""Costs that a language model writes, run by a closed interpreter over batches of states."""

from coral.contact.program.errors import CODES, CostError
from coral.contact.program.limits import LimitsCfg
from coral.contact.program.program import CostProgram

__all__ = ["CODES", "CostError", "CostProgram", "LimitsCfg"]
