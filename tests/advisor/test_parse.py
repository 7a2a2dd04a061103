import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import BaseModel, Field

from coral.advisor.parse import MAX_CHARS, parse_answer
from coral.advisor.question import BadAnswer


class Answer(BaseModel):
    index: int | None = Field(ge=0, le=9)
    reason: str = ""


class Any_(BaseModel):
    value: object


def code_of(text, answer_type=Answer):
    with pytest.raises(BadAnswer) as bad:
        parse_answer(text, answer_type)
    assert bad.value.raw == text[:MAX_CHARS]
    return bad.value.rejection.code


@pytest.mark.parametrize(
    "text",
    [
        '{"index": 3, "reason": "it\'s near"}',
        "  \n{'index': 3, 'reason': 'it\\'s near'}\n",
        '```json\n{"index": 3, "reason": "it\'s near"}\n```',
        "```python\n{'index': 3, 'reason': \"it's near\",}\n```",
        'Sure! Here you go:\n```\n{"index": 3, "reason": "it\'s near"}\n```\nHope that helps :}',
        'I first thought of {"index": 1}, but it\'s {"index": 3, "reason": "it\'s near"}.',
        '<think>dots [0, 1] {maybe</think>\n{"index": 3, "reason": "it\'s near"}',
        '[{"index": 3, "reason": "it\'s near"}]',
        "({'index': 3, 'reason': \"it's \" \"near\"})",
        '{"index": "3", "reason": "it\'s near", "confidence": 0.9}',
        '{"index": 3.0, "reason": "it\'s near"}',
    ],
)
def test_forms_that_models_use(text):
    assert parse_answer(text, Answer) == Answer(index=3, reason="it's near")


def test_line_breaks_inside_strings():
    assert parse_answer('{"index": 1, "reason": "1. green\n2. near"}', Answer).reason == "1. green\n2. near"
    assert parse_answer("{'index': 1, 'reason': '1. green\n2. near'}", Answer).reason == "1. green\n2. near"


def test_mixed_json_and_python_words():
    assert parse_answer("{'index': null}", Answer).index is None
    assert parse_answer("{'value': [true, False, None]}", Any_).value == [True, False, None]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "empty"),
        (" \n\t", "empty"),
        ("dot three", "not-json"),
        ("{", "not-json"),
        ("{}", "missing-field"),
        ('{"index": "left"}', "wrong-type"),
        ('{"index": [3]}', "wrong-type"),
        ('{"index": 3.5}', "wrong-type"),
        ('{"index": 10}', "out-of-range"),
        ('{"index": -1}', "out-of-range"),
        ('{"index": 1e999}', "out-of-range"),
        ('{"index": NaN}', "out-of-range"),
        ("3", "not-json"),
        ('"3"', "not-json"),
        ("[1, 2]", "wrong-type"),
        ("I'm sorry, but I can’t help with that.", "refusal"),
        ('{"index": 3', "not-json"),
        ("__import__('os').system('true')", "not-json"),
        ("{'index': abs(3)}", "not-json"),
        ("{'index': 1+2}", "not-json"),
    ],
)
def test_faults_are_named(text, code):
    assert code_of(text) == code


def test_reason_tells_the_field_and_what_was_found():
    with pytest.raises(BadAnswer, match=r"index: .* less than or equal to 9 \(found 12\)"):
        parse_answer('{"index": 12}', Answer)


@pytest.mark.parametrize(
    "text",
    [
        "{" * 60_000,
        "[" * 60_000,
        "-" * 60_000,
        "1+" * 30_000 + "1",
        "({['" * 10_000,
        "{'a':" * 10_000,
        "not " * 15_000,
        '"' * 60_000,
        "`" * 60_000,
        "```\n" * 15_000,
        "{}" * 30_000,
        "{'a': " + "9" * 60_000 + "}",
        "[[1]," * 12_000,
        "\\" * 60_000,
    ],
)
def test_hostile_text_is_refused_without_harm(text):
    assert code_of(text) in ("not-json", "missing-field", "wrong-type")


def test_size_bound():
    assert code_of('{"index": 1, "reason": "' + "x" * MAX_CHARS + '"}') == "too-long"


def test_depth_bound():
    assert code_of('{"index": 1, "more": ' + "[" * 40 + "]" * 40 + "}") == "not-json"


class Code(BaseModel):
    code: str

    @classmethod
    def from_text(cls, text):
        return {"code": text.split("```")[1]} if "```" in text else None


def test_a_model_may_read_its_own_form():
    assert parse_answer("here:```def f(): return {}```", Code).code == "def f(): return {}"
    assert parse_answer('{"code": "x"}', Code).code == "x"


json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


@settings(max_examples=150, deadline=None)
@given(json_values, st.sampled_from(["json", "python", "fence", "prose"]))
def test_every_value_survives_every_form(value, form):
    text = json.dumps({"value": value})
    if form == "python":
        text = repr({"value": value})
    elif form == "fence":
        text = f"So:\n```json\n{text}\n```\n"
    elif form == "prose":
        text = f"My answer is {text} as you see."
    found = parse_answer(text, Any_).value
    assert _same(found, value)


def _same(a, b):
    if isinstance(a, float) and isinstance(b, float):
        return math.isclose(a, b, rel_tol=1e-12, abs_tol=0.0) or a == b
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_same, a, b))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[k], b[k]) for k in a)
    return a == b


@settings(max_examples=300, deadline=None)
@given(st.text(alphabet=st.sampled_from("{}[]()'\"\\,:-+0123456789aeTrueNoneindex \n`"), max_size=200) | st.text())
def test_any_text_parses_or_is_a_bad_answer(text):
    try:
        answer = parse_answer(text, Answer)
    except BadAnswer:
        return
    assert answer.index is None or 0 <= answer.index <= 9


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 9), st.text(alphabet="abc {}[]'.\n", max_size=40), st.text(alphabet="abc .\n'", max_size=40))
def test_text_around_json_does_not_hide_it(index, before, after):
    assert parse_answer(f'{before}\n```json\n{{"index": {index}}}\n```\n{after}', Answer).index == index
