"""`coral export`."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "reef"))

from survey_runs import write_run

pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def survey_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("survey") / "patch-001"
    write_run(folder)
    return folder


def test_a_run_becomes_one_file_beside_it_and_is_not_overwritten(survey_run, told):
    code, result, _ = told("export", survey_run, "--json")
    assert code == 0
    assert result["export"].endswith("patch-001/patch-001.mcap")
    assert result["messages"]["/odometry"] == 41
    code, _, error = told("export", survey_run)
    assert code == 2
    assert "something that exists already" in error


def test_it_is_told_in_a_line(survey_run, tmp_path, told):
    code, out, _ = told("export", survey_run, "--to", "bag", "--out", tmp_path / "b")
    assert code == 0
    assert "messages on 8 topics" in out
    assert (tmp_path / "b/metadata.yaml").is_file()


def test_a_contact_run_is_not_for_it(tmp_path, told):
    (tmp_path / "task.yaml").write_text("")
    code, _, error = told("export", tmp_path)
    assert code == 2
    assert "coral contact export" in error
