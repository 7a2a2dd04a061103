import asyncio
import http.client

import pytest
from starlette.responses import JSONResponse
from starlette.routing import Route

from coral.access import Access
from coral.errors import InputError
from coral.web import WebServer, check_free, content_policy, guarded, read_json

TOKEN = "a-token-of-our-own"
PAGE = "<style>p{}</style><script>1</script>"
ADMITTED = {"authorization": f"Bearer {TOKEN}"}


async def echo(request):
    return JSONResponse(await read_json(request, 50))


def ask(server, method, path, body=None, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", server.access.port, timeout=30)
    connection.request(method, path, body, {name.replace("_", "-"): value for name, value in headers.items()})
    response = connection.getresponse()
    content = response.read()
    connection.close()
    return response, content


@pytest.fixture(scope="module")
def server():
    with WebServer([Route("/echo", echo, methods=["POST"])], page=PAGE, token=TOKEN) as server:
        yield server


def test_the_page_runs_its_own_script_and_style_and_nothing_else(server):
    response, content = ask(server, "GET", "/", **ADMITTED)
    assert content.decode() == PAGE
    policy = response.headers["Content-Security-Policy"]
    assert policy == content_policy(PAGE)
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert response.headers["Cache-Control"] == "no-store"
    assert response.headers["X-Content-Type-Options"] == "nosniff"
    assert "script-src 'none'" in content_policy("")


@pytest.mark.parametrize(
    ("body", "headers", "status"),
    [
        (b'{"a": 1}', {}, 200),
        (b'{"a": 1}', {"X-Coral": "2"}, 403),
        (b'{"a": 1}', {"Content-Type": "text/plain"}, 415),
        (b'{"a": "' + b"x" * 50 + b'"}', {}, 413),
        (b'{"a": NaN}', {}, 400),
        (b"[1]", {}, 400),
        (b"\xff\xfe", {}, 400),
        (b"[" * 40, {}, 400),
        (b'{"a": 1}', {"Origin": "http://evil.com"}, 403),
        (b'{"a": 1}', {"Host": "evil.com"}, 421),
    ],
)
def test_only_a_small_json_object_of_our_own_page_is_read(server, body, headers, status):
    sent = {"X-Coral": "1", "Content-Type": "application/json", **ADMITTED, **headers}
    response, content = ask(server, "POST", "/echo", body, **sent)
    assert response.status == status
    assert (b"error" in content) == (status != 200)


def test_a_long_body_without_a_length_is_not_read_to_its_end(server):
    sent = {"X-Coral": "1", "Content-Type": "application/json", **ADMITTED}
    assert ask(server, "POST", "/echo", iter([b"{" * 30] * 30), **sent)[0].status == 413


def test_the_token_becomes_a_cookie(server):
    assert ask(server, "GET", "/")[0].status == 401
    response, _ = ask(server, "GET", f"/?token={TOKEN}")
    assert (response.status, response.headers["Location"]) == (303, "/")
    cookie = response.headers["Set-Cookie"].partition(";")[0]
    assert ask(server, "GET", "/", Cookie=cookie)[0].status == 200
    assert ask(server, "GET", "/echo", Cookie=cookie)[0].status == 405


def test_doubled_headers_admit_nobody():
    sent = []

    async def send(message):
        sent.append(message)

    async def app(scope, receive, send):
        raise AssertionError("let through")

    headers = [(b"host", b"127.0.0.1:80"), (b"host", b"evil.com"), (b"authorization", f"Bearer {TOKEN}".encode())]
    scope = {"type": "http", "method": "GET", "path": "/", "headers": headers}
    asyncio.run(guarded(app, Access("127.0.0.1", 80, TOKEN))(scope, None, send))
    assert sent[0]["status"] == 421


def test_a_port_in_use_is_named_with_its_flag(server):
    with pytest.raises(InputError, match=f"--live-port: found port {server.access.port} in use"):
        check_free(server.access.port, "--live-port")
    with pytest.raises(InputError, match="--live-port: found 70000"):
        check_free(70000, "--live-port")
    with pytest.raises(InputError, match=r"--host: found '192\.0\.2\.1'"):
        WebServer((), host="192.0.2.1")
