"""The page on task files: its example loads, its tables name everything there is."""

import re
from pathlib import Path
from typing import get_args

import yaml
from pydantic import TypeAdapter

from coral.contact.scene.conditions import Condition
from coral.contact.scene.shapes import Joint
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "task-file.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
KINDS = get_args(get_args(Condition)[0])


def test_the_example_is_a_task_that_can_be_simulated(tmp_path):
    example, *_ = BLOCKS
    path = tmp_path / "drawer-stop.yaml"
    path.write_text(example, encoding="utf-8")
    task = load_task(path)
    assert task.name == path.stem
    for seed in range(5):
        assert HandWorld(sample_trial(task, seed)).reset().objects.keys() == {"mug"}


def test_the_pieces_of_files_are_valid():
    _, conditions, joint = map(yaml.safe_load, BLOCKS)
    assert [TypeAdapter(Condition).validate_python(one).kind for one in conditions] == ["sequence"]
    assert Joint.model_validate(joint["joint"]).kind == "hinge"
