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
        hand = p.getLinkState(self.panda, self.grasp_link, computeForwardKinematics=True, physicsClientId=self.cid)
        hand_pos = np.array(hand[0])
        hand_ori = hand[1]
        cost = 0.0

        pos, ori = p.getBasePositionAndOrientation(self.board, physicsClientId=self.cid)
        pos = np.array(pos)
        speed, spin = p.getBaseVelocity(self.board, physicsClientId=self.cid)
        forward = np.array(getattr(self, 'push_direction', [1.0, 0.2, 0.0]), dtype=float)
        forward /= (np.linalg.norm(forward) + 1e-9)
        edge = getattr(self, 'edge_x', self.board_init_pos[0] + 0.2)
        wanted = getattr(self, 'overhang', 0.05)
        grip = np.array(getattr(self, 'board_handle_pos', pos), dtype=float)
        press = np.array(getattr(self, 'press_point', pos + 0.5 * wanted * forward), dtype=float)

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
        touching = bool(getattr(self, 'in_contact', True))
        cost += (20.0 * (1.0 - s)) * (0.0 if touching else 1.0)  # keep touching
        if hasattr(self, 'board_init_ori') and self.board_init_ori is not None:
            turn = p.getDifferenceQuaternion(hand_ori, self.board_init_ori)
            c = max(-1.0, min(1.0, float(turn[3])))
            cost += (25.0 * s) * (2.0 * math.acos(c))  # align
        moved = pos - np.array(self.board_init_pos)
        along = np.dot(moved, forward) * forward
        cost += 9.0 * (1.0 - s) * np.linalg.norm(moved - along)  # drift
        yaw = p.getDifferenceQuaternion(ori, self.board_init_ori)
        cost += 7.0 * (1.0 - s) * 2.0 * math.acos(max(-1.0, min(1.0, float(yaw[3]))))  # rotation
        lift = pos[2] - self.board_init_pos[2]
        cost -= (30.0 * s) * max(0.0, float(lift))  # lift
        if hasattr(self, 'last_action'):
            cost += 0.001 * np.linalg.norm(self.last_action) ** 2  # effort
        cost += 0.01 * getattr(self, 'current_step', 0)  # time
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


def xyzw_difference(a, b):
    """The shorter rotation from a to b, (x, y, z, w)."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    if aw * bw + ax * bx + ay * by + az * bz < 0.0:
        bx, by, bz, bw = -bx, -by, -bz, -bw
    cw, cx, cy, cz = aw, -ax, -ay, -az
    return np.array(
        [
            bw * cx + bx * cw + by * cz - bz * cy,
            bw * cy - bx * cz + by * cw + bz * cx,
            bw * cz + bx * cy - by * cx + bz * cw,
            bw * cw - bx * cx - by * cy - bz * cz,
        ]
    )


class Self:
    """`self` of one state, the schema's quantities and the paper's names."""

    def __init__(self, state, i, j, number, vector):
        for name, quantity in SCHEMA.items():
            full = np.broadcast_to(state[name], (*state.shape, *state[name].shape[2:]))[i, j]
            if quantity.size:
                setattr(self, name, vector(number(x) for x in full))
            else:
                setattr(self, name, bool(full) if quantity.truth else number(full))
            if name.endswith("_quat"):
                w, x, y, z = getattr(self, name)
                setattr(self, name.removesuffix("_quat") + "_ori", vector((x, y, z, w)))
        self.panda, self.board, self.box, self.grasp_link, self.cid = "ee", "board", "box", 0, 0
        self.table, self.wall = "table", "wall"
        self.in_contact = self.board_hand_contact or self.box_hand_contact


class Bullet:
    """`p` of one state."""

    def __init__(self, state):
        self.state = state
        self.getDifferenceQuaternion = xyzw_difference

    def getLinkState(self, body, link, **_):
        s = self.state
        return s.ee_pos, s.ee_ori, None, None, s.ee_pos, s.ee_ori, s.ee_vel, s.ee_angvel

    def getBasePositionAndOrientation(self, body, **_):
        return getattr(self.state, f"{body}_pos"), getattr(self.state, f"{body}_ori")

    def getBaseVelocity(self, body, **_):
        return getattr(self.state, f"{body}_vel"), getattr(self.state, f"{body}_angvel")

    def getContactPoints(self, a, b):
        names = {a: b, b: a}
        for thing in ("board", "box"):
            if thing in names:
                other = "hand" if names[thing] == "ee" else names[thing]
                return [0] * getattr(self.state, f"{thing}_{other}_contact")
        return []


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
            names = {**namespace, "p": Bullet(one)}
            exec(code, names)
            value = names[entry](one)
            value = sum(value.values()) if isinstance(value, dict) else value
            found[i, j] = value[0] if isinstance(value, tuple) else value
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
