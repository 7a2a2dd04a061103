import pytest

from coral.advisor.scrub import public_url, scrub


def test_keys_of_the_environment_are_removed_whatever_they_look_like(monkeypatch):
    monkeypatch.setenv("SOME_API_KEY", "swordfish1")
    monkeypatch.setenv("SOME_PASSWORD", "short")
    monkeypatch.setenv("SOME_PLACE", "greenland1")
    assert scrub("swordfish1, short, greenland1") == "***, short, greenland1"


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("Incorrect API key: sk-proj-Ab*****12.", "Incorrect API key: ***."),
        ("key=AIzaSyA1234567890", "key=***"),
        ("Authorization: Bearer abc.def+ghi=", "Authorization: Bearer ***"),
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
