"""What the documentation shows works: its commands run, its flags exist, its links lead somewhere.

A page's `sh` blocks that begin with the command run in order, in one folder; YAML and Python blocks whose first line
is a file's name as a comment are put there first. Blocks marked `sh no-run` need a key, a person or a server: their
flags are looked up.
"""

import os
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest

from coral.cli import COMMANDS
from coral.surface import described

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("*/*.md"))]
FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMAND = re.compile(r"^(?:\.venv/bin/)?coral ", re.MULTILINE)


def blocks(page, *kinds):
    return [text for kind, text in FENCE.findall(page.read_text(encoding="utf-8")) if kind.strip() in kinds]


def runnable(page):
    return [text for text in blocks(page, "sh") if COMMAND.match(text)]


def name(page):
    return str(page.relative_to(ROOT))


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if runnable(page)], ids=name)
def test_the_commands_of_a_page_run(page, tmp_path, environment, fast_coral):
    for text in blocks(page, "yaml", "python"):
        if match := re.match(r"# ([\w-]+\.(?:yaml|py))$", text.split("\n", 1)[0]):
            (tmp_path / match[1]).write_text(text)
    path = os.pathsep.join([str(fast_coral), environment["PATH"]])
    for text in runnable(page):
        script = text.replace(".venv/bin/coral", "coral")
        done = subprocess.run(
            ["bash", "-euc", script],
            cwd=tmp_path,
            env={**environment, "PATH": path},
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
        assert done.returncode == 0, f"{script}\n{done.stderr}"


def shown(page):
    return "\n".join(blocks(page, "sh", "sh no-run")).replace("\\\n", " ")


@cache
def known(command):
    """The words that select a flag of a command."""
    return {spelling for flag in described(COMMANDS[command][0]).flags for spelling in flag.spellings}


@pytest.mark.parametrize("page", [page for page in PAGES if COMMAND.search(shown(page))], ids=name)
def test_the_flags_of_a_page_exist(page):
    for line in shown(page).splitlines():
        words = line.partition(" #")[0].replace(".venv/bin/coral", "coral").split()
        if words[:2] == ["git", "checkout"]:
            break  # the rest is of that commit
        if words[:1] != ["coral"]:
            continue
        two = " ".join(words[1:3]) if " ".join(words[1:3]) in COMMANDS else words[1]
        for flag in re.findall(r"(?<=\s)(--[a-z][\w.-]*)", line):
            assert flag in (*known(two), "--help"), f"{flag} in: {line}"


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=name)
def test_links_lead_somewhere(page):
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    links = [link.partition("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", text)]
    assert [link for link in links if link and "://" not in link and not (page.parent / link).exists()] == []


def test_every_page_of_the_guide_is_on_the_landing_page_and_the_others_in_the_index_of_their_folder():
    for folder, index in {"guide": "", "reference": "reference/", "research": "research/"}.items():
        text = (DOCS / index / "index.md").read_text(encoding="utf-8")
        pages = {page.relative_to(DOCS / index).as_posix() for page in (DOCS / folder).glob("*.md")}
        assert {page for page in pages - {"index.md"} if f"({page})" not in text} == set()


def test_every_picture_is_shown():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert [p.name for p in sorted((DOCS / "images").iterdir()) if f"images/{p.name}" not in text] == []
