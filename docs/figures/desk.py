"""Make docs/images/desk.png: the desk in a browser, in the middle of a real mission.

Run it from the repository: .venv/bin/python docs/figures/desk.py (a minute; needs Chromium and the dev packages).
The rules answer until the survey is well under way; then one answer is wrong on purpose, so that a refusal shows.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from coral.advisor.question import Rejection
from coral.desk.inbox import Inbox
from coral.desk.server import DeskServer
from coral.reef.decide.heuristic import REEF_RULES

IMAGE = Path(__file__).parent.parent / "images" / "desk.png"
QUESTIONS = 2
"""Answered by the rules before the picture."""


def answer(inbox: Inbox, question_id: str) -> bool:
    """Answer one question; True when it is the one to show."""
    question = inbox.question(question_id)
    visited = [dot["index"] for dot in question["facts"]["centroids"] if dot["visited"]]
    late = int(question_id.partition("-")[0]) > QUESTIONS and question["kind"] == "reef-centroid"
    if question["rejections"]:
        return True
    if late and visited:
        reply: Any = {"selected_centroid_index": visited[0], "reason": "It is dense there."}
    else:
        reasons = [Rejection(**rejection) for rejection in question["rejections"]]
        reply = REEF_RULES[question["kind"]](question["facts"], reasons).model_dump(mode="json")
    inbox.answer(question_id, reply, "Ana")
    return False


def photograph(url: str) -> None:
    """Open the desk, point at the best dot, and take the picture."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(url)
        page.get_by_label("Operator").fill("Ana")
        page.get_by_label("Operator").press("Enter")
        page.locator(".choices button:not(.spent)").first.click()
        page.wait_for_load_state("load")
        page.wait_for_function("[...document.images].every(image => image.complete && image.naturalWidth)")
        page.screenshot(path=str(IMAGE))
        browser.close()


def main() -> None:
    """Run a mission, answer it, photograph the desk, end the mission."""
    with tempfile.TemporaryDirectory() as temporary:
        inbox = Inbox(Path(temporary) / "inbox")
        words = [
            "reef",
            "run",
            "s1",
            "--advisor",
            "desk",
            "--inbox",
            str(inbox.folder),
            "--out",
            "runs/s1",
            "--quiet",
            "--cfg.latency",
            "fixed:10",
        ]
        mission = subprocess.Popen([sys.executable, "-m", "coral.cli", *words], cwd=temporary)
        shown = False
        try:
            with DeskServer(inbox, port=0) as server:
                while not shown and mission.poll() is None:
                    asked = [entry.id for entry in inbox.entries() if entry.state == "open"]
                    shown = any(answer(inbox, question_id) for question_id in asked)
                    time.sleep(0.2)
                if shown:
                    photograph(server.url)
        finally:
            mission.terminate()
            mission.wait()
    if not shown:
        sys.exit("the mission ended before the picture was taken")


if __name__ == "__main__":
    main()
