"""CONTRIBUTING.md names files, classes and registries that exist."""

import importlib
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PATHS = sorted(set(re.findall(r"`((?:src|tests|docs|benchmarks)/[\w./-]+)`", PAGE)))


@pytest.mark.parametrize("path", [path for path in PATHS if "NAME" not in path])
def test_every_file_it_names_is_there(path):
    assert (ROOT / path).exists()


def test_the_recipes_name_files():
    assert len(PATHS) > 20


@pytest.mark.parametrize(
    ("module", "names"),
    [
        ("coral.contact.scene.condition", ["BaseCondition"]),
        ("coral.contact.perception.tracker_registry", ["TRACKERS", "choose_tracker"]),
        ("coral.contact.perception.tracker", ["PoseTracker"]),
        ("coral.plugins", ["GROUPS", "OURS"]),
        ("coral.contact.mistakes.plausible", ["CONTACT_MISTAKES"]),
        ("coral.contact.episode.variants", ["VARIANTS"]),
        ("coral.reef.mission.variants", ["VARIANTS"]),
        ("coral.advisor.registry", ["ENTRIES"]),
    ],
)
def test_every_registry_is_where_it_says(module, names):
    found = importlib.import_module(module)
    assert all(hasattr(found, name) for name in names)


def test_every_room_of_contact_is_in_the_table():
    rooms = {path.parent.name for path in (ROOT / "src/coral/contact").glob("*/__init__.py")}
    table = PAGE.split("## The rooms of contact")[1].split("## ")[0]
    assert rooms == set(re.findall(r"^\| `(\w+)`(?: \(wing\))? \|", table, re.MULTILINE))


def test_every_file_of_a_release_names_the_same_version():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert re.search(
        rf"^## {re.escape(version)} - \d{{4}}-\d\d-\d\d$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE
    )
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    readme = (ROOT / "README.md").read_text()
    assert f"version-{version}-" in readme
    assert f"version = {{{version}}}" in readme
