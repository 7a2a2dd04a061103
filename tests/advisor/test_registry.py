from importlib.metadata import EntryPoint

import numpy as np
import pytest
from pydantic import BaseModel

from coral import plugins
from coral.advisor.latency import default_latency
from coral.advisor.registry import (
    ENTRIES,
    _maker,
    advisor_help,
    asks_person,
    check_advisor,
    make_advisor,
    rules_alone,
)
from coral.advisor.rules import RuleAdvisor
from coral.advisor.setting import Mistake
from coral.errors import InputError

pytestmark = pytest.mark.wing("coral.erring")


class Pick(BaseModel):
    index: int


RULES = {"pick": lambda facts, rejections: Pick(index=facts["n"] + len(rejections))}


MISTAKES = tuple(
    Mistake(name=name, what="", found_in="", questions=("pick",), err=lambda *_: None) for name in ("low", "late")
)


def make(spec, **more):
    return make_advisor(spec, rules=RULES, rng=np.random.default_rng(0), **{"mistakes": MISTAKES, **more})


@pytest.mark.parametrize(
    ("spec", "name", "latency"),
    [
        ("heuristic", "heuristic", "fixed:0"),
        ("openai:gpt-x", "openai:gpt-x", "measured"),
        ("anthropic:claude-x", "anthropic:claude-x", "measured"),
        ("google:gemini-x", "google:gemini-x", "measured"),
        ("local:http://127.0.0.1:8080/v1#m:q4", "local:http://127.0.0.1:8080/v1#m:q4", "measured"),
        ("sloppy:0.3:heuristic", "sloppy:0.3:heuristic", "fixed:0"),
        ("sloppy:0.1:local:http://h/v1#m", "sloppy:0.1:local:http://h/v1#m", "measured"),
        ("sloppy:low=0.25+late=.5:sloppy:0.2:heuristic", "sloppy:low=0.25+late=0.5:sloppy:0.2:heuristic", "fixed:0"),
    ],
)
def test_every_form_is_understood(monkeypatch, spec, name, latency):
    for key in ("OPENAI_API_KEY", "ANTHROPIC_API_KEY", "GEMINI_API_KEY"):
        monkeypatch.setenv(key, "k" * 20)
    advisor = make(spec)
    assert advisor.name == name
    assert str(default_latency(advisor)) == latency


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        ("heuristics", "did you mean 'heuristic'"),
        ("opnai:gpt", "did you mean 'openai'"),
        ("", "one of heuristic"),
        ("desk", "--inbox"),
        ("openai:gpt-x", "OPENAI_API_KEY"),
        ("google:x", "GOOGLE_API_KEY or GEMINI_API_KEY"),
        ("local:8080#m", "local:URL#MODEL"),
        ("sloppy:0.3:nobody", "one of heuristic"),
        ("replay:/no/such/file", "No such file"),
        ("sloppy", "all of sloppy:ERRORS:INNER"),
        ("sloppy:1.3:heuristic", "probabilities from 0 to 1"),
        ("sloppy:nan:heuristic", "P: found 'nan'"),
        ("sloppy:malformed=0.6+silence=0.6:heuristic", "sum to 1.2 for all questions"),
        ("sloppy:lw=0.3:heuristic", "did you mean 'low'"),
        ("sloppy:low=0.1+low=0.2:heuristic", "'low' twice"),
        ("sloppy:low=0.6+late=0.6:heuristic", "sum to 1.2 for pick questions"),
    ],
)
def test_mistakes_are_explained(spec, says):
    with pytest.raises(InputError, match=says.replace("(", r"\(")):
        make(spec)


def test_credentials_in_a_url_are_refused_and_not_repeated():
    with pytest.raises(InputError, match="CORAL_LOCAL_API_KEY") as error:
        make("local:http://me:hunter2@127.0.0.1/v1#m")
    assert "hunter2" not in str(error.value)


def test_an_application_without_plausible_errors_says_so():
    with pytest.raises(InputError, match="this one has none"):
        make("sloppy:0.3:heuristic", mistakes=())


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.form)
def test_each_entry_names_a_maker_that_exists_and_stands_in_help(entry):
    assert callable(_maker(entry, "--advisor"))
    assert entry.form in advisor_help("Who decides")


@pytest.mark.parametrize(
    ("spec", "rules", "person"),
    [
        ("heuristic", True, False),
        ("sloppy:low=0.1+late=0.2:heuristic", True, False),
        ("sloppy:silence=0.1:sloppy:0.2:desk", False, True),
        (" desk ", False, True),
        ("replay:desk", False, False),
        ("local:http://h/v1#desk", False, False),
        ("nobody", False, False),
    ],
)
def test_who_answers_in_the_end_is_known_from_the_string(spec, rules, person):
    assert (rules_alone(spec), asks_person(spec)) == (rules, person)


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ("openai", "expected all of openai:MODEL"),
        ("local:", "expected all of local:URL#MODEL"),
        ("gemini:gemini-3-pro", "did you mean 'google:gemini-3-pro'"),
        ("claude-opus-4-5", "did you mean 'anthropic:claude-opus-4-5'"),
        ("gpt-5", "did you mean 'openai:gpt-5'"),
        ("ollama:llama3", "did you mean 'local:URL#MODEL'"),
        ("desk:inbox", "did you mean 'desk'"),
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


def make_oracle(name, rest, setting):
    return RuleAdvisor(setting.rules, name=f"{name}:{rest}")


@pytest.fixture
def oracle(monkeypatch):
    """Another package offers the advisor `oracle`, and tries to take the name of one of ours."""
    points = [EntryPoint(name, "oracle:make_oracle", "coral.advisors") for name in ("oracle", "desk")]
    monkeypatch.setattr(plugins, "entry_points", lambda group: [p for p in points if p.group == group])
    load = EntryPoint.load
    monkeypatch.setattr(EntryPoint, "load", lambda self: make_oracle if self in points else load(self))


@pytest.mark.parametrize(("spec", "name"), [("oracle", "oracle:"), ("oracle:of-delphi", "oracle:of-delphi")])
def test_an_advisor_of_another_package_is_made_by_its_name(oracle, spec, name):
    assert make(spec).name == name


def test_it_can_be_wrapped_and_is_never_taken_for_our_rules(oracle):
    assert make("sloppy:0.5:oracle:x").inner.name == "oracle:x"
    assert not rules_alone("oracle")


def test_the_names_of_ours_cannot_be_taken(oracle, tmp_path):
    assert type(make("desk", inbox=tmp_path)).__module__ == "coral.desk.advisor"


def test_it_is_suggested_for_a_mistyped_name(oracle):
    with pytest.raises(InputError, match="did you mean 'oracle'"):
        make("oracl")


class Wordless:
    name = "wordless"

    def answer(self, question, rejections):
        return None


@pytest.mark.parametrize("advisor", [object(), Wordless(), RuleAdvisor(RULES, name="")])
def test_an_object_that_cannot_answer_is_no_advisor(advisor):
    with pytest.raises(InputError, match="an object with a name and a coroutine"):
        check_advisor(advisor)
