"""The site: every page has its place, and what only the site has leads somewhere."""

import importlib
import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
spec = importlib.util.spec_from_file_location("build", ROOT / "docs" / "site" / "build.py")
assert spec is not None
assert spec.loader is not None
build = importlib.util.module_from_spec(spec)
spec.loader.exec_module(build)


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


def test_a_page_in_no_section_stands_under_more(tmp_path: Path) -> None:
    (tmp_path / "new-page.md").write_text("# New\n")
    assert "More\n\nnew-page\n" in build.write_navigation(tmp_path)


def test_links_to_the_project_lead_to_its_pages_and_links_to_sources_keep_their_words() -> None:
    text = "See [how](../CONTRIBUTING.md#style), [runs](../src/coral/advisor/recordings/README.md), [a page](index.md)."
    assert build.redirect_links(text) == "See [how](CONTRIBUTING.md#style), runs, [a page](index.md)."


@pytest.mark.parametrize("module", sorted({name for _, names in build.REFERENCE.values() for name in names}))
def test_the_reference_has_something_to_say_of_each_module(module: str) -> None:
    assert (importlib.import_module(module).__doc__ or "").strip()
