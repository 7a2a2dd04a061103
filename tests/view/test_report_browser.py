import pytest

from coral.view.report import write_report

pytestmark = pytest.mark.browser


@pytest.fixture
def open_page(browser):
    faults, asked = [], []

    def go(folder):
        page = browser.new_page(viewport={"width": 1240, "height": 900})
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(write_report(folder).as_uri())
        return page

    yield go
    assert faults == []
    assert [url for url in asked if not url.startswith(("file:", "data:"))] == []


def test_the_slider_moves_the_robot_and_the_map(fresh, open_page):
    page = open_page(fresh)
    end = page.get_attribute("#robot", "transform"), page.get_attribute("#cells", "href")
    page.evaluate("const s = document.getElementById('time'); s.value = 10; s.dispatchEvent(new Event('input'))")
    assert page.inner_text("#clock") == "0:10"
    then = page.get_attribute("#robot", "transform"), page.get_attribute("#cells", "href")
    assert then[0] != end[0]
    assert then[1] != end[1]
    assert "Decision 0" in page.inner_text("#now-decision")
    assert page.get_attribute("#now-seg", "src").startswith("data:image/png")


def test_a_click_on_a_decision_shows_it(fresh, open_page):
    page = open_page(fresh)
    page.locator(".map .decision").nth(1).click(force=True)
    assert "centroid 1" in page.inner_text("#now-decision")
    page.locator("[data-open]").click()
    assert page.locator("#decision-1").get_attribute("open") is not None


def test_a_click_on_a_chart_shows_its_decision_or_its_moment(fresh, open_page):
    page = open_page(fresh)
    page.locator('.chart [data-decision="0"]').click()
    assert "Decision 0" in page.inner_text("#now-decision")
    page.locator(".chart").first.click()
    assert page.get_attribute(".cursor", "x1") == "550"


def test_a_layer_can_be_hidden(fresh, open_page):
    page = open_page(fresh)
    page.locator('[data-layer="truth"]').uncheck()
    assert not page.locator("#layer-truth").is_visible()


def test_a_killed_or_empty_run_raises_no_error(killed, open_page):
    open_page(killed)
    for name in ("events.jsonl", "trajectory.csv", "attempts.jsonl", "world.yaml"):
        (killed / name).write_text("")
    open_page(killed)


def test_a_report_is_for_all_eyes(fresh, open_page, check_for_all_eyes):
    check_for_all_eyes(open_page(fresh))
