"""Make products.png in docs/images: the page of a survey's products.

Run it from the repository: .venv/bin/python docs/figures/products.py (minutes; needs Chromium, dev packages).
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


def photograph(page_file: Path, image: Path) -> None:
    """The page up to its table of clusters."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1000, "height": 1000}, device_scale_factor=0.8)
        page.goto(page_file.as_uri())
        height = page.evaluate("document.querySelector('#meaning').getBoundingClientRect().top + window.scrollY")
        page.set_viewport_size({"width": 1000, "height": int(height)})
        page.screenshot(path=str(image))
        browser.close()


def main() -> None:
    """Survey a reef with colour pictures, make the products, keep the picture."""
    with tempfile.TemporaryDirectory() as scratch:
        run = Path(scratch) / "s1"
        flags = ["--cfg.simulator.pictures", "--cfg.no-stop-when-covered", "--quiet"]
        subprocess.run([CORAL, "reef", "run", "s1", *flags, "--out", str(run)], check=True)
        subprocess.run([CORAL, "reef", "products", str(run), "--datum", "36.95,-122.02"], check=True)
        photograph(run / "products" / "products.html", IMAGES / "products.png")


if __name__ == "__main__":
    main()
