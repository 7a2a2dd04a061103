import numpy as np
import pytest

from coral.advisor.registry import make_advisor
from coral.cli import COMMANDS
from coral.commands.gui import SETTINGS, choices, command
from coral.contact.mistakes.plausible import CONTACT_MISTAKES
from coral.errors import InputError
from coral.flag_parser import build, scan
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.decide.mistakes import REEF_MISTAKES
from coral.surface import described, load


@pytest.mark.parametrize(("system", "name"), [("reef", "s1"), ("contact", "stack-blocks")])
def test_what_the_page_offers_is_a_command_that_parses(tmp_path, system, name):
    offered = choices()[system]
    assert name in offered["names"]
    settings = {each["flag"]: each["value"] for each in offered["settings"]}
    words, folder = command({"system": system, "name": name, "settings": settings}, tmp_path)
    assert words[:3] == [system, "run", name]
    assert folder == tmp_path / f"{name}-001"
    place, about = COMMANDS[f"{system} run"][0], described(COMMANDS[f"{system} run"][0])
    made = build(load(place), scan(words[2:], about, "run"), about, "run")
    assert (made.seed, made.page.live, made.page.wait) == (0, True, False)


@pytest.mark.parametrize("system", SETTINGS)
def test_every_suggested_advisor_exists(system, tmp_path):
    rules, mistakes = (REEF_RULES, REEF_MISTAKES) if system == "reef" else ({}, CONTACT_MISTAKES)
    for advisor in SETTINGS[system]["advisor"][2]:
        rng = np.random.default_rng(0)
        assert make_advisor(advisor, rules=rules, rng=rng, inbox=tmp_path, mistakes=mistakes).name


def test_two_runs_get_two_folders(tmp_path):
    wanted = {"system": "reef", "name": "s1", "settings": {}}
    assert command(wanted, tmp_path)[1] != command(wanted, tmp_path)[1]


@pytest.mark.parametrize(
    "wanted",
    [
        {"system": "sea", "name": "s1", "settings": {}},
        {"system": "reef", "name": "--json", "settings": {}},
        {"system": "reef", "name": "s9", "settings": {}},
        {"system": "reef", "name": "s1", "settings": {"out": "/"}},
        {"system": "reef", "name": "s1", "settings": dict.fromkeys(SETTINGS["contact"], "1")},
    ],
)
def test_nothing_but_the_offered_settings_is_taken(tmp_path, wanted):
    with pytest.raises(InputError):
        command(wanted, tmp_path)
