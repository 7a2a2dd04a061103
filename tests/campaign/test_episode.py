import errno
import json
import os
from decimal import Decimal

import numpy as np
import pytest

from coral.campaign.episode import perform
from coral.campaign.spec import Spec
from coral.campaign.version import code_version
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


def test_an_interrupt_is_no_failure_of_the_episode(tmp_path):
    def interrupted(spec, folder):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        perform(interrupted, SPEC, tmp_path)


def test_a_full_disk_is_known_by_whatever_error_it_became(tmp_path):
    def full(spec, folder):
        with writing(folder / "world.yaml"):
            raise OSError(errno.ENOSPC, "No space left on device")

    assert perform(full, SPEC, tmp_path).no_room
