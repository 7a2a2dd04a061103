import json

import pytest
import yaml

from coral.cli import main
from coral.contact.scene.task_names import TASKS_DIR, shipped_tasks


def answer(capsys):
    return json.loads(capsys.readouterr().out)


def test_tasks_are_listed_and_one_is_shown_with_its_ranges(capsys):
    assert main(["contact", "tasks"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in shipped_tasks())
    assert main(["contact", "tasks", "pick-box"]) == 0
    shown = capsys.readouterr().out
    assert yaml.safe_load(shown)["objects"][0]["mass_kg"] == [0.1, 0.4]
    assert main(["contact", "tasks", "--json"]) == 0
    assert [task["name"] for task in answer(capsys)["tasks"]] == list(shipped_tasks())


@pytest.fixture
def task_file(tmp_path):
    """Makes a copy of a shipped task with other values at its top."""

    def make(**changes):
        content = yaml.safe_load((TASKS_DIR / "pick-box.yaml").read_text(encoding="utf-8"))
        path = tmp_path / "mine.yaml"
        path.write_text(yaml.safe_dump({**content, **changes}), encoding="utf-8")
        return path

    return make


def test_a_file_is_described_like_a_shipped_task(told, task_file):
    code, text, _ = told("contact", "tasks", task_file(name="mine", time_limit_s=7.5, numbers={"lift": 0.25}))
    assert code == 0
    told_back = yaml.safe_load(text)
    assert (told_back["name"], told_back["time_limit_s"], told_back["numbers"]) == ("mine", 7.5, {"lift": 0.25})


def test_a_wrong_file_is_one_line_that_names_the_field(refused, task_file):
    assert "mine.yaml: time_limit_s: found -1" in refused("contact", "tasks", task_file(time_limit_s=-1))
    assert "did you mean 'pick-box'?" in refused("contact", "tasks", "pick-bx")
