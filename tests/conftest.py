"""Hypothesis for all tests: the same examples in every run, no limit on wall time; and a browser for the pages."""

import gc
import shutil
from importlib.util import find_spec

import pytest
from hypothesis import settings

gc.set_threshold(50_000)  # with the usual 700, a tenth of the time goes into looking for garbage

settings.register_profile("coral", deadline=None, derandomize=True)
settings.load_profile("coral")


def pytest_collection_modifyitems(items):
    """Leave out what shows a wing's work where that wing is off, as in `make wings`."""
    for item in items:
        for mark in item.iter_markers("wing"):
            if find_spec(mark.args[0]) is None:
                item.add_marker(pytest.mark.skip(reason=f"without {mark.args[0]}"))


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Keep the garbage collector from walking thousands of collected tests again and again."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.enable()


@pytest.fixture(scope="module")
def small_stills():
    """Stills of 320 x 240 pixels, where a mission is tested and not its pictures: to paint one takes half a second."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("coral.reef.simulation.stills.STILL_PX", (320, 240))
        yield


FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
NARROW_PX = 360
"""Width of a telephone's screen."""


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium. A missing one is a failure: what is not tried is not known to work.

    No longer than a module: Playwright leaves its event loop running in the thread of the tests.
    """
    from playwright.sync_api import sync_playwright

    path = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    assert path, "no Chromium on the path: install the package chromium to test the pages"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def check_for_all_eyes():
    """Checks a page by the rules of screen readers, in light and in dark, and that a narrow screen shows all of it."""
    from axe_playwright_python.sync_playwright import Axe

    def check(page):
        page.evaluate("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            broken = Axe().run(page).response["violations"]
            assert [(rule["id"], [node["html"][:120] for node in rule["nodes"]]) for rule in broken] == [], scheme
        page.set_viewport_size({"width": NARROW_PX, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= NARROW_PX

    return check
