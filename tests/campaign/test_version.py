import re

import pytest

from coral.campaign import version as version_module
from coral.campaign.version import code_version, digest


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A small package in place of ours; its version is computed anew at every call."""
    for name in ("__init__.py", "reef/a.py", "reef/worlds/l1.yaml", "view/page.py", "commands/run.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{name}\n")
    monkeypatch.setattr(version_module, "PACKAGE", tmp_path)
    return tmp_path


def version():
    return code_version.__wrapped__()


def test_the_same_files_have_the_same_version(package):
    first = version()
    assert re.fullmatch("[0-9a-f]{12}", first)
    assert version() == first


@pytest.mark.parametrize("name", ["__init__.py", "reef/a.py", "reef/worlds/l1.yaml", "reef/new.xml"])
def test_a_file_that_can_change_a_result_changes_the_version(package, name):
    first = version()
    (package / name).write_text("x = 1\n")
    assert version() != first


@pytest.mark.parametrize("name", ["view/page.py", "commands/run.py", "reef/a.pyc", "reef/notes.txt"])
def test_a_file_that_only_shows_results_does_not(package, name):
    first = version()
    (package / name).write_text("x = 1\n")
    assert version() == first


def test_a_file_under_another_name_is_another_version(package):
    first = version()
    (package / "reef" / "a.py").rename(package / "reef" / "b.py")
    assert version() != first


def test_a_digest_depends_on_contents_and_not_on_their_order():
    assert digest({"a": 1, "b": [1, 2]}) == digest({"b": [1, 2], "a": 1})
    assert digest({"a": 1}) != digest({"a": 2})
    assert digest([1, 2]) != digest([2, 1])
