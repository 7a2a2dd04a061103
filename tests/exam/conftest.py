import json
import sys
from pathlib import Path

import pytest

from coral.advisor.log import plain_json
from coral.exam.question_set import load_set

sys.path.insert(0, str(Path(__file__).parents[1] / "contact"))


@pytest.fixture(scope="session")
def few():
    """Two questions of each kind of the shipped set."""
    return load_set("public", limit=2)


@pytest.fixture(scope="session")
def same():
    """Asserts that a question which was made anew is a shipped one, in all but the pixels of its pictures."""

    def check(made, shipped):
        assert (made.kind, made.group, made.prompt) == (shipped.kind, shipped.group, shipped.prompt)
        assert made.id == shipped.id
        assert json.loads(plain_json(made.facts)) == shipped.facts
        assert json.loads(plain_json(made.key)) == shipped.key
        assert [p.caption for p in made.pictures] == [p.caption for p in shipped.pictures]

    return check
