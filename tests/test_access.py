from http import HTTPStatus

import pytest

from coral.access import Access, choose_token, is_loopback
from coral.errors import InputError

TOKEN = "t" * 24
HERE = Access("127.0.0.1", 8080, TOKEN)
HEADERS = {"Host": "127.0.0.1:8080"}
COOKIE = {"Cookie": f"coral_8080={TOKEN}"}


def status(access=HERE, target="/api", method="GET", **headers):
    refusal = access.refuse_or_redirect(method, target, {**HEADERS, **headers})
    return None if refusal is None else refusal.status


def test_the_printed_address_sets_a_cookie_that_opens_everything():
    assert HERE.url == f"http://127.0.0.1:8080/?token={TOKEN}"
    first = HERE.refuse_or_redirect("GET", f"/?token={TOKEN}", HEADERS)
    assert (first.status, first.headers["Location"]) == (HTTPStatus.SEE_OTHER, "/")
    name, _, rest = first.headers["Set-Cookie"].partition("=")
    assert "HttpOnly; SameSite=Strict" in rest
    assert status(Cookie=f"other=1; {name}={rest.partition(';')[0]}") is None


@pytest.mark.parametrize(
    ("headers", "answer"),
    [
        ({}, HTTPStatus.UNAUTHORIZED),
        ({"Cookie": f"coral_8081={TOKEN}"}, HTTPStatus.UNAUTHORIZED),
        ({"Cookie": "coral_8080=wrong"}, HTTPStatus.UNAUTHORIZED),
        ({"Cookie": "\x00;=;"}, HTTPStatus.UNAUTHORIZED),
        ({"Authorization": f"Basic {TOKEN}"}, HTTPStatus.UNAUTHORIZED),
        ({"Authorization": "Bearer wrong"}, HTTPStatus.UNAUTHORIZED),
        ({"Authorization": f"bearer {TOKEN}"}, None),
        (COOKIE, None),
        ({**COOKIE, "Origin": "http://127.0.0.1:8080"}, None),
        ({**COOKIE, "Origin": "http://evil.com"}, HTTPStatus.FORBIDDEN),
        ({**COOKIE, "Host": "evil.com:8080"}, HTTPStatus.MISDIRECTED_REQUEST),
    ],
)
def test_a_request_needs_our_name_our_page_and_the_token(headers, answer):
    assert status(**headers) == answer


def test_a_wrong_token_in_the_address_is_refused_and_one_in_another_place_is_not_looked_at():
    assert status(target="/?token=wrong") == HTTPStatus.FORBIDDEN
    assert status(target=f"/api?token={TOKEN}") == HTTPStatus.UNAUTHORIZED
    assert status(target=f"/?token={TOKEN}", method="POST") == HTTPStatus.UNAUTHORIZED


def test_without_a_token_names_are_checked_all_the_same():
    open_one = Access("127.0.0.1", 8080, "")
    assert open_one.url == "http://127.0.0.1:8080/"
    assert status(open_one) is None
    assert status(open_one, Host="evil.com:8080") == HTTPStatus.MISDIRECTED_REQUEST


@pytest.mark.parametrize(
    ("host", "header", "ours"),
    [
        ("127.0.0.1", "localhost:8080", True),
        ("127.0.0.1", "[::1]:8080", True),
        ("127.0.0.1", "192.168.0.2:8080", False),
        ("0.0.0.0", "192.168.0.2:8080", True),
        ("0.0.0.0", "evil.com:8080", False),
        ("robot.lab", "ROBOT.lab:8080", True),
        ("127.0.0.1", "127.0.0.1:8081", False),
        ("127.0.0.1", "127.0.0.1", False),
        ("127.0.0.1", "127.0.0.1.evil.com:8080", False),
        ("127.0.0.1", "a b:8080", False),
        ("127.0.0.1", None, False),
    ],
)
def test_names_that_mean_this_server(host, header, ours):
    assert Access(host, 8080, TOKEN).is_own_host(header) is ours


def test_a_token_is_made_where_others_can_reach_the_port():
    assert len(choose_token()) >= 24
    assert choose_token() != choose_token()
    assert choose_token(TOKEN) == TOKEN
    assert not is_loopback("192.168.0.2")
    assert not is_loopback("example.org")


@pytest.mark.parametrize("token", ["short", "with spaces in it", "a&b=c/d?e#f.g"])
def test_an_unfit_token_is_refused_without_being_repeated(token):
    with pytest.raises(InputError, match=f"token: found a token of {len(token)} characters") as error:
        choose_token(token)
    assert token not in str(error.value)
