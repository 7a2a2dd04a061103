"""A small survey and its products."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

from survey_runs import write_run

from coral.reef.products.survey_products import ProductsCfg, measure
from coral.reef.recordings.run_recording import read_run


@pytest.fixture(scope="session")
def survey_run(tmp_path_factory):
    """A run folder of a small patch, with colour pictures."""
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder, colour=True)
    return folder


@pytest.fixture(scope="session")
def recording(survey_run):
    return read_run(survey_run).located()


@pytest.fixture(scope="session")
def products(recording):
    return measure(recording, ProductsCfg())
