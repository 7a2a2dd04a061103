"""What a user installs, and what a developer: `make demo` and `make test`."""

import re
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def steps(target, venv):
    """The commands of a target in an environment that does not exist yet, told and not run."""
    done = subprocess.run(
        ["make", "--dry-run", f"VENV={venv}", target], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return done.stdout


@pytest.mark.parametrize(("target", "developer"), [("setup", False), ("demo", False), ("test", True), ("check", True)])
def test_only_developers_install_what_tests_and_checks_need(target, developer, tmp_path):
    told = steps(target, tmp_path / "none")
    assert ".[contact]" in told
    assert ("--group dev" in told) == developer
    assert ("vehicle" in told) == developer


def test_a_message_names_this_package_and_an_extra_that_it_has():
    named = [
        (path.name, *found)
        for path in (ROOT / "src").rglob("*.py")
        for found in re.findall(r"pip install (?:-e )?'([\w.-]+)\[([\w,-]+)\]'", path.read_text(encoding="utf-8"))
    ]
    assert len(named) > 8
    wrong = [
        entry
        for entry in named
        if entry[1] not in (".", PROJECT["name"]) or entry[2] not in PROJECT["optional-dependencies"]
    ]
    assert wrong == []
