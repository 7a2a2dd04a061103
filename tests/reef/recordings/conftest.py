"""A run folder with keyframes, shared by the tests of recordings."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

from survey_runs import write_run


@pytest.fixture(scope="session")
def survey_run(tmp_path_factory):
    """A run folder of a small patch; its odometry drifts by 1 cm a picture."""
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder, drift=0.01)
    return folder
