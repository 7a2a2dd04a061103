"""An arm that does as it is told at once, for tests of the stream."""

import dataclasses

import numpy as np

from coral.contact.franka.franky_arm import ArmError, ArmState
from coral.contact.worlds.franka_cfg import FrankaCfg

START = np.array(FrankaCfg().start_rad)
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
TOOL = np.array([0.489, 0.0, 0.268])
"""The tool in the start posture, base frame."""


def arm_state(time_s=0.0, **changes):
    """A state at rest in the start posture, with no load."""
    state = ArmState(time_s, START.copy(), np.zeros(7), TOOL.copy(), DOWN, np.zeros(6), np.zeros(6), 0.08)
    return dataclasses.replace(state, **changes)


class ObedientArm:
    """Its tool is at the last target; its clock goes on by 5 ms at every reading, unless it is frozen."""

    def __init__(self):
        self.state, self.calls, self.frozen, self.dead, self.refuses = arm_state(), [], False, False, False

    def read(self):
        if self.dead:
            raise ArmError("no route to host")
        if not self.frozen:
            self.state = dataclasses.replace(self.state, time_s=self.state.time_s + 0.005)
        return self.state

    def go_to(self, joints):
        self.calls.append("go")

    def arrived(self):
        return True

    def follow(self, target):
        if self.refuses:
            raise ArmError("control has ended")
        self.calls.append(target)
        self.state = dataclasses.replace(self.state, position=np.array(target.position))

    def open_to(self, opening_m):
        self.calls.append(("open", opening_m))

    def stop(self):
        self.calls.append("stop")

    def close(self):
        self.calls.append("close")


def make_obedient_arm(address, cfg):
    """For a process that is spawned."""
    if address == "nobody":
        from coral.errors import InputError

        raise InputError("--robot", "", address, "the address of an arm")
    return ObedientArm()
