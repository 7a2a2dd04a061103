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
