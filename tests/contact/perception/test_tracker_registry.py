"""Trackers by their words."""

import re

import numpy as np
import pytest
from stub_foundationpose import serving

from coral.cli import main
from coral.contact.perception.foundationpose import FoundationPoseCfg
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


def test_a_server_s_address_is_in_the_word_or_in_the_configuration(mug):
    with serving() as server:
        for choice in (
            choose_tracker(f"foundationpose:{server.url}", FoundationPoseCfg(track_steps=7)),
            choose_tracker("foundationpose", FoundationPoseCfg(url=server.url, track_steps=7)),
        ):
            assert (choice.name, choice.wants_colours) == ("foundationpose", True)
            choice.check()
            tracker = choice.make(mug, None)
            assert (tracker.cfg.url, tracker.cfg.track_steps) == (server.url, 7)


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
    for form, _ in TRACKERS.values():
        assert form in str(error.value)
    assert "did you mean 'foundationpose'?" in str(error.value)


@pytest.mark.parametrize("command", ["run", "bench", "poses"])
def test_every_tracker_is_in_the_help_of_the_commands(command, capsys):
    main(["contact", command, "--help", "--tracker"])
    text = re.sub(r"\s+", "", capsys.readouterr().out)  # lines break anywhere
    for form, what in TRACKERS.values():
        assert re.sub(r"\s", "", f"{form}, {what}") in text


def test_the_choice_has_the_name_that_the_tracker_is_registered_by():
    for name in TRACKERS:
        address = "" if name == "model" else ":http://127.0.0.1:9"
        assert choose_tracker(name + address).name == name
