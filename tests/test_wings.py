"""The spine stands without its wings: it imports, helps and runs; what is missing is said in a line."""

import os
import re
import subprocess
import sys

import grimp
import pytest

from coral.cli import COMMANDS
from wings import ROOT, copy_without, wings

WINGS = wings()
IMPORT_ALL = """
import importlib, pkgutil, coral
for module in pkgutil.walk_packages(coral.__path__, "coral."):
    if module.name != "coral.__main__":
        importlib.import_module(module.name)
"""
CALLS = """
import sys
from coral.cli import main
sys.exit(main(sys.argv[1:]))
"""


def run(source, code, *words, cwd=None):
    environment = {**os.environ, "PYTHONPATH": str(source), "XDG_CACHE_HOME": str(source / "cache")}
    command = [sys.executable, "-c", code, *map(str, words)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, cwd=cwd or source)


def commands_of(name):
    places = [module for module in WINGS[name][0] if module.startswith("coral.commands.")]
    return {words for words, (place, _) in COMMANDS.items() if place.partition(":")[0] in places}


@pytest.fixture(scope="module")
def spine(tmp_path_factory):
    """A copy of the package without any wing."""
    source = tmp_path_factory.mktemp("spine")
    copy_without(WINGS, source)
    return source


def test_every_module_of_the_spine_imports_without_any_wing(spine):
    done = run(spine, IMPORT_ALL)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_a_reef_is_surveyed_without_any_wing(spine):
    done = run(spine, CALLS, "reef", "run", "s1", "--quiet", "--cfg.time-limit-s", "3", "--out", spine / "reef")
    assert done.returncode == 0, done.stderr
    assert "the wing coral.view, which is not installed" in done.stderr
    assert (spine / "reef/metrics.json").is_file()


@pytest.mark.slow
def test_a_task_is_attempted_without_any_wing(spine):
    shipped = (ROOT / "src/coral/contact/scene/tasks/push-force.yaml").read_text(encoding="utf-8")
    task = spine / "brief.yaml"
    task.write_text(re.sub(r"(?m)^time_limit_s: .*$", "time_limit_s: 0.6", shipped))
    done = run(
        spine, CALLS, "contact", "run", task, "--world", "hand", "--samples", "8",
        "--poses", "ground-truth", "--quiet", "--out", spine / "task",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (spine / "task/metrics.json").is_file()


def test_commands_of_missing_wings_leave_the_help_and_are_told_in_a_line(spine):
    gone = set().union(*map(commands_of, WINGS))
    assert {"reef sail", "desk", "report", "contact bench"} <= gone
    assert not {"reef run", "contact run", "config", "version"} & gone
    listed = run(spine, CALLS, "--help").stdout
    assert {words for words in COMMANDS if f"  coral {words} " in listed} == set(COMMANDS) - gone
    for words in (["reef", "sail", "s1"], ["contact", "run", "pick-box", "--world", "franka", "--robot", "sim"]):
        done = run(spine, CALLS, *words)
        assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
        assert "wing" in done.stderr


@pytest.fixture(scope="module")
def graph():
    return grimp.build_graph("coral", exclude_type_checking_imports=False, cache_dir=None)


@pytest.mark.parametrize("name", WINGS)
def test_a_wing_needs_the_wings_that_its_page_names_and_no_other(graph, name):
    """Its page is the docstring of its package."""
    page = (ROOT / "src" / name.replace(".", "/") / "__init__.py").read_text(encoding="utf-8")
    text = page.split('"""')[1]
    assert "\nA wing." in text
    told = {other for other in WINGS if f"`{other}`" in text}
    needed = set()
    for module in WINGS[name][0]:
        for part in {module} | graph.find_descendants(module):
            needed |= {other for other in WINGS if any(_in(used, WINGS[other][0]) for used in imported(graph, part))}
    assert needed - {name} == told


def imported(graph, module):
    return graph.find_modules_directly_imported_by(module)


def _in(module, packages):
    return any(module == package or module.startswith(f"{package}.") for package in packages)
