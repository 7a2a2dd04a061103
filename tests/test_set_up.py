"""What a user installs, and what a developer: `make demo` and `make test`."""

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
    assert "requirements.py contact" in told
    assert ("--group dev" in told) == developer
    assert ("vehicle" in told) == developer


def test_modules_are_compiled_once_whatever_a_container_sets(monkeypatch):
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    told = subprocess.run(
        ["make", "--eval", "told: ; @env", "told"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert "OMP_NUM_THREADS=1\n" in told.stdout
    assert "PYTHONDONTWRITEBYTECODE" not in told.stdout
