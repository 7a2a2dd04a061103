"""Recordings for rerun, where it is installed."""

import importlib.util

import pytest

from coral.errors import InputError
from coral.reef.recordings.rerun_export import write_rerun
from coral.reef.recordings.run_recording import read_run

HAS_RERUN = importlib.util.find_spec("rerun") is not None


@pytest.mark.skipif(HAS_RERUN, reason="rerun is installed")
def test_without_rerun_the_error_says_what_else_there_is(survey_run, tmp_path):
    with pytest.raises(InputError, match=r"coral\[rerun\].*--to mcap"):
        write_rerun(read_run(survey_run).located(), tmp_path / "x.rrd")


@pytest.mark.skipif(not HAS_RERUN, reason="rerun is not installed")
def test_every_keyframe_is_logged(survey_run, tmp_path):
    counts = write_rerun(read_run(survey_run).located(), tmp_path / "x.rrd")
    assert counts["keyframes"] == 41
    assert (tmp_path / "x.rrd").stat().st_size > 10_000
