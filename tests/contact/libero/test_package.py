"""Where the package lies, and what is said where it does not."""

import sys

import pytest

from coral.cli import main
from coral.contact.libero.package import Package, default_folder, find_package
from coral.errors import InputError

TASK = "pick_up_the_can_and_place_it_in_the_bin"
MAP = "libero/libero/benchmark/libero_suite_task_map.py"


def test_the_installed_package_names_its_tasks_and_their_files(installed):
    package = find_package("test")
    assert package == installed
    assert package.tasks() == (TASK,)
    assert package.problem(TASK).is_file()
    assert package.states(TASK).is_file()


def test_a_model_is_found_on_any_shelf(installed):
    assert installed.model("can").parts[-3:] == ("stable_hope_objects", "can", "can.xml")
    assert installed.model("bin").parts[-3:] == ("stable_scanned_objects", "bin", "bin.xml")
    with pytest.raises(InputError, match="no jar, expected all five asset packages"):
        installed.model("jar")


def test_without_the_variable_the_default_folder_is_looked_into(package, tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    default_folder().parent.mkdir()
    default_folder().symlink_to(package.root)
    monkeypatch.setenv("CORAL_LIBERO", "")
    assert find_package("test") == Package(default_folder())
    monkeypatch.delenv("CORAL_LIBERO")
    assert find_package("test").tasks() == (TASK,)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('tasks = {"libero_goal": []}', "KeyError"),
        ("tasks = [1]", "no list"),
        ("tasks = {", "SyntaxError"),
        ('tasks = {"libero_object": open("/etc/hostname")}', "ValueError"),
    ],
)
def test_a_list_of_tasks_that_cannot_be_read_is_named_and_never_run(text, expected, installed):
    (installed.root / MAP).write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=rf"task_map\.py.*{expected}.*the tasks of libero_object"):
        installed.tasks()


def test_not_installed(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("CORAL_LIBERO", str(tmp_path / "nowhere"))
    assert main(["contact", "run", "libero:object/0"]) == 2
    error = capsys.readouterr().err.strip()
    assert "make setup-libero" in error
    assert "\n" not in error
