"""The one web server: pages and their data on one port, behind one set of rules for access, sizes and content."""

from __future__ import annotations

import asyncio
import base64
import errno
import hashlib
import json
import re
import socket
import threading
from collections.abc import Sequence
from http import HTTPStatus
from typing import Any, Self

import uvicorn
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import BaseRoute, Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from coral.access import Access, choose_token
from coral.errors import InputError
from coral.foreign_file import parse_json

HOST = "127.0.0.1"
HEADER = "X-Coral"
"""Requests that change something carry `X-Coral: 1`, for which a page of another site never gets permission."""
BODY_LIMIT = 256 * 1024
"""Maximum size of a request's body, bytes."""


class WebServer:
    """Serves an application on a thread of its own from `with` on; every request is checked first."""

    def __init__(
        self,
        routes: Sequence[BaseRoute],
        *,
        page: str = "",
        host: str = HOST,
        port: int = 0,
        token: str = "",
        flag: str = "--port",
    ) -> None:
        """Bind to an address; port 0 chooses a free one, and `flag` is its name on the command line.

        The `page` is HTML that is served at /, and runs no other script and style than its own. The token is required
        in `?token=` (once; a cookie follows) or in `Authorization: Bearer`; one is made if none is given.

        Raises:
            InputError: The port is in use, the address is not one of this machine's, or the token is unsuitable.
        """
        token = choose_token(token)
        self._socket = bind(host, port, flag)
        self.access = Access(host, self._socket.getsockname()[1], token)
        self._app = guarded(application(routes, page), self.access, page)
        self._thread: threading.Thread | None = None

    @property
    def url(self) -> str:
        """Return the URL for a browser, token included."""
        return self.access.url

    def __enter__(self) -> Self:
        config = uvicorn.Config(
            self._app,
            log_config=None,
            access_log=False,  # a request line could contain the token
            server_header=False,
            lifespan="off",
            ws="none",
            timeout_keep_alive=20,
            timeout_graceful_shutdown=1,
        )
        self._server = uvicorn.Server(config)
        serving = self._server.serve(sockets=[self._socket])
        self._thread = threading.Thread(target=asyncio.run, args=(serving,), name="coral-web", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Disconnect everybody and release the port."""
        if self._thread is not None:
            self._server.should_exit = True
            self._thread.join()
        self._socket.close()


def bind(host: str, port: int, flag: str = "--port") -> socket.socket:
    """Open a listening socket.

    Raises:
        InputError: The port is invalid or in use, or the address is not one of this machine's.
    """
    if not 0 <= port <= 65535:
        raise InputError(flag, "", port, "a port from 1 to 65535, or 0 for a free one")
    try:
        return socket.create_server((host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            found = f"port {port} in use on {host}"
            raise InputError(flag, "", found, "a free port (another page may be open), or 0 for any") from None
        if error.errno == errno.EACCES:
            raise InputError(flag, "", f"port {port}, which needs special rights", "1024 or above") from None
        raise InputError("--host", "", f"{host!r} ({error.strerror})", "an address of this machine") from None


def check_free(port: int, flag: str) -> None:
    """Refuse a port on which no page can be opened.

    Raises:
        InputError: The port is in use or invalid.
    """
    bind(HOST, port, flag).close()


def application(routes: Sequence[BaseRoute], page: str = "") -> ASGIApp:
    """Return an application of routes that answers errors as JSON, and serves a page at /."""

    async def fail(_: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        reason = "There is nothing here." if error.detail == "Not Found" else error.detail
        return JSONResponse({"error": reason}, error.status_code)

    async def front(_: Request) -> Response:
        return HTMLResponse(page)

    first = [Route("/", front)] if page else []
    return Starlette(routes=[*first, *routes], exception_handlers={HTTPException: fail})


def guarded(app: ASGIApp, access: Access, page: str = "") -> ASGIApp:
    """Return an application that refuses strangers, and adds the headers that keep a page to itself."""
    common = [
        (b"cache-control", b"no-store"),
        (b"content-security-policy", content_policy(page).encode()),
        (b"x-content-type-options", b"nosniff"),
        (b"referrer-policy", b"no-referrer"),
        (b"x-frame-options", b"DENY"),
        (b"cross-origin-resource-policy", b"same-origin"),
    ]

    async def answer(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return

        async def sealed(message: Message) -> None:
            if message["type"] == "http.response.start":
                kept = [pair for pair in message.get("headers", ()) if pair[0].lower() != b"cache-control"]
                message = {**message, "headers": [*kept, *common]}
            await send(message)

        headers: dict[str, str] = {}
        for name, value in scope["headers"]:  # doubled headers are joined, so that no rule accepts them
            key, text = name.decode("latin-1").title(), value.decode("latin-1")
            headers[key] = f"{headers[key]}, {text}" if key in headers else text
        target = f"{scope['path']}?{scope.get('query_string', b'').decode('latin-1')}"
        instead = access.refuse_or_redirect(scope["method"], target, headers)
        if instead is None:
            await app(scope, receive, sealed)
            return
        body = json.dumps({"error": instead.reason}).encode() if instead.reason else b""
        head = {"Content-Type": "application/json", "Content-Length": str(len(body)), **instead.headers}
        encoded = [(name.lower().encode(), value.encode()) for name, value in head.items()]
        await sealed({"type": "http.response.start", "status": int(instead.status), "headers": encoded})
        await sealed({"type": "http.response.body", "body": body})

    return answer


async def read_json(request: Request, limit: int = BODY_LIMIT) -> dict[str, Any]:
    """Read the JSON object that a page or a program sent.

    Raises:
        HTTPException: It comes without the header of our own pages, is too long, or is no JSON object.
    """
    if request.headers.get(HEADER) != "1":
        raise HTTPException(
            HTTPStatus.FORBIDDEN, f"Sent without the header {HEADER}: 1, as a page of another site would."
        )
    if request.headers.get("Content-Type", "").partition(";")[0].strip().lower() != "application/json":
        raise HTTPException(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "Send it as application/json.")
    body = b""
    length = request.headers.get("Content-Length", "0")
    if not (length.isdigit() and len(length) < 13 and int(length) <= limit):
        raise HTTPException(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"At most {limit} bytes are read.")
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit:
            raise HTTPException(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"At most {limit} bytes are read.")
    try:
        content = parse_json(body, _no_constant)
    except ValueError as error:
        raise HTTPException(HTTPStatus.BAD_REQUEST, f"The request is not valid JSON: {error}") from None
    if not isinstance(content, dict):
        raise HTTPException(HTTPStatus.BAD_REQUEST, "The request must be a JSON object.")
    return content


def content_policy(page: str) -> str:
    """Return the Content-Security-Policy of a page that runs only its own style and script and loads nothing else."""

    def own(tag: str) -> str:
        found = re.findall(rf"<{tag}>(.*?)</{tag}>", page, re.DOTALL)
        digests = (base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in found)
        return " ".join(f"'sha256-{digest}'" for digest in digests) or "'none'"

    return (
        f"default-src 'none'; script-src {own('script')}; style-src {own('style')}; "
        "img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


def _no_constant(name: str) -> Any:
    raise ValueError(f"{name} is not JSON")
