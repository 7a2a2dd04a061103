"""The front page in a real browser: a survey from its start to its report."""

import re

import pytest
from playwright.sync_api import expect

from coral.commands.gui import choices, command
from coral.desk.front.server import FrontServer

pytestmark = pytest.mark.browser
PATIENCE_MS = 90_000
"""Only a page that never gets there waits this long."""


@pytest.fixture
def front(browser, tmp_path):
    """The page in a browser, and its server; no page may complain."""
    faults = []
    with FrontServer(tmp_path, choices(), lambda wanted: command(wanted, tmp_path)) as server:
        context = browser.new_context(viewport={"width": 1280, "height": 900})
        context.on("weberror", lambda error: faults.append(str(error.error)))
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.goto(server.url)
        yield page
        context.close()
    assert faults == []


def test_a_survey_is_started_watched_read_and_compared(front):
    survey = front.locator("#reef")
    for seed in ("1", "2"):
        survey.locator("[name=seed]").fill(seed)
        survey.locator("[name='cfg.time-limit-s']").fill("3")
        survey.locator("[name=live-speed]").fill("0")
        survey.get_by_role("button", name="Start").click()
        expect(front.locator("#jobs .card")).to_have_count(int(seed), timeout=PATIENCE_MS)
        expect(front.locator("#jobs .card").first).to_contain_text("ended", timeout=PATIENCE_MS)
    rows = front.locator("#runs tr")
    expect(rows).to_have_count(2)
    with front.context.expect_page() as opened:
        rows.first.get_by_role("button", name="Report").click()
    expect(opened.value.locator("h1").first).to_be_visible(timeout=PATIENCE_MS)
    with front.context.expect_page() as opened:
        rows.first.get_by_role("button", name="Watch").click()
    expect(opened.value.locator("#status")).to_have_text(
        re.compile("recorded|played|ended|playing"), timeout=PATIENCE_MS
    )
    for row in (0, 1):
        rows.nth(row).get_by_role("checkbox").check()
    expect(front.locator("#beside")).to_contain_text("collisions")


def test_what_a_command_refuses_is_shown_on_the_page(front):
    front.locator("#reef [name=name]").fill("s9")
    front.locator("#reef").get_by_role("button", name="Start").click()
    expect(front.locator("#error")).to_contain_text("s9", timeout=PATIENCE_MS)
