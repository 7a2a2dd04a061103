"""Every package that `make` installs is pinned, with the hash of each of its files."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PINS = re.sub(r" \\\n *", " ", (ROOT / "constraints.txt").read_text()).splitlines()


def name_of(requirement):
    return re.match(r"[\w.-]+", requirement)[0].lower().replace("_", "-").replace(".", "-")


def test_every_pin_has_hashes_and_no_address():
    for pin in PINS:
        assert re.match(r"[\w.-]+==[\w.!+]+ ", pin), pin
        assert re.search(r" --hash=sha256:[0-9a-f]{64}$", pin), pin
        assert "://" not in pin


def test_all_that_the_project_asks_for_is_pinned():
    extras = {**PROJECT["project"]["optional-dependencies"], **PROJECT["dependency-groups"], "train": []}
    asked = [*PROJECT["project"]["dependencies"], *(each for extra in extras.values() for each in extra)]
    assert {name_of(each) for each in asked} <= {name_of(pin) for pin in PINS}
