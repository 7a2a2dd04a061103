import re

import pytest
from contact_bench import plain, written

from coral.contact.scene.task_names import shipped_tasks
from coral.contact.tasks import load_task
from coral.errors import InputError


@pytest.mark.parametrize("name", shipped_tasks())
def test_a_shipped_task_is_loaded_by_its_name(name):
    assert load_task(name).name == name


def test_any_other_task_is_loaded_from_its_file(tmp_path):
    task = written(tmp_path, plain())
    assert task.name == "bench"
    assert load_task(str(tmp_path / "task.yaml")) == load_task(tmp_path / "task.yaml") == task


def test_a_name_that_is_almost_right_is_corrected():
    with pytest.raises(InputError, match="did you mean 'pick-box'"):
        load_task("pick-bax")


def test_the_prefix_of_libero_asks_for_a_scene_of_it():
    with pytest.raises(InputError, match=re.escape("libero:KIND/TASK")):
        load_task("libero:kitchen/0")
