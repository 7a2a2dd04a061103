import pytest

from coral.exam.question_set import load_set


@pytest.fixture(scope="session")
def few():
    """Two questions of each kind of the shipped set."""
    return load_set("public", limit=2)
