import json

import pytest

from coral.errors import InputError
from coral.interface.result import ResultFolder, RunResult, demand_inbox, read_table


@pytest.fixture
def result(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "trajectory.csv").write_text("step,t,goal_x\n0,0,\n1,0.1,2.5\n2,0.2,nan\n")
    events = [
        {"step": 0, "t": 0.0, "event": "start"},
        {"step": 1, "t": 0.1, "event": "goal", "x": 2.5, "then": [1, 2], "index": 3},
        {"step": 2, "t": 0.2, "event": "goal", "x": 4.5, "index": "none"},
    ]
    (folder / "events.jsonl").write_text("".join(json.dumps(event) + "\n" for event in events))
    return RunResult(ResultFolder(folder), {"end_reason": "time limit", "coverage": 0.5})


def test_the_trajectory_is_a_table_of_numbers_with_gaps(result):
    table = result.trajectory
    assert [str(kind) for kind in table.schema.types] == ["int64", "double", "double"]
    assert table.column("goal_x").to_pylist()[:2] == [None, 2.5]


def test_events_of_one_kind_are_a_table(result):
    assert result.events_of("goal").to_pylist() == [
        {"step": 1, "t": 0.1, "event": "goal", "x": 2.5, "then": "[1, 2]", "index": "3"},
        {"step": 2, "t": 0.2, "event": "goal", "x": 4.5, "then": None, "index": "none"},
    ]
    assert result.events_of("collision").num_rows == 0
    assert [event["event"] for event in result.events] == ["start", "goal", "goal"]
    assert result.attempts == []


def test_it_shows_how_the_run_ended(result):
    assert repr(result) == "RunResult(end_reason='time limit')"


def test_it_is_copied_only_to_a_new_folder(result, tmp_path):
    assert (result.save(tmp_path / "kept") / "events.jsonl").exists()
    with pytest.raises(InputError, match="a folder that is not empty"):
        result.save(tmp_path / "kept")


def test_a_temporary_folder_disappears_with_the_result():
    folder = ResultFolder(None)
    path, result = folder.path, RunResult(folder, {})
    assert path.is_dir()
    del folder, result
    assert not path.exists()


@pytest.mark.parametrize("advisor", ["desk", "sloppy:malformed=0.5:desk"])
def test_who_asks_a_person_names_a_folder(advisor, tmp_path):
    with pytest.raises(InputError, match="out: found no folder for --advisor"):
        demand_inbox(advisor, None)
    demand_inbox(advisor, tmp_path)
    demand_inbox("heuristic", None)


def test_an_empty_trajectory_is_an_empty_table(tmp_path):
    (tmp_path / "trajectory.csv").write_text("step,t\n")
    assert read_table(tmp_path / "trajectory.csv").num_rows == 0
