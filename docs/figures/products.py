"""Make products.png and orthomosaic.png in docs/images: the page of a survey's products, and its mosaic.

Run it from the repository: .venv/bin/python docs/figures/products.py (minutes; needs Chromium, dev packages).
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
import rasterio
from PIL import Image
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
    save_small(image)


def save_small(image: Path) -> None:
    """Keep 256 colours of a picture: half its size, and nobody sees it."""
    with Image.open(image) as opened:
        opened.convert("RGB").quantize(256).save(image, optimize=True)


def draw_mosaic(raster: Path, image: Path) -> None:
    """The orthomosaic on white, 700 pixels wide."""
    with rasterio.open(raster) as opened:
        red, green, blue, alpha = opened.read()
    bgr = np.where(alpha[:, :, None] > 0, np.dstack([blue, green, red]), 255).astype(np.uint8)
    height = round(700 * bgr.shape[0] / bgr.shape[1])
    small = cv2.resize(bgr, (700, height), interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(image), small)
    save_small(image)


def main() -> None:
    """Survey a reef with colour pictures, make the products, keep the pictures."""
    with tempfile.TemporaryDirectory() as scratch:
        run = Path(scratch) / "s1"
        flags = ["--cfg.simulator.pictures", "--quiet"]
        subprocess.run([CORAL, "reef", "run", "s1", *flags, "--out", str(run)], check=True)
        subprocess.run([CORAL, "reef", "map", str(run), "--datum", "36.95,-122.02"], check=True)
        photograph(run / "products" / "products.html", IMAGES / "products.png")
        draw_mosaic(run / "products" / "orthomosaic.tif", IMAGES / "orthomosaic.png")


if __name__ == "__main__":
    main()
