import asyncio

import numpy as np
import pytest
from pydantic import BaseModel

from coral.advisor.latency import LatencyCfg, default_latency, parse_latency
from coral.advisor.question import AdvisorUnavailable, Question, Rejection
from coral.advisor.registry import make_advisor
from coral.advisor.rules import RuleAdvisor
from coral.errors import InputError


class Pick(BaseModel):
    index: int


class Same(BaseModel):
    index: int


RULES = {"pick": lambda facts, rejections: Pick(index=facts["n"] + len(rejections))}


def make(spec, **more):
    return make_advisor(spec, rules=RULES, rng=np.random.default_rng(0), **more)


def test_heuristic_reads_facts_and_rejections():
    for answer_type in (Pick, Same):
        question = Question(kind="pick", prompt="", answer_type=answer_type, facts={"n": 4})
        reply = asyncio.run(make("heuristic").answer(question, [Rejection(code="x", reason="y")]))
        assert reply.value == answer_type(index=5)
        assert reply.raw == '{"index":5}'


def test_heuristic_without_a_rule():
    with pytest.raises(AdvisorUnavailable, match="no rule for 'place', only for pick") as gone:
        asyncio.run(RuleAdvisor(RULES).answer(Question(kind="place", prompt="", answer_type=Pick, facts={}), ()))
    assert gone.value.final


@pytest.mark.parametrize(
    ("spec", "name", "latency"),
    [
        ("heuristic", "heuristic", "fixed:0"),
        ("openai:gpt-x", "openai:gpt-x", "measured"),
        ("anthropic:claude-x", "anthropic:claude-x", "measured"),
        ("google:gemini-x", "google:gemini-x", "measured"),
        ("local:http://127.0.0.1:8080/v1#m:q4", "local:http://127.0.0.1:8080/v1#m:q4", "measured"),
        ("fallible:0.3:heuristic", "fallible:0.3:heuristic", "fixed:0"),
        ("fallible:0.1:local:http://h/v1#m", "fallible:0.1:local:http://h/v1#m", "measured"),
    ],
)
def test_every_form_is_understood(monkeypatch, spec, name, latency):
    for key in ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "GEMINI_API_KEY"):
        monkeypatch.setenv(key, "k" * 20)
    advisor = make(spec)
    assert advisor.name == name
    assert str(default_latency(advisor)) == latency


@pytest.mark.parametrize("spec", ["openai:gpt-x", "anthropic:claude-x", "google:gemini-x"])
def test_providers_connect_without_sending(monkeypatch, spec):
    for key in ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "GOOGLE_API_KEY"):
        monkeypatch.setenv(key, "k" * 20)
    asyncio.run(make(spec).warm_up())


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        ("heuristics", "did you mean 'heuristic'"),
        ("opnai:gpt", "did you mean 'openai'"),
        ("", "one of heuristic"),
        ("desk:x", "one of heuristic"),
        ("desk", "--inbox"),
        ("openai:gpt-x", "OPENAI_API_KEY"),
        ("anthropic:x", "ANTHROPIC_API_KEY"),
        ("google:x", "GOOGLE_API_KEY or GEMINI_API_KEY"),
        ("openai:", "all of openai:MODEL"),
        ("local:8080#m", "local:URL#MODEL"),
        ("local:http://h/v1", "local:URL#MODEL"),
        ("fallible:0.3", "fallible:P:INNER"),
        ("fallible:2:heuristic", "probability from 0 to 1"),
        ("fallible:x:heuristic", "probability from 0 to 1"),
        ("fallible:0.3:nobody", "one of heuristic"),
        ("replay:/no/such/file", "No such file"),
    ],
)
def test_mistakes_are_explained(spec, says):
    with pytest.raises(InputError, match=says.replace("(", r"\(")):
        make(spec)


def test_credentials_in_a_url_are_refused_and_not_repeated():
    with pytest.raises(InputError, match="CORAL_LOCAL_API_KEY") as error:
        make("local:http://me:hunter2@127.0.0.1/v1#m")
    assert "hunter2" not in str(error.value)


@pytest.mark.parametrize(
    ("spec", "cfg"),
    [
        ("0", LatencyCfg(median_s=0.0)),
        ("10", LatencyCfg(median_s=10.0)),
        ("fixed:2.5", LatencyCfg(median_s=2.5)),
        ("lognormal:10:0.3", LatencyCfg(kind="lognormal", median_s=10.0, sigma=0.3)),
        ("measured", LatencyCfg(kind="measured")),
        ("recorded", LatencyCfg(kind="recorded")),
    ],
)
def test_latency_forms(spec, cfg):
    assert parse_latency(spec) == cfg


@pytest.mark.parametrize(
    "spec", ["", "fast", "fixed", "fixed:x", "fixed:-1", "lognormal:10", "lognormal:1:2:3", "inf", "measured:3", "nan"]
)
def test_bad_latency(spec):
    with pytest.raises(InputError):
        parse_latency(spec)


def test_lognormal_median_and_spread():
    rng = np.random.default_rng(1)
    draws = np.array([parse_latency("lognormal:10:0.3").draw(rng) for _ in range(4000)])
    assert np.median(draws) == pytest.approx(10.0, rel=0.03)
    assert np.std(np.log(draws)) == pytest.approx(0.3, rel=0.05)


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ("openai", "expected all of openai:MODEL"),
        ("google:", "expected all of google:MODEL"),
        ("replay", "expected all of replay:FILE"),
        ("local:", "expected all of local:URL#MODEL"),
        ("fallible", "expected all of fallible:P:INNER"),
        ("gemini:gemini-3-pro", "did you mean 'google:gemini-3-pro'"),
        ("gemini", "did you mean 'google:gemini'"),
        ("claude-opus-4-5", "did you mean 'anthropic:claude-opus-4-5'"),
        ("gpt-5", "did you mean 'openai:gpt-5'"),
        ("ollama:llama3", "did you mean 'local:URL#MODEL'"),
        ("opneai:gpt-5", "did you mean 'openai'"),
        ("desk:inbox", "did you mean 'desk'"),
        ("human", "did you mean 'desk'"),
    ],
)
def test_what_was_meant_is_suggested(spec, expected):
    with pytest.raises(InputError) as error:
        make_advisor(spec, rules={}, rng=np.random.default_rng(0))
    assert expected in str(error.value)


def test_nothing_is_suggested_for_what_is_like_nothing():
    with pytest.raises(InputError) as error:
        make_advisor("mistral:large", rules={}, rng=np.random.default_rng(0))
    assert "did you mean" not in str(error.value)
