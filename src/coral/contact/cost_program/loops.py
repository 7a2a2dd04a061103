"""Running loops, with the states that leave them early kept apart."""

from __future__ import annotations

from typing import Any

from coral.contact.cost_program.assigning import assign_to
from coral.contact.cost_program.expressions import evaluate
from coral.contact.cost_program.iterating import entries
from coral.contact.cost_program.limits import Mask
from coral.contact.cost_program.machine import Loop, Machine


def run_for(machine: Machine, node: Any) -> bool:
    """Run a loop over the entries of a container."""
    source = evaluate(machine, node.iter)
    items = entries(machine.meter, source)
    if len(items) > machine.meter.cfg.loop:
        raise machine.meter.fault("steps", f"a loop has at most {machine.meter.cfg.loop} turns")
    outer, exits, loop, falls = machine.meter.mask, len(machine.frame.exits), Loop((source,)), True
    machine.loops.append(loop)
    machine.running.append(loop)
    for turn, item in enumerate(items):
        machine.meter.step(node.lineno)
        loop.continues, loop.turn = [], turn
        assign_to(machine, node.target, item)
        falls = machine.run(machine, node.body)
        falls = machine.collect(loop.continues, falls)
        if not falls:
            break
    return _end(machine, loop, falls, exits, outer)


def _end(machine: Machine, loop: Loop, falls: bool, exits: int, outer: Mask | None) -> bool:
    machine.loops.pop()
    machine.running.pop()
    falls = machine.collect(loop.breaks, falls)
    if falls and len(machine.frame.exits) == exits:
        machine.meter.mask = outer
    return falls


def leave_loop(machine: Machine, node: Any) -> bool:
    """Run `break`: the active states leave the loop."""
    machine.exited += 1
    machine.loops[-1].breaks.append((machine.meter.mask, machine.snapshot()))
    return False


def next_turn(machine: Machine, node: Any) -> bool:
    """Run `continue`: the active states wait for the next iteration."""
    machine.exited += 1
    machine.loops[-1].continues.append((machine.meter.mask, machine.snapshot()))
    return False
