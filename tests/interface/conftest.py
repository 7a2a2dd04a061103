"""Short runs for the tests of the Python interface."""

import pytest

from coral.contact.tasks import load_task


@pytest.fixture(scope="session")
def short_task():
    """pick-box with a time limit of 0.2 s."""
    task = load_task("pick-box")
    success = task.success.model_copy(update={"hold_s": 0.04})
    return task.model_copy(update={"time_limit_s": 0.2, "success": success})
