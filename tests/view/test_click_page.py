"""The page of clicks over HTTP, and in a browser."""

import json
import urllib.error
import urllib.request

import cv2
import numpy as np
import pytest

from coral.view.click_page import ClickPage
from coral.web import HEADER


@pytest.fixture
def page():
    png = cv2.imencode(".png", np.full((60, 80, 3), 127, np.uint8))[1].tobytes()
    with ClickPage(["can", "box"], png, (80, 60)) as page:
        yield page


def request(page, path="", body=None, **headers):
    """Return status and body."""
    headers = {"Authorization": f"Bearer {page.access.token}", **headers}
    address = f"http://127.0.0.1:{page.access.port}/{path}"
    asked = urllib.request.Request(address, data=body, headers=headers)
    try:
        with urllib.request.urlopen(asked, timeout=5) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.read()


def send(page, content, **headers):
    body = content if isinstance(content, bytes) else json.dumps(content).encode()
    return request(page, "clicks", body, **{HEADER: "1", "Content-Type": "application/json", **headers})


def test_it_serves_the_page_and_the_picture(page):
    status, body = request(page)
    assert status == 200
    assert b"[&quot;can&quot;, &quot;box&quot;]" in body
    assert request(page, "picture.png")[1].startswith(b"\x89PNG")
    assert request(page, "../etc/passwd")[0] == 404


def test_one_pixel_for_each_object_is_an_answer(page):
    assert send(page, {"can": [3.7, 4], "box": [79.99, 59.5]})[0] == 200
    assert page.answers.get(timeout=5) == {"can": (3, 4), "box": (79, 59)}


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ({"can": [1, 2]}, b"one pixel for each of can, box"),
        ({"can": [1, 2], "box": [80, 2]}, b"box: expected a pixel of 80 x 60"),
        ({"can": [1, 2], "box": [-1, 2]}, b"box: expected a pixel of 80 x 60"),
        ({"can": [True, 2], "box": [1, 2]}, b"can: expected [column, row]"),
        ({"can": "1, 2", "box": [1, 2]}, b"can: expected [column, row]"),
    ],
)
def test_anything_else_is_refused_with_a_reason(page, content, told):
    status, body = send(page, content)
    assert status == 422
    assert told in body
    assert page.answers.empty()


def test_pages_of_other_sites_are_refused(page):
    good = {"can": [1, 2], "box": [3, 4]}
    assert send(page, good, Origin="http://evil.com")[0] == 403
    assert request(page, "clicks", json.dumps(good).encode(), **{"Content-Type": "application/json"})[0] == 403
    assert request(page, Host="evil.com")[0] == 421
    assert send(page, b" " * 20_000)[0] == 413
    assert send(page, b"[" * 9000)[0] == 400
    assert send(page, [])[0] == send(page, b'{"can": [NaN, 1], "box": [1, 2]}')[0] == 400
    assert page.answers.empty()


@pytest.mark.browser
def test_a_person_clicks_takes_back_and_sends(page, browser, check_for_all_eyes):
    shown = browser.new_page(viewport={"width": 1000, "height": 900})
    shown.goto(page.url)
    assert "Click the can (1 of 2)" in shown.inner_text("#ask")
    box = shown.locator("#picture").bounding_box()
    scale = 80 / box["width"]
    for x in (10.5, 30.5):
        shown.mouse.click(box["x"] + x / scale, box["y"] + 20.5 / scale)
    shown.click("#undo")
    assert "Click the box (2 of 2)" in shown.inner_text("#ask")
    shown.focus("#view")
    for key in ("ArrowLeft", "ArrowUp", "Enter"):
        shown.keyboard.press(key)
    shown.click("#send")
    assert page.answers.get(timeout=5) == {"can": (10, 20), "box": (39, 29)}
    shown.get_by_text("Written").wait_for(timeout=5000)
    check_for_all_eyes(shown)
