"""Make live-task.png in docs/images: the page of a running contact task.

Run it from the repository: .venv/bin/python docs/figures/live_task.py (a minute; needs Chromium, dev packages).
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

IMAGES = Path(__file__).parent.parent / "images"
CORAL = str(Path(sys.executable).with_name("coral"))
FLAGS = ["--no-sandbox"]


def main() -> None:
    """Run the task slowly, and photograph its page in the middle."""
    with tempfile.TemporaryDirectory() as scratch, sync_playwright() as playwright:
        words = ["--world", "hand", "--poses", "ground-truth", "--samples", "40", "--quiet", "--out", f"{scratch}/run"]
        live = ["--live", "--live-port", "0", "--live-speed", "0.08", "--no-wait"]
        command = [CORAL, "contact", "run", "flip-wall", *words, *live]
        task = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert task.stderr is not None
        found = re.search(r"http://\S+", task.stderr.readline())
        assert found is not None
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 820})
        page.set_default_timeout(120_000)
        page.goto(found[0])
        page.get_by_text("stage “lift”").first.wait_for()
        page.wait_for_timeout(8000)
        page.screenshot(path=str(IMAGES / "live-task.png"))
        browser.close()
        task.terminate()
        task.wait()


if __name__ == "__main__":
    main()
