"""Interpreter for the cost programs that a language model writes: a closed language over batches of states."""

from coral.contact.cost_program.errors import CODES, CostError
from coral.contact.cost_program.limits import LimitsCfg
from coral.contact.cost_program.program import CostProgram
from coral.contact.cost_program.worker import CostWorker, WorkerCfg, WorkerCost

__all__ = ["CODES", "CostError", "CostProgram", "CostWorker", "LimitsCfg", "WorkerCfg", "WorkerCost"]
