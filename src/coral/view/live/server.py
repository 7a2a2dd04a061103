"""Viser's server with access control: every request and WebSocket is checked before it is handled."""

from __future__ import annotations

import contextlib
import io
import logging
import threading
from collections.abc import Iterator
from http import HTTPStatus
from typing import Any

import viser
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from coral.access import Access, AccessResponse, new_token

HOST = "127.0.0.1"
LOOKED_AT = ("Host", "Origin", "Cookie", "Authorization")
"""Headers used by the access rules."""

_starting = threading.Lock()


class GuardedServer(viser.ViserServer):  # type: ignore[misc]
    """A local viser server that requires a token, its own host name and its own origin.

    Outgoing access is disabled too: no browser may request a public address.
    """

    def __init__(self, port: int, label: str) -> None:
        """Open the port.

        Args:
            port: Port; 0 chooses a free one.
            label: Title of the page's panel.

        Raises:
            RuntimeError: This version of viser opens its port in a way that cannot be guarded; nothing is served.
        """
        self.access: Access | None = None
        with _guard_requests(self._check) as ports, silent():
            super().__init__(HOST, port, label=label, verbose=False)
            if not ports:
                self.stop()
        if not ports:
            raise RuntimeError(f"the page of viser {viser.__version__} cannot be guarded")
        self.access = Access(HOST, self.get_port(), new_token())

    def request_share_url(self, verbose: bool = True) -> None:
        """Refuse to share the page."""

    def _check(self, request: Request) -> Response | None:
        """Return the response to a rejected request; None to let it through."""
        if self.access is None:
            return _response(AccessResponse(HTTPStatus.SERVICE_UNAVAILABLE, "The page is about to open."))
        # Join duplicate headers, so that no rule accepts them.
        headers = {name: ", ".join(request.headers.get_all(name)) for name in LOOKED_AT if name in request.headers}
        instead = self.access.refuse_or_redirect("GET", request.path, headers)
        return None if instead is None else _response(instead)


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """Suppress viser's output at start and stop."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        yield


@contextlib.contextmanager
def _guard_requests(check: Any) -> Iterator[list[int]]:
    """Run `check` before every request of a server created in this context; yield the ports that were tried.

    Viser has no hook for this, so the function that opens its port is replaced while it starts.
    """
    module: Any = websockets.asyncio.server
    serve = module.serve
    ports: list[int] = []

    def guarded(handler: Any, host: str, port: int, *, process_request: Any, **options: Any) -> Any:
        def checked(connection: ServerConnection, request: Request) -> Any:
            refused = check(request)
            return process_request(connection, request) if refused is None else refused

        ports.append(port)
        return serve(handler, host, port, process_request=checked, **{"logger": _logger(), **options})

    with _starting:
        module.serve = guarded
        try:
            yield ports
        finally:
            module.serve = serve


def _logger() -> logging.Logger:
    """Return a logger that ignores malformed requests."""
    return logging.Logger("coral.live", level=logging.CRITICAL)


def _response(instead: AccessResponse) -> Response:
    body = instead.reason.encode()
    headers = {
        "Content-Type": "text/plain; charset=utf-8",
        "Content-Length": str(len(body)),
        "Cache-Control": "no-store",
        "Referrer-Policy": "no-referrer",
        **instead.headers,
    }
    return Response(instead.status, instead.status.phrase, Headers(headers), body)
