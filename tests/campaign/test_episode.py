import errno
import json
import os
import re
from decimal import Decimal

import numpy as np
import pytest

from coral.campaign import episode as episode_module
from coral.campaign.episode import code_version, digest, perform
from coral.campaign.spec import Spec
from coral.file_writer import writing

SPEC = Spec(system="toy", variant="a", world="w", seed=7, advisor="x")


def test_a_result_becomes_plain_json_and_says_where_it_was_made(tmp_path):
    outcome = perform(
        lambda spec, folder: {
            "seed": np.int64(spec.seed),
            "share": np.float32(0.5),
            "at": folder.name,
            "d": Decimal("1"),
        },
        SPEC,
        tmp_path / "run",
    )
    assert outcome.result == {"seed": 7, "share": 0.5, "at": "run", "d": "1"}
    assert json.loads(json.dumps(outcome.result)) == outcome.result
    assert (outcome.spec, outcome.message) == (SPEC, "")
    assert outcome.about["code"] == code_version()
    assert outcome.about["episode_wall_s"] >= 0


def fail(spec, folder):
    raise ValueError("the reef is closed")


@pytest.mark.parametrize(
    ("episode", "message"),
    [
        (fail, "ValueError: the reef is closed"),
        (lambda spec, folder: {"score": float("nan")}, "not JSON compliant"),
        (lambda spec, folder: None, "TypeError"),
    ],
)
def test_an_exception_or_no_json_is_a_failure_with_its_traceback(tmp_path, episode, message):
    outcome = perform(episode, SPEC, tmp_path)
    assert outcome.result is None
    assert message in outcome.message
    assert outcome.detail.startswith("Traceback")
    assert outcome.about["code"] == code_version()


@pytest.mark.parametrize(("number", "full"), [(errno.ENOSPC, True), (errno.ENOENT, False)])
def test_a_full_disk_says_nothing_of_the_episode(tmp_path, number, full):
    def writes(spec, folder):
        raise OSError(number, os.strerror(number), "frame.png")

    outcome = perform(writes, SPEC, tmp_path)
    assert outcome.no_room is full
    assert "frame.png" in outcome.message


def test_a_full_disk_is_known_by_whatever_error_it_became(tmp_path):
    def full(spec, folder):
        with writing(folder / "world.yaml"):
            raise OSError(errno.ENOSPC, "No space left on device")

    assert perform(full, SPEC, tmp_path).no_room


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A small package in place of ours; its version is computed anew at every call."""
    for name in ("__init__.py", "reef/a.py", "reef/worlds/l1.yaml", "view/page.py", "commands/run.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{name}\n")
    monkeypatch.setattr(episode_module, "PACKAGE", tmp_path)
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
