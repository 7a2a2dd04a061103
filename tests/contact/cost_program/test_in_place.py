"""Names for one value: a change in place gives what Python gives, or is refused with the way to write it."""

from __future__ import annotations

import os
import textwrap

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from coral.contact.cost_program import CostError, CostProgram

EXAMPLES = int(os.environ.get("CORAL_FUZZ", "60"))


def program(code):
    return "def state_cost(self):\n" + textwrap.indent(textwrap.dedent(code).strip("\n"), "    ") + "\n"


REFUSED = {
    "repeated list": "L = [np.zeros(2)] * 2\nL[0][0] = 1.0\nreturn L[1][0]",
    "entry of a dict": "v = np.zeros(2)\nd = {'p': v}\nd['p'] += 1.0\nreturn v[0]",
    "row": "m = np.zeros((2, 2))\nr = m[0]\nm[0][1] = 3.0\nreturn r[1]",
    "row by two indices": "m = np.zeros((2, 2))\nr = m[0]\nm[0, 1] = 3.0\nreturn r[1]",
    "rows of a loop": "m = np.zeros((2, 2))\nfor r in m:\n    r += 1.0\nreturn m[0, 0]",
    "slice": "v = np.zeros(3)\nw = v[:2]\nv[0] = 1.0\nreturn w[0]",
    "two reads": "v = self.ee_pos\nu = self.ee_pos\nv -= 1.0\nreturn u[0]",
    "new axis": "v = np.zeros(2)\nm = v[:, None]\nm[0, 0] = 1.0\nreturn v[0]",
    "ternary": "a, b = np.zeros(2), np.ones(2)\nw = a if self.time > 0.5 else b\nw += 1.0\nreturn a[0]",
    "both branches": (
        "a = np.zeros(2)\nif self.time > 0.5:\n    b = a\nelse:\n    b = np.ones(2)\nb += 1.0\nreturn a[0]"
    ),
    "argument": "def f(v):\n    v[0] = 1.0\na = np.zeros(2)\nf(a)\nreturn a[0]",
    "default": "def f(v=np.zeros(2)):\n    v += 1.0\n    return v[0]\nf()\nreturn f()",
    "closure": (
        "def make():\n    v = np.zeros(2)\n    def get():\n        return v[0]\n    return get, v\n"
        "get, w = make()\nw[0] = 5.0\nreturn get()"
    ),
    "method kept": "d = {'a': 1.0}\ng = d.get\nd['a'] = 2.0\nreturn g('a')",
    "values kept": "d = {'a': 1.0}\nvs = d.values()\nd['a'] = 2.0\nreturn sum(vs)",
    "zip kept": "L = [1.0]\nz = zip(L, L)\nL[0] = 2.0\nreturn sum(a for a, b in z)",
    "loop ahead": "L = [1.0, 2.0]\ns = 0.0\nfor i, x in enumerate(L):\n    L[1] = 9.0\n    s += x\nreturn s",
    "loop that grows": "L = [1.0]\nfor x in L:\n    if len(L) < 3:\n        L.append(2.0)\nreturn len(L)",
    "operand that waits": "v = np.zeros(2)\ndef f():\n    v[0] = 5.0\n    return v\nw = v + f()\nreturn w[0]",
    "argument that waits": (
        "v = np.zeros(2)\ndef f():\n    v[0] = 5.0\n    return 0.0\nreturn np.dot(v, [1.0 + f(), 1.0])"
    ),
    "extended by itself": "x = [1.0] * 700\nx.extend(x)\nreturn len(x)",
    "list in a list": "a = [1.0]\nb = [a, 2.0]\na.append(3.0)\nreturn len(b[0])",
    "row of a stack of rows": "m = np.zeros((2, 2))\nL = [m[0]]\nm += 1.0\nreturn L[0][0]",
    "copy that nobody sees": "L = [1.0, 2.0]\nL[:][0] = 9.0\nreturn L[0]",
    "picked copy": "v = np.zeros(3)\nv[[0, 1]][0] = 5.0\nreturn v[0]",
}
SAME = {
    "loop that sets what it passed": (
        "L = [self.time, 2.0]\nfor i, x in enumerate(L):\n    L[i] = 2.0 * x\nreturn L[0] + L[1]"
    ),
    "loop over a dict": (
        "d = {'a': self.time, 'b': 2.0}\nfor k, x in d.items():\n    d[k] = 2.0 * x\nreturn d['a'] + d['b']"
    ),
    "in place in a branch": (
        "v = np.ones(2)\nif self.time > 0.5:\n    v[0] = 5.0\n    v *= 2.0\nreturn v[0] + 10.0 * v[1]"
    ),
    "quaternion in place": "q = self.box_quat.copy()\nq /= np.linalg.norm(q)\nq[1:] *= -1.0\nreturn q[0] + 2.0 * q[3]",
}


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_a_change_that_another_name_would_see_is_refused(case, schema, states):
    with pytest.raises(CostError) as caught:
        CostProgram(program(REFUSED[case]), schema)(states(np.random.default_rng(0)))
    assert caught.value.code in ("shared", "memory", "wrong_type", "wrong_size")
    assert caught.value.line > 0


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_change_that_no_other_name_sees_gives_what_python_gives(case, schema, states, plainly):
    state, source = states(np.random.default_rng(1)), program(SAME[case])
    np.testing.assert_allclose(CostProgram(source, schema).evaluate(state).cost, plainly(source, state), rtol=1e-12)


VECTORS, MATRICES, LISTS, TABLES = ("u", "v", "w"), ("m", "n"), ("K", "L"), ("d", "e")
START = """
u, v, w = np.array([1.0, 2.0]), np.array([self.time, 4.0]), np.zeros(2)
m, n = np.array([[5.0, 6.0], [7.0, self.time]]), np.ones((2, 2))
K, L = [u + 0.0, v + 0.0], [np.array([8.0, 9.0]), np.zeros(2)]
d, e = {'a': u * 2.0, 'b': v * 3.0}, {'a': np.ones(2), 'b': np.zeros(2)}
def bump():
    u[0] = u[0] + 1.0
    return u
def put(x):
    K[0] = x
    return 1.0
def fill(x):
    x[0] = 3.0
    return x
"""
END = """
s = 0.0
i = 1.0
for x in [u, v, w, m[0], m[1], n[0], n[1], K[0], K[1], L[0], L[1], d['a'], d['b'], e['a'], e['b']]:
    s = s + i * x[0] + 1.7 * i * x[1]
    i = i * 1.3
return s
"""
NUMBER = st.sampled_from(["2.0", "self.time", "u[0]", "m[1, 0]", "v[1]", "0.5"])
INDEX = st.sampled_from(["0", "1", "-1"])
KEY = st.sampled_from(["'a'", "'b'"])


def _vector_place():
    """What holds a vector and can be assigned to."""
    return st.one_of(
        st.sampled_from(VECTORS),
        st.builds("{}[{}]".format, st.sampled_from(MATRICES + LISTS), INDEX),
        st.builds("{}[{}]".format, st.sampled_from(TABLES), KEY),
    )


def _vector():
    place = _vector_place()
    return st.one_of(
        place,
        st.builds("{}.copy()".format, place),
        st.builds("{} + {}".format, place, place),
        st.builds("{}[::-1]".format, place),
        st.builds("np.asarray({})".format, place),
        st.builds("np.array({})".format, place),
        st.builds("({} if self.time > 0.5 else {})".format, place, place),
        st.builds("{}.T[{}]".format, st.sampled_from(MATRICES), INDEX),
        st.builds("{}[:, {}]".format, st.sampled_from(MATRICES), INDEX),
        st.builds("{}.ravel()[1:3]".format, st.sampled_from(MATRICES)),
        st.builds("{}.reshape(4)[:2]".format, st.sampled_from(MATRICES)),
        st.builds("fill({}.copy())".format, place),
        st.builds("fill({})".format, place),
        st.just("bump()"),
        st.builds("{} + bump()".format, place),
    )


def _matrix():
    return st.one_of(
        st.sampled_from(MATRICES),
        st.builds("{}.T".format, st.sampled_from(MATRICES)),
        st.builds("np.stack([{}, {}])".format, _vector_place(), _vector_place()),
        st.builds("np.array([{}, {}])".format, _vector_place(), _vector_place()),
        st.builds("{}.copy()".format, st.sampled_from(MATRICES)),
        st.builds("{}[::-1]".format, st.sampled_from(MATRICES)),
    )


SIMPLE = st.one_of(
    st.builds("{} = {}".format, _vector_place(), _vector()),
    st.builds("{} {}= {}".format, _vector_place(), st.sampled_from("+-*"), st.one_of(_vector(), NUMBER)),
    st.builds("{}[{}] = {}".format, _vector_place(), INDEX, NUMBER),
    st.builds("{}[{}] += {}".format, _vector_place(), INDEX, NUMBER),
    st.builds("{} = {}".format, st.sampled_from(MATRICES), _matrix()),
    st.builds("{} *= {}".format, st.sampled_from(MATRICES), NUMBER),
    st.builds("{}[{}, {}] = {}".format, st.sampled_from(MATRICES), INDEX, INDEX, NUMBER),
    st.builds("{}[:, {}] = {}".format, st.sampled_from(MATRICES), INDEX, st.one_of(NUMBER, _vector_place())),
    st.builds(
        "{} = {}".format, st.sampled_from(LISTS), st.sampled_from(["K", "L", "K[:]", "list(L)", "[u, v]", "[w] * 2"])
    ),
    st.builds(
        "{} = {}".format, st.sampled_from(TABLES), st.sampled_from(["d", "e", "d.copy()", "{'a': u, 'b': K[0]}"])
    ),
    st.builds("put({})".format, _vector()),
    st.builds("s = put({})".format, _vector_place()),
    st.builds("{}[1:] = [{}]".format, st.sampled_from(LISTS), _vector_place()),
    st.builds("{}.append({})".format, st.sampled_from(LISTS), _vector_place()),
    st.builds("{}.update({})".format, st.sampled_from(TABLES), st.sampled_from(TABLES)),
)
BLOCK = st.lists(SIMPLE, min_size=1, max_size=3).map("\n".join)
STATEMENT = st.one_of(
    SIMPLE,
    SIMPLE,
    st.builds(lambda a: "if self.time > 0.5:\n" + textwrap.indent(a, "    "), BLOCK),
    st.builds(
        lambda a, b: f"if self.box_hand_contact:\n{textwrap.indent(a, '    ')}\nelse:\n{textwrap.indent(b, '    ')}",
        BLOCK,
        BLOCK,
    ),
    st.builds(
        lambda x, a: f"for x in {x}:\n{textwrap.indent(a, '    ')}",
        st.sampled_from(["K", "L", "m", "d.values()", "[u, v]"]),
        st.one_of(BLOCK, st.sampled_from(["x += 1.0", "x = x * 2.0", "x[0] = 4.0", "v = x", "K[1] = x"])),
    ),
    st.builds(
        lambda x, a: f"for i, x in enumerate({x}):\n{textwrap.indent(a, '    ')}",
        st.sampled_from(["K", "L", "m", "n"]),
        st.sampled_from(["K[i] = 2.0 * x", "m[i] = x", "L[i] += 1.0", "n[i, 0] = 4.0", "K[1] = w", "m[1] = 3.0"]),
    ),
)
seen = {"run": 0, "refused": 0}


def outcome(source, schema, state):
    """The code of a refusal, or the cost."""
    try:
        return None, CostProgram(source, schema).evaluate(state).cost
    except CostError as error:
        return error.code, None


@settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize="CORAL_FUZZ" not in os.environ,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(st.lists(STATEMENT, min_size=1, max_size=6).map("\n".join))
def check_against_numpy(schema, states, plainly, middle):
    source, state = program(START + middle + END), states(np.random.default_rng(2), 2, 2)
    code, found = outcome(source, schema, state)
    seen["run" if code is None else "refused"] += 1
    if code is not None:
        assert code in ("shared", "wrong_type", "wrong_size", "mixed", "unset", "memory"), source
        return
    np.testing.assert_allclose(found, plainly(source, state), rtol=1e-9, err_msg=source)


def test_generated_changes_in_place_agree_with_numpy_or_are_refused(schema, states, plainly):
    seen.update(run=0, refused=0)
    check_against_numpy(schema, states, plainly)
    assert seen["run"] >= 0.2 * seen["refused"]
