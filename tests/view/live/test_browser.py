"""The viewer in a real browser: a mission and a task that go on, and recordings."""

import json
import re
import subprocess
import sys

import pytest
from playwright.sync_api import expect

from coral.view.live.viewer import Viewer

pytestmark = pytest.mark.browser
PATIENCE_MS = 60_000
"""Only a page that never gets there waits this long."""


@pytest.fixture
def visit(browser):
    """Opens pages; none of them may complain, or ask for anything from elsewhere."""
    pages, faults = [], []

    def go(url):
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        pages.append(page)
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", lambda error: faults.append(str(error)))
        here = url.partition("?")[0]
        page.on("request", lambda r: r.url.startswith((here, "data:")) or faults.append(r.url))
        page.goto(url)
        assert "token" not in page.url
        return page

    yield go
    for page in pages:
        page.close()
    assert faults == []


@pytest.fixture
def watch(visit):
    """Starts a command, opens the page that it names, and ends both."""
    started = []

    def go(*words):
        command = [sys.executable, "-m", "coral.cli", *words, "--live", "--live-port", "0", "--quiet", "--json"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        started.append(process)
        return process, visit(re.search(r"http://127\.0\.0\.1:\d+/\?token=[\w-]+", process.stderr.readline())[0])

    yield go
    for process in started:
        process.kill()
        process.communicate()


def test_a_mission_begins_with_its_viewer_is_paused_stopped_and_played_again(watch, tmp_path):
    out = tmp_path / "run"
    process, page = watch("reef", "run", "l1", "--live-speed", "1", "--out", str(out))
    status = page.locator("#status")
    expect(status).to_have_text("running", timeout=PATIENCE_MS)
    expect(page.get_by_text("asked: ").first).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_role("button", name="Pause", exact=True).click()
    expect(status).to_have_text("paused", timeout=PATIENCE_MS)
    page.get_by_role("button", name="Resume").click()
    expect(status).to_have_text("running", timeout=PATIENCE_MS)
    page.get_by_role("button", name="Stop the mission").click()
    expect(status).to_have_text("ended: stopped by the operator", timeout=PATIENCE_MS)
    page.get_by_role("button", name="Play").click()
    expect(status).to_have_text("playing", timeout=PATIENCE_MS)
    while "the page stays" not in (line := process.stderr.readline()):
        assert line, "the command ended"
    process.terminate()
    told, _ = process.communicate(timeout=60)
    assert json.loads(told)["end_reason"] == "stopped by the operator"
    assert (out / "report.html").is_file()


def test_a_recording_is_played_and_searched(visit, finished, check_for_all_eyes):
    with Viewer(finished, rate=20.0) as viewer:
        page = visit(viewer.url)
        expect(page.get_by_role("heading", name="made-up <reef>")).to_be_visible(timeout=PATIENCE_MS)
        expect(page.locator("#status")).to_have_text("ended: time limit", timeout=PATIENCE_MS)
        assert page.evaluate("rows.length") > 10
        page.get_by_label("Time in the run").fill("17")
        expect(page.locator("#status")).to_have_text("paused", timeout=PATIENCE_MS)
        expect(page.locator("#clock")).to_have_text(re.compile("17.0 s of"))
        page.get_by_role("button", name="From above").click()
        page.get_by_label("Show truth").check()
        check_for_all_eyes(page)


def test_a_task_is_watched_weighed_and_stopped(watch, tmp_path):
    out = tmp_path / "run"
    words = ["contact", "run", "pick-box", "--world", "hand", "--variant", "expert-fsm", "--samples", "8", "--no-wait"]
    process, page = watch(*words, "--poses", "ground-truth", "--live-speed", "0.05", "--out", str(out))
    expect(page.get_by_text("Cost by term, stage “reach”")).to_be_visible(timeout=PATIENCE_MS)
    page.locator("#weights input").first.focus()
    page.keyboard.press("ArrowLeft")
    expect(page.get_by_text("operator: 0.9 ×").first).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_role("button", name="Stop the task").click()
    process.communicate(timeout=60)
    assert process.returncode == 0
    events = [json.loads(line) for line in (out / "events.jsonl").read_text().splitlines()]
    assert events[-1]["reason"] == "stopped by the operator"
    assert [event["by"] for event in events if event["event"] == "weight"] == ["operator"]
