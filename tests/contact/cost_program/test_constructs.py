"""What else of Python and NumPy a cost may use: each construct gives what Python gives, state by state."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

from coral.contact.cost_program import CostError, CostProgram

HEAD = "from scipy.spatial.transform import Rotation as R\n"
SAME = {
    "new axis": "a = self.ee_pos[np.newaxis, :]\nb = self.box_pos[:, None]\nreturn np.sum(np.abs(a - b)) + a.shape[0]",
    "new axis in front": "return np.sum(self.ee_pos[None] * np.ones((2, 3)))",
    "ellipsis": "m = np.stack([self.ee_pos, self.box_pos])\nreturn m[..., 2][1] + self.ee_pos[..., 0] + m[0, ...][1]",
    "keepdims": (
        "m = np.stack([self.ee_pos, self.box_pos])\nu = m / np.linalg.norm(m, axis=1, keepdims=True)\n"
        "c = m - m.mean(axis=0, keepdims=True)\nreturn u[0, 0] + c[1, 2] + m.sum(keepdims=True)[0, 0]"
    ),
    "keepdims of a vector": "v = self.ee_pos\nreturn (v / v.max(keepdims=True))[0] + np.std(v, keepdims=True)[0]",
    "std and var": "return np.std(self.ee_pos) + self.box_pos.var(ddof=1) + np.std(np.eye(3), axis=0)[1]",
    "average with weights": (
        "return np.average(self.ee_pos, weights=[1.0, 2.0, self.time + 0.1]) + np.average(self.ee_pos)\n"
    ),
    "interp": "return np.interp(self.time, [0.0, 0.3, 0.6], [0, 2.0, 1.0]) + np.interp(self.ee_pos, [0, 1], [0, 1])[0]",
    "select": "d = self.time\nreturn np.select([d < 0.3, d < 0.6], [d, 2.0 * d], default=-1.0)",
    "select of vectors": "v = self.ee_pos\nreturn np.sum(np.select([v > 0.1, v > 0.0], [v, 2.0 * v], 3.0))",
    "sorted": "a, b, c = sorted(self.ee_pos)\nreturn a + 10.0 * b + 100.0 * c + sorted([3, 1, 2], reverse=True)[0]",
    "sorted keys": "d = {'b': self.time, 'a': 2.0}\nreturn sum(d[k] * (i + 1) for i, k in enumerate(sorted(d)))",
    "median and sort": "return np.median(self.ee_pos) + np.median(self.box_quat) + np.sort(self.ee_pos)[0]",
    "map": "return sum(map(abs, self.ee_pos)) + max(map(lambda x, y: x - y, self.ee_pos, self.box_pos))",
    "map into a list": "xs = list(map(lambda x: x ** 2, self.ee_pos))\nreturn xs[0] + len(xs)",
    "isinstance": (
        "x = self.ee_pos\ns = 1.0 if isinstance(x, np.ndarray) else 2.0\n"
        "s += 10.0 * isinstance(self.time, (int, float))\n"
        "s += 100.0 * isinstance([1], list) + 1000.0 * isinstance('a', str) + isinstance(None, dict)\nreturn s"
    ),
    "hypot of three": "return math.hypot(*self.ee_pos) + math.hypot(self.time, 1.0) + math.hypot(-2.0)",
    "f-string keys": "terms = {f'axis_{i:02d}{\"x\"}': abs(self.ee_pos[i]) for i in range(3)}\nreturn terms",
    "texts put together": "d = {'w' + '_' + str(1): self.time}\nreturn d['w_1']",
    "set": "return sum(1.0 for k in ['a', 'b', 'c'] if k in {'a', 'c'}) + len({1, 1, 2}) + self.time",
    "try around a norm": (
        "try:\n    u = self.ee_pos / np.linalg.norm(self.ee_pos)\nexcept ZeroDivisionError:\n    u = np.zeros(3)\n"
        "else:\n    u = 2.0 * u\nreturn u[0]"
    ),
    "try that returns": "try:\n    return float(self.time)\nexcept (TypeError, ValueError) as e:\n    return 0.0",
    "print": "print('t', self.time, f'{self.time:.2f}')\nreturn self.time",
    "while": "i, s = 0, 0.0\nwhile i < 3:\n    s += self.ee_pos[i]\n    i += 1\nreturn s",
    "while with a break": (
        "i, s = 0, 0.0\nwhile i < 10:\n    i += 1\n    if s > self.time:\n        break\n    s += 0.2\nreturn s"
    ),
    "while with a continue": (
        "xs, s = [1.0, -2.0, self.time], 0.0\nwhile len(xs) > 0:\n    x, xs = xs[0], xs[1:]\n"
        "    if x < 0.5:\n        continue\n    s += x\nreturn s"
    ),
    "while that returns": "i = 0\nwhile True:\n    i += 1\n    if i > 4:\n        return i * self.time\nreturn 0.0",
    "cumsum and diff": "return np.cumsum(self.ee_pos)[1] + np.diff(self.box_pos)[1]",
    "arange and linspace": "return np.dot(np.arange(3), self.ee_pos) + np.dot(np.linspace(0, 1, 3), self.box_pos)",
    "arange with a step": "return np.sum(np.arange(0.5, 2.0, 0.25)) + len(np.arange(5, 0, -2)) + self.time",
    "rotation": "r = R.from_quat(self.box_ori)\nreturn r.magnitude() + r.as_matrix()[0, 2] + r.apply([0, 0, 1])[1]",
    "rotation of the other order": "return R.from_quat(self.box_quat, scalar_first=True).as_quat()[3]",
    "relative rotation": "return (R.from_quat(self.box_ori) * R.from_quat(self.ee_ori).inv()).magnitude()",
    "rotation vector": "v = R.from_quat(self.box_ori).as_rotvec()\nreturn v[0] + 2.0 * v[1] + np.linalg.norm(v)",
    "euler angles": "e = R.from_quat(self.box_ori).as_euler('xyz')\nreturn e[0] + 2.0 * e[1] + 3.0 * e[2]",
    "euler angles in degrees": "e = R.from_quat(self.box_ori).as_euler('ZYX', degrees=True)\nreturn e[0] + 0.5 * e[2]",
    "from euler angles": (
        "r = R.from_euler('xyz', [0.1, self.time, 0.3])\ns = R.from_euler('z', 90, degrees=True)\n"
        "return (r * s).as_quat()[1] + r.as_euler('xyz')[1]"
    ),
    "from a rotation vector": (
        "r = R.from_rotvec(self.ee_pos)\nreturn r.as_rotvec()[0] + r.as_quat()[2] + R.identity().magnitude()"
    ),
    "rows turned": "m = np.stack([self.ee_pos, self.box_pos])\nreturn np.sum(R.from_quat(self.box_ori).apply(m)[1])",
    "turned back": "return R.from_quat(self.box_ori).apply(self.ee_pos, inverse=True)[0]",
}
REFUSED = {
    "finally": ("try:\n    x = 1.0\nfinally:\n    x = 2.0\nreturn x", "write its lines after"),
    "infinite in a try": (
        "try:\n    x = 1.0 / (self.time - self.time)\nexcept Exception:\n    x = 0.0\nreturn x",
        "guard it",
    ),
    "nan in a try": ("try:\n    x = math.acos(2.0 + self.time)\nexcept ValueError:\n    x = 0.0\nreturn x", "guard it"),
    "in place in a try": (
        "x = 1.0\ntry:\n    x /= self.time * 0.0\nexcept Exception:\n    x = 0.0\nreturn x",
        "guard it",
    ),
    "while on the state": ("x = self.time\nwhile x > 0.1:\n    x = x - 0.1\nreturn x", "for i in range"),
    "while without an end": ("while True:\n    pass\nreturn 1.0", "at most 64 turns"),
    "interp between moving points": ("return np.interp(0.1, [0, 1], [0, self.time])", "straight line"),
    "index by argmin": ("return np.argmin(self.ee_pos)", "no 'argmin'"),
    "key of sorted": ("return sorted([1, 2], key=abs)[0]", "not key="),
    "loop over a set": ("return sum(1.0 for k in {'a', 'b'})", "write a list"),
    "f-string of the state": ("return {f'{self.time}': 1.0}", "constant texts"),
    "state in a print": ("print(x := 1.0)\nreturn x", "print is ignored"),
    "third axis": ("return np.eye(2)[None][0][0][0]", "one or two axes"),
    "array of matrices": ("return np.sum(np.eye(2) * [np.eye(2), np.eye(2)])", "one or two axes"),
    "axis of a number": ("return np.var(self.time, axis=0)", "no axis 0"),
    "moving axis": ("return np.average(self.ee_pos, self.time)", "along an axis"),
    "moving order of a norm": ("return np.linalg.norm(self.ee_pos, self.time)", "ord 1, 2"),
    "axes of a number": ("return self.time[:, None]", "no entries to index"),
    "axes of a list": ("return [1.0, 2.0][:, 0]", "one axis"),
    "sum of two truth values": ("return (self.time > 0.5) + (self.time > 0.2)", "write float"),
    "two ellipses": ("return self.ee_pos[..., ...]", "one axis"),
    "other euler angles": ("return R.from_quat(self.box_ori).as_euler('zxz')[0]", "'xyz' or 'ZYX'"),
    "rotation of the wrong order": ("return R.from_quat(self.box_quat).magnitude()", "NAME_ori"),
    "rotation of a matrix": ("return R.from_matrix(np.eye(3)).magnitude()", "it has from_euler"),
    "truth as a type": ("return 1.0 if isinstance(self.box_hand_contact, bool) else 0.0", "leave this out"),
}


def program(code):
    return HEAD + "def state_cost(self):\n" + textwrap.indent(code, "    ") + "\n"


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_construct_gives_what_python_gives(case, schema, states, plainly):
    state, source = states(np.random.default_rng(len(case)), 3, 4), program(SAME[case])
    found = CostProgram(source, schema).evaluate(state).cost
    np.testing.assert_allclose(found, plainly(source, state), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_what_is_refused_names_the_way_to_write_it(case, schema, states):
    source, words = REFUSED[case]
    with pytest.raises(CostError, match=words) as caught:
        CostProgram(program(source), schema)(states(np.random.default_rng(0)))
    assert caught.value.line > 0


def test_small_rotations_stay_exact(schema, states, plainly):
    source = program(
        "v = R.from_rotvec(1e-5 * self.ee_pos)\nw = R.from_rotvec(np.zeros(3))\n"
        "return 1e5 * v.as_rotvec()[0] + w.as_rotvec()[1] + w.magnitude()"
    )
    state = states(np.random.default_rng(0), 3, 4)
    np.testing.assert_allclose(CostProgram(source, schema).evaluate(state).cost, plainly(source, state), rtol=1e-9)


def test_a_rotation_of_two_branches_is_joined(schema, states, plainly):
    source = program(
        "if self.time > 0.5:\n    r = R.from_quat(self.box_ori)\nelse:\n    r = R.from_quat(self.ee_ori)\n"
        "return r.magnitude()"
    )
    state = states(np.random.default_rng(0), 3, 4)
    np.testing.assert_allclose(CostProgram(source, schema).evaluate(state).cost, plainly(source, state), rtol=1e-9)


def test_a_handler_never_runs_in_states_where_python_would_not_go_there(schema, states, plainly):
    source = program(
        "cost = 0.0\nif self.time > 0.5:\n    try:\n        cost += 1.0 / (self.time - 0.5)\n"
        "    except ZeroDivisionError:\n        cost += 100.0\nreturn cost"
    )
    state = states(np.random.default_rng(0), 3, 4)
    np.testing.assert_allclose(CostProgram(source, schema).evaluate(state).cost, plainly(source, state), rtol=1e-9)
