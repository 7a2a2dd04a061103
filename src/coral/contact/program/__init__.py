"""Costs that a language model writes, run by a closed interpreter over batches of states."""

from coral.contact.program.errors import CODES, CostError
from coral.contact.program.fault import Fault, VerifyCfg
from coral.contact.program.lastgood import LastGoodCost
from coral.contact.program.limits import LimitsCfg
from coral.contact.program.program import CostProgram
from coral.contact.program.verify import verify_cost
from coral.contact.program.worker import CostWorker, WorkerCfg, WorkerCost

__all__ = [
    "CODES",
    "CostError",
    "CostProgram",
    "CostWorker",
    "Fault",
    "LastGoodCost",
    "LimitsCfg",
    "VerifyCfg",
    "WorkerCfg",
    "WorkerCost",
    "verify_cost",
]
