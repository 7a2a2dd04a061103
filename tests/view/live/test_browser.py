"""The live page in a real browser."""

import json
import re
import shutil
import subprocess
import sys

import pytest
from playwright.sync_api import expect, sync_playwright

pytestmark = pytest.mark.browser
PATIENCE_MS = 60_000
"""Only a page that never gets there waits this long; WebGL in software is slow on a busy machine."""
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="module")
def browser():
    path = shutil.which("chromium") or shutil.which("google-chrome")
    assert path, "no Chromium on the path: install the package chromium to test the page"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def watch(browser):
    """Starts a command, opens the page that it names, and ends both."""
    started, faults, asked = [], [], []

    def go(*words):
        process = subprocess.Popen(
            [sys.executable, "-m", "coral.cli", *words, "--json"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        url, token = re.search(r"(http://127\.0\.0\.1:\d+/)(\?token=[\w-]+)", process.stderr.readline()).groups()
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda r: r.url.startswith((url, "data:", "blob:")) or asked.append(r.url))
        page.goto(url + token)
        assert "token" not in page.url
        return process, page

    yield go
    for process in started:
        process.kill()
        process.communicate()
    for page in [page for context in browser.contexts for page in context.pages]:
        page.close()
    assert faults == []
    assert asked == []


def see(page, text):
    expect(page.get_by_text(text).first).to_be_visible(timeout=PATIENCE_MS)


def test_a_mission_is_watched_paused_and_stopped(watch, tmp_path):
    process, page = watch(
        "reef",
        "run",
        "l1",
        "--live",
        "--live-port",
        "0",
        "--live-speed",
        "1",
        "--quiet",
        "--out",
        str(tmp_path / "run"),
    )
    see(page, "coverage")
    see(page, "OPEN QUESTION")
    see(page, "Cost of the plan, by term")
    page.get_by_role("button", name="Pause").click()
    expect(page.locator("#status")).to_have_text("paused", timeout=PATIENCE_MS)
    page.get_by_role("button", name="Resume").click()
    expect(page.locator("#status")).to_contain_text("running", timeout=PATIENCE_MS)
    page.get_by_role("button", name="Stop the mission").click()
    expect(page.locator("#status")).to_have_text("ended: stopped by the operator", timeout=PATIENCE_MS)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert json.loads(out)["end_reason"] == "stopped by the operator"


def test_a_recording_is_played_and_searched(watch, finished):
    _, page = watch("replay", str(finished), "--port", "0", "--speed", "20")
    see(page, "made-up <reef>")
    expect(page.locator("#status")).to_have_text("ended: time limit", timeout=PATIENCE_MS)
    see(page, "67 %")
    box = page.get_by_role("textbox").filter(visible=True).first
    box.fill("17")
    box.press("Enter")
    see(page, "Not valid JSON.")
    page.get_by_role("button", name="Play").click()
    expect(page.locator("#status")).to_have_text("ended: time limit", timeout=PATIENCE_MS)


def test_a_contact_task_is_watched_weighed_and_stopped(watch, tmp_path):
    out = tmp_path / "run"
    words = ["contact", "run", "pick-box", "--world", "hand", "--variant", "expert-fsm", "--samples", "8"]
    words += [
        "--poses",
        "ground-truth",
        "--live",
        "--live-port",
        "0",
        "--live-speed",
        "0.05",
        "--quiet",
        "--out",
        str(out),
    ]
    process, page = watch(*words)
    see(page, "Cost by term, stage reach")
    see(page, "Force on the hand (N)")
    page.get_by_role("slider").first.focus()
    page.keyboard.press("ArrowLeft")
    changed = page.get_by_text("weights changed", exact=True).locator("xpath=following-sibling::div")
    expect(changed).to_have_text("1", timeout=PATIENCE_MS)  # the next plan takes it; a stop before it would win
    page.get_by_role("button", name="Stop the task").click()
    expect(page.locator("#status")).to_have_text("ended: stopped by the operator", timeout=PATIENCE_MS)
    process.communicate(timeout=60)
    assert process.returncode == 0
    events = [json.loads(line) for line in (out / "events.jsonl").read_text().splitlines()]
    assert events[-1]["reason"] == "stopped by the operator"
    assert [event["by"] for event in events if event["event"] == "weight"] == ["operator"]
