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
        '{"name": "answer", "arguments": {"index": 3, "reason": "it\'s near"}}',
        '{"name": "answer", "arguments": "{\\"index\\": 3, \\"reason\\": \\"it\'s near\\"}"}',
        '<tool_call>\n{"name": "answer", "parameters": {"index": 3, "reason": "it\'s near"}}\n</tool_call>',
        '{"tool_calls": [{"type": "function", "function": {"arguments": {"index": 3, "reason": "it\'s near"}}}]}',
        '{"response": {"index": 3, "reason": "it\'s near"}}',
        '{"result": {"answer": [{"index": 3, "reason": "it\'s near"}]}, "confidence": 1}',
        '{"properties": {"index": 3, "reason": "it\'s near"}, "required": ["index"], "type": "object"}',
        '```json\n{\n  "index": 3, // the "nearest} one\n  "reason": "it\'s near",\n}\n```',
        'So {\n  # first\n  "index": 3, /* or 4 */ "reason": "it\'s near"\n}',
        "{“index”: 3, “reason”: “it's near”}",
        "{„index“: 3, „reason“: “it's near”}",
        '```json\n{"index": 3, "reason": "it\'s near"}',
        '```json\n{"index": 3, "reason": "it\'s near"\n```',
        'I say {"index": 3, "reason": "it\'s near"',
        '{"response": {"index": 3, "reason": "it\'s near"}',
        '<think>{"index": 1} or not</think>{"index": 3, "reason": "it\'s near"}',
        'or {"index": 1}, "the</THINK>{"index": 3, "reason": "it\'s near"}',
        '[THINK]{"index": 1}[/THINK]{"index": 3, "reason": "it\'s near"}<thought>so {"index": 2}</thought>',
        '<|channel|>analysis<|message|>{"index": 1<|channel|>final<|message|>{"index": 3, "reason": "it\'s near"}',
        '[see http://x] {"index": 3, "reason": "it\'s near"}',
    ],
)
def test_forms_that_models_use(text):
    assert parse_answer(text, Answer) == Answer(index=3, reason="it's near")


@pytest.mark.parametrize(
    "text",
    [
        '<think>\nCluster {"index": 1, "reason": "near"} would do, but the picture shows a wall, so the better one is',
        '{"index": 1}<think>or rather',
        "<|channel|>analysis<|message|>{'index': 1}",
        '{"index": 1, "reason": "the',
        '{"index": 1, "more": {"index": 2}, "reason": "x',
        "I first thought of {'index': 1}, but {'index': 3, 'reason': 'it is near",
        '{"index": 1',
        '{"reason": "x", "more": {"index": 2',
        '[{"index": 1}, {"index": 2}, {"index": 3, "rea',
        '{"more": {"index": 2, "reason": "x"',
    ],
)
def test_no_draft_and_no_part_of_an_answer_that_broke_off_is_an_answer(text):
    assert code_of(text) == "cut-off"


def test_a_mark_of_thoughts_inside_an_answer_is_text():
    assert parse_answer('{"index": 1, "reason": "<think> is a tag"}', Answer).reason == "<think> is a tag"


def test_quotes_and_escapes_inside_curly_quotes():
    assert parse_answer('{“index”: 1, “reason”: “a "b" \\n c”}', Answer).reason == 'a "b" \n c'


def test_an_envelope_is_not_opened_where_the_answer_has_that_field():
    assert parse_answer('{"value": {"value": 1}, "answer": {"value": 2}}', Any_).value == {"value": 1}


def test_faults_inside_an_envelope_are_those_of_its_answer():
    with pytest.raises(BadAnswer, match=r"index: .* \(found 12\)"):
        parse_answer('{"name": "answer", "arguments": {"index": 12}}', Answer)


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
        ('{"index": 3', "cut-off"),
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
    assert code_of(text) in ("not-json", "cut-off", "missing-field", "wrong-type")


def test_size_bound():
    assert code_of('{"index": 1, "reason": "' + "x" * MAX_CHARS + '"}') == "too-long"


def test_depth_bound():
    assert code_of('{"index": 1, "more": ' + "[" * 40 + "]" * 40 + "}") == "not-json"


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
