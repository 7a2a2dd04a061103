import pytest

from coral.contact.scene.task_names import TASKS_DIR, every_task, task_path
from coral.errors import InputError


def test_a_name_means_a_shipped_file_and_a_path_itself(tmp_path):
    assert task_path("pick-box") == TASKS_DIR / "pick-box.yaml"
    assert task_path(tmp_path / "own.yaml") == tmp_path / "own.yaml"
    assert all(task_path(name).is_file() for name in every_task())


def test_a_mistyped_name_is_answered_with_the_nearest():
    with pytest.raises(InputError, match=r"task: found 'pick-bx', expected one of push-pick-board, .*'pick-box'"):
        task_path("pick-bx")


def test_a_file_beside_without_its_ending_is_suggested(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "nudge.yaml").write_text("")
    with pytest.raises(InputError, match=r"did you mean 'nudge\.yaml'"):
        task_path("nudge")
