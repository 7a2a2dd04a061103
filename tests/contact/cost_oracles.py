"""States to evaluate costs on, and an oracle that runs a program state by state in plain Python."""

from __future__ import annotations

import importlib.util
import math
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost.schema import HAND, object_quantities

spec = importlib.util.spec_from_file_location(
    "fuzz_programs", Path(__file__).parents[2] / "benchmarks" / "fuzz_programs.py"
)
fuzz_programs = importlib.util.module_from_spec(spec)
sys.modules[spec.name] = fuzz_programs
spec.loader.exec_module(fuzz_programs)

SCHEMA = {
    **HAND,
    **object_quantities("board", ["handle"], ["table", "wall"], ["box"]),
    **object_quantities("box", [], ["table", "wall"], ["board"]),
}

BOARD = textwrap.dedent("""
    def state_cost(self):
        # helpers
        def squash(x): return 1.0 / (1.0 + np.exp(-x))
        unit = lambda v: max(0.0, min(1.0, float(v)))
        hand_pos = self.ee_pos
        cost = 0.0

        pos, speed, spin = self.board_pos, self.board_vel, self.board_angvel
        forward = np.array([1.0, 0.2, 0.0], dtype=float)
        forward = forward / (np.linalg.norm(forward) + 1e-9)
        edge = self.board_init_pos[0] + 0.2
        wanted = 0.05
        grip = self.board_handle_pos
        press = pos + 0.5 * wanted * forward

        # phase
        beyond = np.dot(grip - np.array([edge, pos[1], pos[2]]), forward)
        done = unit(beyond / max(1e-6, wanted))
        motion = np.linalg.norm(speed) + 0.4 * np.linalg.norm(spin)
        calm = unit(np.exp(-2.5 * motion))
        s = squash(10.0 * (0.6 * done + 0.4 * calm - 0.5))  # 0 while pushing, 1 while lifting

        # follow the point of the phase
        cost += 11.0 * (1.0 - s) * np.linalg.norm(hand_pos - press)
        cost += 19.0 * s * np.linalg.norm(hand_pos - grip)
        # progress
        cost -= 15.0 * (1.0 - s) * done
        touching = self.board_hand_contact or self.box_hand_contact
        cost += (20.0 * (1.0 - s)) * (0.0 if touching else 1.0)  # keep touching
        cost += (25.0 * s) * quat_angle(self.ee_quat, self.board_init_quat)  # align
        moved = pos - np.array(self.board_init_pos)
        along = np.dot(moved, forward) * forward
        cost += 9.0 * (1.0 - s) * np.linalg.norm(moved - along)  # drift
        cost += 7.0 * (1.0 - s) * quat_angle(self.board_quat, self.board_init_quat)  # rotation
        lift = pos[2] - self.board_init_pos[2]
        cost -= (30.0 * s) * max(0.0, float(lift))  # lift
        cost += 0.001 * np.linalg.norm(self.last_action) ** 2  # effort
        cost += 0.01 * self.current_step  # time
        return cost
""")


def make_states(rng, k=4, h=5):
    values = {}
    for name, quantity in SCHEMA.items():
        shape = (1, 1) if quantity.constant else (k, h)
        if name.endswith("_seen"):
            found = np.ones(shape)
        elif quantity.truth:
            found = (rng.random(shape) < 0.5).astype(float)
        elif quantity.size:
            found = rng.normal(size=(*shape, quantity.size)) * 0.3
        else:
            found = rng.random(shape)
        if name.endswith("_quat"):
            found = found / np.linalg.norm(found, axis=-1, keepdims=True)
        values[name] = found
    return Context(values, (k, h))


class Self:
    """`self` of one state."""

    def __init__(self, state, i, j, number, vector):
        for name, quantity in SCHEMA.items():
            full = np.broadcast_to(state[name], (*state.shape, *state[name].shape[2:]))[i, j]
            if quantity.size:
                setattr(self, name, vector(number(x) for x in full))
            else:
                setattr(self, name, bool(full) if quantity.truth else number(full))


def near(distance, scale):
    return np.exp(-((distance / scale) ** 2))


def quat_matrix(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


REAL = {
    "norm": np.linalg.norm,
    "dist": lambda a, b: np.linalg.norm(np.subtract(a, b)),
    "clip": np.clip,
    "clip01": lambda x: np.clip(x, 0.0, 1.0),
    "sigmoid": lambda x: 1 / (1 + np.exp(-x)),
    "near": near,
    "exp": np.exp,
    "sqrt": np.sqrt,
    "tanh": np.tanh,
    "dot": np.dot,
    "cross": np.cross,
    "quat_angle": lambda a, b: 2 * np.arccos(min(1.0, abs(np.dot(a, b)))),
    "quat_axis": lambda q, axis: quat_matrix(q)[:, axis],
    "quat_rotate": lambda q, v: quat_matrix(q) @ v,
}


def run_per_state(source, state, namespace, number, vector, entry="state_cost"):
    """The cost of every state by Python itself: for programs of these tests only, never for a model's."""
    found = np.zeros(state.shape)
    code = compile(source, "<test>", "exec")
    for i in range(state.shape[0]):
        for j in range(state.shape[1]):
            one = Self(state, i, j, number, vector)
            names = dict(namespace)
            exec(code, names)
            value = names[entry](one)
            value = sum(value.values()) if isinstance(value, dict) else value
            found[i, j] = value
    return found


@pytest.fixture(scope="session")
def schema():
    return SCHEMA


@pytest.fixture
def states():
    return make_states


@pytest.fixture(scope="session")
def board():
    return BOARD


@pytest.fixture(scope="session")
def plainly():
    """Runs a program state by state in Python with numpy itself; sums may round differently."""

    def run(source, state, entry="state_cost"):
        with np.errstate(all="ignore"):
            return run_per_state(
                source, state, {"np": np, "math": math, **REAL}, np.float64, lambda items: np.array(list(items)), entry
            )

    return run
