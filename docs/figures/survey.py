"""Make report.png, survey.png and reefs.png in docs/images: a report, a map, and the ten reefs.

Run it from the repository: .venv/bin/python docs/figures/survey.py (a minute; needs Chromium, dev packages).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

IMAGES = Path(__file__).parent.parent / "images"
CORAL = str(Path(sys.executable).with_name("coral"))


def photograph(report: Path, image: Path) -> None:
    """The first screen of a report."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1240, "height": 1000})
        page.goto(report.as_uri())
        page.screenshot(path=str(image))
        browser.close()


def main() -> None:
    """Run the mission, draw the reefs, keep the pictures."""
    with tempfile.TemporaryDirectory() as scratch:
        run, previews = Path(scratch) / "run", Path(scratch) / "previews"
        subprocess.run([CORAL, "reef", "run", "s1", "--out", str(run), "--quiet"], check=True)
        photograph(run / "report.html", IMAGES / "report.png")
        shutil.copyfile(run / "map.png", IMAGES / "survey.png")
        subprocess.run([CORAL, "reef", "envs", "--preview", str(previews)], check=True)
        shutil.copyfile(previews / "sheet.png", IMAGES / "reefs.png")


if __name__ == "__main__":
    main()
