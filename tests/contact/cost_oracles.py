"""States to evaluate costs on, and two oracles that run a program state by state in plain Python."""

from __future__ import annotations

import math
import operator
import textwrap
import types

import numpy as np
import pytest

from coral.contact.cost.context import Context
from coral.contact.cost.schema import HAND, object_quantities

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
        if quantity.truth:
            found = (rng.random(shape) < 0.5).astype(float)
        elif quantity.size:
            found = rng.normal(size=(*shape, quantity.size)) * 0.3
        else:
            found = rng.random(shape)
        if name.endswith("_quat"):
            found = found / np.linalg.norm(found, axis=-1, keepdims=True)
        values[name] = found
    return Context(values, (k, h))


class Num:
    """One number, on which every operation is numpy's on an array of one entry, as the batch's are on many."""

    def __init__(self, v):
        self.v = np.asarray(v, dtype=float).reshape(1, 1)

    def __bool__(self):
        return bool(self.v[0, 0] != 0)

    def __neg__(self):
        return Num(-self.v)

    def __abs__(self):
        return Num(np.abs(self.v))


def raw(x):
    return x.v if isinstance(x, Num) else x


def _operate(function, compares):
    def forward(a, b):
        if not isinstance(b, Num | int | float):
            return NotImplemented
        found = function(raw(a), raw(b))
        return bool(found[0, 0]) if compares else Num(found)

    def backward(a, b):
        return Num(function(raw(b), raw(a)))

    return forward, backward


for _word in ("add", "sub", "mul", "truediv", "floordiv", "mod", "pow"):
    _forward, _backward = _operate(getattr(operator, _word), False)
    setattr(Num, f"__{_word}__", _forward)
    setattr(Num, f"__r{_word}__", _backward)
for _word in ("lt", "le", "gt", "ge", "eq", "ne"):
    setattr(Num, f"__{_word}__", _operate(getattr(operator, _word), True)[0])


class Row:
    """A vector of such numbers."""

    def __init__(self, items):
        self.items = tuple(items)

    def __getitem__(self, i):
        return Row(self.items[i]) if isinstance(i, slice) else self.items[i]

    def __iter__(self):
        return iter(self.items)

    def __len__(self):
        return len(self.items)

    def __neg__(self):
        return Row(-x for x in self)

    def copy(self):
        return Row(self.items)


def _rowwise(function):
    def forward(a, b):
        return Row(map(function, a, b)) if isinstance(b, Row | list | tuple) else Row(function(x, b) for x in a)

    def backward(a, b):
        return Row(map(function, b, a)) if isinstance(b, Row | list | tuple) else Row(function(b, x) for x in a)

    return forward, backward


for _word in ("add", "sub", "mul", "truediv", "pow"):
    _forward, _backward = _rowwise(getattr(operator, _word))
    setattr(Row, f"__{_word}__", _forward)
    setattr(Row, f"__r{_word}__", _backward)


def ufunc(name):
    function = getattr(np, name)

    def call(*args):
        if any(isinstance(a, Row) for a in args):
            n = next(len(a) for a in args if isinstance(a, Row))
            return Row(call(*(a[i] if isinstance(a, Row) else a for a in args)) for i in range(n))
        if not any(isinstance(a, Num) for a in args):
            return float(function(*(np.float64(a) for a in args)))
        return Num(function(*(raw(a) for a in args)))

    return call


def fold(items):
    items = list(items)
    found = items[0]
    for item in items[1:]:
        found = found + item
    return found


def dot(a, b):
    return fold(x * y for x, y in zip(a, b, strict=True))


def norm(v):
    return ufunc("sqrt")(fold(x * x for x in v))


def xyzw_difference(a, b):
    """The shorter rotation from a to b, (x, y, z, w), in the same order of operations as the interpreter."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    if aw * bw + ax * bx + ay * by + az * bz < 0.0:
        bx, by, bz, bw = -bx, -by, -bz, -bw
    cw, cx, cy, cz = aw, -ax, -ay, -az
    return Row(
        (
            bw * cx + bx * cw + by * cz - bz * cy,
            bw * cy - bx * cz + by * cw + bz * cx,
            bw * cz + bx * cy - by * cx + bz * cw,
            bw * cw - bx * cx - by * cy - bz * cz,
        )
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


def exact_modules():
    """`np` and `math` for Num and Row, whose every step is one numpy operation on one entry."""
    functions = {
        name: ufunc(name)
        for name in (
            "sqrt",
            "exp",
            "log",
            "tanh",
            "sin",
            "cos",
            "arccos",
            "abs",
            "maximum",
            "minimum",
            "arctan2",
            "square",
            "sign",
        )
    }

    def array(x, dtype=None):
        return Row(x) if isinstance(x, Row | list | tuple) else x

    def clip(x, low, high):
        return functions["minimum"](functions["maximum"](x, low), high)

    numpy = types.SimpleNamespace(
        **functions,
        array=array,
        dot=dot,
        clip=clip,
        sum=fold,
        pi=math.pi,
        where=lambda c, a, b: a if c else b,
        linalg=types.SimpleNamespace(norm=norm),
    )
    maths = types.SimpleNamespace(
        **functions, acos=functions["arccos"], fabs=functions["abs"], pi=math.pi, atan2=functions["arctan2"]
    )
    return numpy, maths


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
            if isinstance(value, dict):
                value = fold(value.values()) if value else 0.0
            value = value[0] if isinstance(value, tuple) else value
            found[i, j] = raw(value)[0, 0] if isinstance(value, Num) else value
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
def exactly():
    """Runs a program state by state so that every bit should agree."""

    def run(source, state):
        numpy, maths = exact_modules()
        with np.errstate(all="ignore"):
            return run_per_state(source, state, {"np": numpy, "math": maths, "float": lambda x=0.0: x}, Num, Row)

    return run


@pytest.fixture(scope="session")
def plainly():
    """Runs a program state by state in Python with numpy itself; sums may round differently."""

    def run(source, state, entry="state_cost"):
        with np.errstate(all="ignore"):
            return run_per_state(
                source, state, {"np": np, "math": math, **REAL}, np.float64, lambda items: np.array(list(items)), entry
            )

    return run
