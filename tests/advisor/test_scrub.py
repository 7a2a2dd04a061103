import base64
import html
import json
from urllib.parse import quote, quote_plus

import pytest

from coral.advisor.scrub import public_url, scrub, scrub_values


def test_keys_of_the_environment_are_removed_whatever_they_look_like(monkeypatch):
    monkeypatch.setenv("SOME_API_KEY", "swordfish1")
    monkeypatch.setenv("SOME_PASSWORD", "short")
    monkeypatch.setenv("SOME_PLACE", "greenland1")
    assert scrub("swordfish1, short, greenland1") == "***, short, greenland1"


def test_keys_are_removed_in_every_usual_encoding(monkeypatch):
    key = 'sw/ord+fi"sh &1=é'
    monkeypatch.setenv("SOME_API_KEY", key)
    raw = key.encode()
    codes = [base64.b64encode(raw).decode(), base64.urlsafe_b64encode(raw).decode(), raw.hex()]
    for form in (
        key,
        quote(key),
        quote(key, safe=""),
        quote_plus(key),
        html.escape(key),
        json.dumps(key)[1:-1],
        *codes,
    ):
        assert scrub(f"<{form.rstrip('=')}>") == "<***>"
    assert scrub_values({key: [1, None, (key, {"a": f"x{key}"})]}) == {"***": [1, None, ("***", {"a": "x***"})]}


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("Incorrect API key: sk-proj-Ab*****12.", "Incorrect API key: ***."),
        ("key=AIzaSyA1234567890", "key=***"),
        ("Authorization: Bearer abc.def+ghi=", "Authorization: Bearer ***"),
        ("Basic dXNlcjpwYXNz", "Basic ***"),
        ("the bearer of a task-force", "the bearer of a task-force"),
    ],
)
def test_what_looks_like_a_key_is_removed(text, left):
    assert scrub(text) == left


@pytest.mark.parametrize(
    ("url", "public"),
    [
        ("http://me:hunter2@host:8080/v1?key=abc#x", "http://host:8080/v1"),
        ("https://host/v1", "https://host/v1"),
        ("http://user@[::1]:80/", "http://[::1]:80/"),
    ],
)
def test_a_public_url_holds_no_credentials(url, public):
    assert public_url(url) == public
