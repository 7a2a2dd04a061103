"""Who may open the live page: tested with a WebSocket client, which can claim whatever a browser would."""

import http.client

import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from coral.view.live.pace import Pace
from coral.view.live.page import LivePage
from coral.view.live.panel import MissionControls, ReplayControls


@pytest.fixture(params=["mission", "replay"])
def page(request):
    controls = (
        MissionControls(Pace())
        if request.param == "mission"
        else ReplayControls(Pace(1.0), 10.0, lambda t: None, lambda playing: None)
    )
    with LivePage(0, controls) as page:
        yield page


def get(page, target, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=10)
    try:
        connection.request("GET", target, headers=headers)
        response = connection.getresponse()
        return response, response.read()
    finally:
        connection.close()


def cookie(page):
    """The cookie that a browser gets for the address that was printed."""
    response, _ = get(page, page.url.removeprefix(f"http://127.0.0.1:{page.port}"))
    assert (response.status, response.headers["Location"]) == (303, "/")
    kept, _, rules = response.headers["Set-Cookie"].partition(";")
    assert {"HttpOnly", "SameSite=Strict"} <= {rule.strip() for rule in rules.split(";")}
    return kept


def opened(page, origin=None, **headers):
    """The status of a WebSocket's handshake; 101 is the page's own."""
    try:
        with connect(
            f"ws://127.0.0.1:{page.port}/",
            origin=origin,
            additional_headers=headers,
            subprotocols=[f"viser-v{viser.__version__}"],
            compression=None,
        ) as socket:
            assert socket.recv(timeout=10)  # the scene
            return 101
    except InvalidStatus as refusal:
        return refusal.response.status_code


def test_our_own_page_is_let_in(page):
    kept = cookie(page)
    response, content = get(page, "/", Cookie=kept)
    assert response.status == 200
    assert b"<html" in content
    assert opened(page, f"http://127.0.0.1:{page.port}", Cookie=kept) == 101


def test_a_program_with_the_token_is_let_in(page):
    token = page.url.partition("?token=")[2]
    assert opened(page, None, Authorization=f"Bearer {token}") == 101


@pytest.mark.parametrize("origin", ["http://evil.com", "null", "http://127.0.0.1:1", "https://127.0.0.1:{port}"])
def test_pages_of_other_sites_get_nothing(page, origin):
    assert opened(page, origin.format(port=page.port), Cookie=cookie(page)) == 403


@pytest.mark.parametrize("host", ["evil.com", "evil.com:{port}", "127.0.0.1.evil.com:{port}", "127.0.0.1:1"])
def test_names_that_were_made_to_point_here_are_refused(page, host):
    named = {"Host": host.format(port=page.port), "Cookie": cookie(page)}
    response, content = get(page, "/", **named)
    assert response.status == 421
    assert b"<html" not in content
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=10)
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13"}
    try:
        key = {"Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ=="}
        connection.request("GET", "/", headers={**named, **upgrade, **key})
        assert connection.getresponse().status == 421
    finally:
        connection.close()


def test_nothing_is_shown_without_the_token(page):
    assert opened(page) == 401
    assert opened(page, f"http://127.0.0.1:{page.port}") == 401
    assert opened(page, None, Cookie=f"coral_{page.port}=wrong") == 401
    assert opened(page, None, Authorization="Bearer wrong") == 401
    for target, status in (("/", 401), ("/index.html", 401), ("/?token=wrong", 403), ("/assets/none.js", 401)):
        response, content = get(page, target)
        assert response.status == status
        assert b"<html" not in content


def test_each_page_has_a_token_of_its_own(page):
    with LivePage(0, MissionControls(Pace())) as other:
        token, others = (each.url.partition("?token=")[2] for each in (page, other))
        assert len(token) >= 24
        assert token != others
        assert opened(other, None, Authorization=f"Bearer {token}") == 401


def test_a_page_that_cannot_be_guarded_is_not_opened(monkeypatch):
    """Should another version of viser open its port in another way, nothing may be served unguarded."""
    import viser.infra._infra as infra
    from websockets.asyncio.server import serve

    class Elsewhere:
        def __getattr__(self, name):
            import websockets

            return self if name in ("asyncio", "server") else serve if name == "serve" else getattr(websockets, name)

    monkeypatch.setattr(infra, "websockets", Elsewhere())
    with pytest.raises(RuntimeError, match="cannot be guarded"):
        LivePage(0, MissionControls(Pace()))
