"""Generated expressions over arrays, and generated statements: what NumPy gives, or a refusal with a reason."""

from __future__ import annotations

import os
import textwrap
import warnings

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from coral.contact.cost_program import CostError, CostProgram
from coral.contact.cost_program.errors import CODES

EXAMPLES = int(os.environ.get("CORAL_FUZZ", "80"))
LEAVES = st.sampled_from(
    [
        "self.time",
        "0.5",
        "2",
        "-1.5",
        "self.ee_pos",
        "self.box_pos",
        "np.array([1, 2, 3])",
        "np.eye(3)",
        "np.stack([self.ee_pos, self.box_pos])",
        "self.box_quat[:3]",
        "np.zeros((2, 3))",
        "self.box_hand_contact",
        "[0.1, 0.2, 0.3]",
        "(self.time > 0.5)",
        "np.ones(1)",
        "(self.ee_pos > 0.0)",
        "True",
    ]
)
ONE = [
    "abs",
    "np.exp",
    "np.tanh",
    "np.sum",
    "np.mean",
    "np.max",
    "np.min",
    "np.std",
    "np.var",
    "np.median",
    "np.sort",
    "np.ravel",
    "np.transpose",
    "np.square",
    "np.sign",
    "np.floor",
    "np.cumsum",
    "np.diff",
    "float",
    "len",
    "list",
    "np.linalg.norm",
    "sum",
    "max",
    "min",
    "sorted",
    "np.any",
    "np.all",
    "np.array",
    "bool",
    "np.prod",
    "np.squeeze",
    "np.ptp",
    "np.round",
    "round",
    "tuple",
    "np.zeros_like",
    "np.ones_like",
    "np.copy",
    "-",
    "not ",
    "+",
    "np.diag",
    "np.hstack",
    "np.vstack",
    "math.sqrt",
    "math.floor",
    "np.logical_not",
    "np.isfinite",
    "np.concatenate",
    "str",
]
TWO = [
    "np.append",
    "np.maximum",
    "np.minimum",
    "np.dot",
    "np.add",
    "np.hypot",
    "np.arctan2",
    "max",
    "min",
    "np.outer",
    "np.cross",
    "np.power",
    "pow",
    "np.logical_and",
    "np.inner",
    "np.matmul",
    "np.isclose",
    "np.full",
    "np.vdot",
    "math.hypot",
    "np.heaviside",
    "np.fmod",
    "math.isclose",
    "isinstance",
    "np.average",
    "round",
    "np.reshape",
]
KEYWORDS = ["axis=0", "axis=1", "axis=-1", "keepdims=True", "axis=0, keepdims=True", "axis=1, keepdims=True", "ddof=1"]
INDEX = [
    "0",
    "-1",
    "1:",
    "::-1",
    "..., 0",
    "None",
    ":, None",
    "0, 1",
    ":, 1",
    "[0, 1]",
    "1:, 0",
    "[0, 1], [1, 0]",
    "...",
]
SUFFIX = [
    ".T",
    ".sum()",
    ".mean()",
    ".copy()",
    ".max()",
    ".ravel()",
    ".flatten()",
    ".reshape(-1)",
    ".shape",
    ".ndim",
    ".size",
    ".tolist()",
    ".reshape(3, -1)",
    ".std()",
    ".astype(float)",
    ".dot(self.ee_pos)",
    ".clip(0.0, 1.0)",
]
BINARY = ["+", "-", "*", "/", "**", "//", "%", "@", "<", "<=", "==", "!=", "and", "or", "&", "|", "in"]


def _larger(inner):
    return st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from(BINARY), inner),
        st.builds("{}({})".format, st.sampled_from(ONE), inner),
        st.builds("{}({}, {})".format, st.sampled_from(TWO), inner, inner),
        st.builds("{}({}, {})".format, st.sampled_from(ONE), inner, st.sampled_from(KEYWORDS)),
        st.builds("({})[{}]".format, inner, st.sampled_from(INDEX)),
        st.builds("({}){}".format, inner, st.sampled_from(SUFFIX)),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds("np.where({}, {}, {})".format, inner, inner, inner),
        st.builds("np.clip({}, {}, {})".format, inner, inner, inner),
        st.builds("[x * {} for x in {}]".format, inner, inner),
        st.builds("sum(map(lambda x: x + {}, {}))".format, inner, inner),
        st.builds("np.interp({}, [0.0, 0.5, 1.0], [0.0, 2.0, 1.0])".format, inner),
        st.builds("np.select([{} > 0.1], [{}], {})".format, inner, inner, inner),
        st.builds("[{}, {}]".format, inner, inner),
        st.builds("({}, {})".format, inner, inner),
    )


EXPRESSION = st.recursive(LEAVES, _larger, max_leaves=6)
seen = {"same": 0, "refused": 0, "raised": 0}


def outcome(source, schema, state):
    """The code of a refusal, or the cost."""
    try:
        return None, CostProgram(source, schema).evaluate(state).cost
    except CostError as error:
        return error.code, None


def expected(source, state, plainly):
    """What Python gives, None where it raises."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return plainly(source, state)
        except Exception:
            return None


def shapes(expression):
    """Programs that return single numbers of an expression, so that none of its entries is missed."""
    tails = ["x", "np.sum(x)", "x[0]", "x[1]", "x[0][1]", "x[1][0]", "x[-1][-1]", "len(x)", "x[0] * 1.0", "x * 1.0"]
    return [f"def state_cost(self):\n    x = {expression}\n    return {tail}\n" for tail in tails]


@settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize="CORAL_FUZZ" not in os.environ,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(EXPRESSION)
def check_expression(schema, states, plainly, expression):
    state = states(np.random.default_rng(4), 2, 2)
    for source in shapes(expression):
        code, found = outcome(source, schema, state)
        assert code is None or (code in CODES and code != "internal"), source
        if code is not None:
            seen["refused"] += 1
            continue
        wanted = expected(source, state, plainly)
        seen["same" if wanted is not None else "raised"] += 1
        if wanted is not None:
            np.testing.assert_allclose(found, wanted, rtol=1e-7, atol=1e-9, err_msg=source)


def test_generated_expressions_agree_with_numpy_or_are_refused(schema, states, plainly):
    seen.update(same=0, refused=0, raised=0)
    check_expression(schema, states, plainly)
    assert seen["same"] >= EXAMPLES / 2


BODY = st.lists(
    st.one_of(
        st.builds("x = {}".format, EXPRESSION),
        st.builds("y = {}".format, EXPRESSION),
        st.builds("s += np.sum({})".format, EXPRESSION),
        st.builds("terms['a'] = np.sum({})".format, EXPRESSION),
        st.sampled_from(["x, y = y, x", "s += np.sum(x)", "x += y", "y *= 2.0", "s -= np.sum(y)", "x[0] = s"]),
    ),
    min_size=1,
    max_size=3,
).map("\n".join)


def _indented(code):
    return textwrap.indent(code, "    ")


STATEMENTS = st.recursive(
    BODY,
    lambda inner: st.one_of(
        st.builds(lambda t, a, b: f"if {t}:\n{_indented(a)}\nelse:\n{_indented(b)}", EXPRESSION, inner, inner),
        st.builds(lambda t, a: f"if {t}:\n{_indented(a)}\n    return s", EXPRESSION, inner),
        st.builds(lambda a, t: f"for i in range(3):\n{_indented(a)}\n    if {t}:\n        break", inner, EXPRESSION),
        st.builds(lambda a, t: f"for i in range(3):\n    if {t}:\n        continue\n{_indented(a)}", inner, EXPRESSION),
        st.builds(lambda a: f"i = 0\nwhile i < 3:\n    i += 1\n{_indented(a)}", inner),
        st.builds(lambda a: f"try:\n{_indented(a)}\nexcept Exception:\n    s = -1.0", inner),
        st.builds(
            lambda a, t: f"def f(x):\n    s = 0.0\n    y = x\n{_indented(a)}\n    return s\ns += f({t})",
            inner,
            EXPRESSION,
        ),
        st.builds("{}\n{}".format, inner, inner),
    ),
    max_leaves=4,
)


@settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize="CORAL_FUZZ" not in os.environ,
    suppress_health_check=list(HealthCheck),
    database=None,
)
@given(STATEMENTS)
def check_statements(schema, states, plainly, code):
    state = states(np.random.default_rng(5), 2, 2)
    start = "s, terms = 0.0, {'a': 0.0}\nx, y = self.ee_pos + 0.0, self.box_pos * 2.0\n"
    source = "def state_cost(self):\n" + _indented(start + code + "\nreturn s + terms['a'] + np.sum(x)") + "\n"
    refusal, found = outcome(source, schema, state)
    assert refusal is None or (refusal in CODES and refusal != "internal"), source
    wanted = expected(source, state, plainly) if refusal is None else None
    if wanted is not None:
        seen["same"] += 1
        np.testing.assert_allclose(found, wanted, rtol=1e-7, atol=1e-9, err_msg=source)


def test_generated_statements_agree_with_numpy_or_are_refused(schema, states, plainly):
    seen.update(same=0)
    check_statements(schema, states, plainly)
    assert seen["same"] >= EXAMPLES / 16
