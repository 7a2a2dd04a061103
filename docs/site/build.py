"""Build the documentation as a site, with a reference of the Python interface made from its docstrings.

Usage: python docs/site/build.py OUT

The pages stay plain Markdown that reads in any viewer. What only a site needs is added to a copy of them: the
navigation, the project's own files, tables that the code knows, and the Python reference. A link that leads nowhere is
an error.
"""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from tables import fill

DOCS = Path(__file__).parents[1]
PROJECT = ("CONTRIBUTING.md", "CHANGELOG.md")

GUIDE = [
    *("install", "first-survey", "first-task", "read-a-report", "watch"),
    *("your-reef", "your-task", "your-cost", "your-model", "the-desk", "your-bluerov2", "your-franka", "your-camera"),
    *("map-a-recording", "results-to-take-home", "compare", "cluster", "python", "train-a-policy", "what-we-promise"),
]
"""Pages of the guide in the order in which one reads them. The other folders are in the order of their names."""

PYTHON = {
    "python": ("Missions and tasks", ["coral.interface.mission", "coral.interface.task", "coral.interface.result"]),
    "reef": (
        "Parts of a reef mission",
        [
            "coral.reef.drive.controllers",
            "coral.reef.drive.controller",
            "coral.reef.decide.own_parts",
            "coral.reef.decide.verify",
            "coral.reef.vehicle.sensing",
            "coral.reef.world.geometry",
        ],
    ),
    "contact": ("Costs, conditions, planner", ["coral.contact.cost.context", "coral.contact.cost.stages",
                "coral.contact.scene.condition", "coral.mppi.knots", "coral.mppi.weights"]),
    "advisor": ("Advisors and plugins", ["coral.advisor.question", "coral.plugins"]),
    "environments": ("Gymnasium environments", ["coral.gym.reef_env", "coral.gym.contact_env"]),
}  # fmt: skip
"""Pages about the Python interface: title and modules."""


def collect_pages(folder: Path) -> None:
    """Copy the pages into `folder`, and add what only the site has."""
    shutil.copytree(DOCS, folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    shutil.copy(DOCS / "site" / "conf.py", folder)
    for name in PROJECT:
        text = (DOCS.parent / name).read_text(encoding="utf-8")
        (folder / name).write_text(text.replace("](docs/", "]("), encoding="utf-8")
    for page in folder.rglob("*.md"):
        page.write_text(fill(redirect_links(page.read_text(encoding="utf-8"))), encoding="utf-8")
    (folder / "python").mkdir()
    for name, (title, modules) in PYTHON.items():
        lines = [title, "=" * len(title)]
        for module in modules:
            lines += ["", module, "-" * len(module), "", f".. automodule:: {module}"]
        (folder / "python" / f"{name}.rst").write_text("\n".join(lines) + "\n", encoding="utf-8")
    with (folder / "index.md").open("a", encoding="utf-8") as index:
        index.write(write_navigation(folder))


def redirect_links(text: str) -> str:
    """Let links to the project's files lead to their copies, and keep only the words of links into the source tree."""
    text = re.sub(rf"\]\(\.\./((?:\.\./)?(?:{'|'.join(map(re.escape, PROJECT))}))", r"](\1", text)
    return re.sub(
        r"\[([^\]]+)\]\((?:\.\./)+(?:src|tests|benchmarks|examples|README|LICENSE|SECURITY)[^)]*\)", r"\1", text
    )


def write_navigation(folder: Path) -> str:
    """Return the tables of contents of all sections, hidden in the page itself."""

    def pages(part: str, first: list[str]) -> list[str]:
        found = sorted(path.stem for path in (folder / part).glob("*.md"))
        return [f"{part}/{page}" for page in sorted(found, key=lambda page: (*first, page).index(page))]

    sections = {
        "Guide": pages("guide", GUIDE),
        "Reference": pages("reference", ["index"]) + [f"python/{name}" for name in PYTHON],
        "Research": pages("research", ["index"]),
        "Project": [Path(name).stem for name in PROJECT],
    }
    blocks = [
        "\n".join(["", "```{toctree}", ":hidden:", f":caption: {title}", "", *pages, "```", ""])
        for title, pages in sections.items()
    ]
    return "".join(blocks)


def main(out: str) -> int:
    """Build the site into the folder `out`. Return the exit status of Sphinx."""
    from sphinx.cmd.build import main as build_site

    with tempfile.TemporaryDirectory() as folder:
        collect_pages(Path(folder))
        return build_site(["-q", "-W", "--keep-going", "-b", "html", folder, out])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python docs/site/build.py OUT")
    sys.exit(main(sys.argv[1]))
