"""Trackers by their words."""

import re

import numpy as np
import pytest
from stub_foundationpose import serving

from coral.cli import main
from coral.contact.perception.model_tracker import ModelTracker
from coral.contact.perception.tracker import TrackerFailed
from coral.contact.perception.tracker_registry import TRACKERS, choose_tracker
from coral.errors import InputError


def test_the_embedded_one_is_told_what_is_expected_and_wants_no_colours(mug):
    expected = np.diag([-1.0, -1.0, 1.0, 1.0])
    choice = choose_tracker("model")
    tracker = choice.make(mug, expected)
    assert isinstance(tracker, ModelTracker)
    assert (choice.name, choice.wants_colours) == ("model", False)
    np.testing.assert_array_equal(tracker.belief.pose, expected)
    choice.check()
    tracker.close()


def test_a_server_s_address_is_in_the_word(mug):
    with serving() as server:
        choice = choose_tracker(f"foundationpose:{server.url}")
        assert (choice.name, choice.wants_colours) == ("foundationpose", True)
        choice.check()
        assert choice.make(mug, None).url == server.url


def test_nobody_there_is_one_line():
    with pytest.raises(TrackerFailed, match=r"^foundationpose at http://127\.0\.0\.1:9 does not answer: .+$"):
        choose_tracker("foundationpose:http://127.0.0.1:9").check()


@pytest.mark.parametrize(
    "word",
    [
        "",
        "models",
        "model:x",
        "foundationpose",
        "foundationpose:",
        "foundationpose:ws://127.0.0.1:1",
        "foundationpose:http://x:99999",
        "Foundationpose:http://x",
    ],
)
def test_another_word_is_refused_where_it_stands(word):
    with pytest.raises(InputError, match=r"^tracked: by: found"):
        choose_tracker(word, where="tracked", field="by")


def test_a_mistyped_tracker_is_told_the_forms_and_the_nearest_name():
    with pytest.raises(InputError) as error:
        choose_tracker("foundatonpose:http://x")
    for form in TRACKERS:
        assert form in str(error.value)
    assert "did you mean 'foundationpose'?" in str(error.value)


@pytest.mark.parametrize("command", ["run", "bench", "poses"])
def test_every_tracker_is_in_the_help_of_the_commands(command, capsys):
    main(["contact", command, "--help", "--tracker"])
    text = re.sub(r"\s+", "", capsys.readouterr().out)  # lines break anywhere
    for form, what in TRACKERS.items():
        assert re.sub(r"\s", "", f"{form}, {what}") in text
