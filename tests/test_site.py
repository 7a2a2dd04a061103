"""The site: every page has its place, and what only the site has leads somewhere."""

import importlib
import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
GUIDE = [ROOT / "README.md", *sorted((ROOT / "docs" / "guide").glob("*.md"))]
spec = importlib.util.spec_from_file_location("build", ROOT / "docs" / "site" / "build.py")
assert spec is not None
assert spec.loader is not None
build = importlib.util.module_from_spec(spec)
spec.loader.exec_module(build)
tables = importlib.import_module("tables")


def test_the_navigation_leads_to_every_page_once(tmp_path: Path) -> None:
    build.collect_pages(tmp_path)
    blocks = re.findall(r"```\{toctree\}\n(.*?)```", (tmp_path / "index.md").read_text(), re.S)
    named = [line for block in blocks for line in block.splitlines() if line and not line.startswith(":")]
    pages = {
        path.relative_to(tmp_path).with_suffix("").as_posix()
        for path in tmp_path.rglob("*")
        if path.suffix in (".md", ".rst")
    }
    assert sorted(named) == sorted(pages - {"index"})


def test_the_guide_is_read_in_its_order_and_a_new_page_comes_last(tmp_path: Path) -> None:
    (tmp_path / "guide").mkdir()
    for name in ("a-new-page", "your-reef", "install"):
        (tmp_path / "guide" / f"{name}.md").write_text("# Page\n")
    assert "guide/install\nguide/your-reef\nguide/a-new-page\n" in build.write_navigation(tmp_path)


def test_every_page_of_the_guide_has_its_place() -> None:
    assert sorted(build.GUIDE) == sorted(path.stem for path in (ROOT / "docs" / "guide").glob("*.md"))


def test_links_to_the_project_lead_to_its_pages_and_links_to_sources_keep_their_words() -> None:
    text = (
        "See [how](../CONTRIBUTING.md#style), [runs](../../src/coral/advisor/recordings/README.md), [this](index.md)."
    )
    assert build.redirect_links(text) == "See [how](CONTRIBUTING.md#style), runs, [this](index.md)."
    assert build.redirect_links("[how](../../CONTRIBUTING.md)") == "[how](../CONTRIBUTING.md)"


@pytest.mark.parametrize("module", sorted({name for _, names in build.PYTHON.values() for name in names}))
def test_the_python_pages_have_something_to_say_of_each_module(module: str) -> None:
    assert (importlib.import_module(module).__doc__ or "").strip()


def test_every_table_that_a_page_names_is_made_and_every_table_is_named() -> None:
    named = [name for page in (ROOT / "docs").glob("*/*.md") for name in tables.MARK.findall(page.read_text("utf-8"))]
    assert set(named) == set(tables.TABLES)


@pytest.mark.parametrize("name", sorted(tables.TABLES))
def test_a_table_has_rows_that_all_say_something(name: str) -> None:
    lines = [line for line in tables.TABLES[name]().splitlines() if line.startswith(("| `", "| ready"))]
    assert lines
    assert len({len(re.split(r"(?<!\\)\|", line)) for line in lines}) == 1


@pytest.mark.parametrize(
    "name", ["task-file", "world-file", "survey-file", "camera-file", "cost-file", "memory-file", "variants-survey"]
)
def test_every_key_and_variant_has_a_text(name: str) -> None:
    assert [line for line in tables.TABLES[name]().splitlines() if re.search(r"\| (None)? ?\|$", line)] == []


def test_tables_tell_what_the_code_knows() -> None:
    from coral import limits
    from coral.advisor.registry import ENTRIES
    from coral.cli import COMMANDS
    from coral.plugins import GROUPS
    from coral.reef.vehicle.states import CHANGES

    made = {name: make() for name, make in tables.TABLES.items()}
    assert all(f"## coral {name}\n" in made["commands"] for name in COMMANDS)
    assert "| `attempt_timeout_s` | 45 s |" in made["settings-model"]
    assert f"| `YAML_BYTES` | {limits.YAML_BYTES:,.0f} | Of a YAML file" in made["limits"]
    assert made["limits"].count("\n| `") == len([name for name in vars(limits) if name.isupper()])
    assert all(f"| `{entry.form}` |" in made["advisors"] for entry in ENTRIES)
    assert all(f"| `{group}` |" in made["entry-points"] for group in GROUPS)
    assert made["states"].count("\n| ") == len(CHANGES)
    assert "| `at-object` |" in made["conditions"]


def test_a_table_written_by_hand_explains_and_lists_no_facts_of_the_code() -> None:
    """A new one with facts is made in docs/site/tables.py; one that explains is named here."""
    by_hand = {
        (page.name, match[1].partition(" |")[0])
        for page in (ROOT / "docs/reference").glob("*.md")
        for match in re.finditer(r"(?<!\|\n)^\| (.*) \|$\n\|---", page.read_text("utf-8"), re.M)
    }
    assert by_hand == {
        ("glossary.md", "word"),
        ("index.md", "for everything"),
        ("index.md", "CORAL (reef)"),
        ("index.md", "CoRAL (hand)"),
        ("sonar-and-navigation.md", "lost"),
        ("task-questions.md", "question"),
    }


def test_the_guide_is_short_and_no_diary() -> None:
    pages = {page.name: page.read_text(encoding="utf-8") for page in GUIDE}
    assert len(pages) - 1 <= 20
    assert {name: len(text.split()) for name, text in pages.items() if len(text.split()) > 900} == {}
    assert [name for name, text in pages.items() if re.search(r"\bcommit [0-9a-f]{7}|\bmeasured on\b", text)] == []


def test_a_name_that_is_no_table_is_told_in_one_line():
    with pytest.raises(SystemExit, match=r"^tables.py: --help: no such table; without a name, it lists them$"):
        tables.asked(["--help"])
