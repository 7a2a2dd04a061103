import pytest

from coral.contact.variants import rules_alone


@pytest.mark.parametrize("advisor", ["heuristic", "fallible:0.3:heuristic", "fallible:0.1:fallible:0.2:heuristic"])
def test_what_rules_alone_compose_needs_no_confinement(advisor):
    assert rules_alone(advisor)


@pytest.mark.parametrize("advisor", ["desk", "openai:heuristic", "replay:heuristic", "fallible:0.3:replay:heuristic",
                                     "replay:runs:heuristic", "local:http://127.0.0.1:1/v1#a:heuristic", ""])
def test_a_name_that_ends_like_the_rules_is_still_confined(advisor):
    assert not rules_alone(advisor)
