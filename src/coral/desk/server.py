"""The desk's web server: it serves one page and its questions, and no other files."""

from __future__ import annotations

import base64
import errno
import hashlib
import json
import re
import socket
import socketserver
import sys
import threading
import time
import urllib.parse
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from coral.access import Access, choose_token
from coral.advisor.log import plain_json
from coral.desk.inbox import Inbox, NoSuchQuestion, NotOpen, Unfit
from coral.desk.watch import InboxWatch
from coral.errors import InputError

BODY_LIMIT = 256 * 1024
"""Maximum size of a request's body, bytes."""
PAGES = 32
"""Maximum number of pages connected for live updates; each uses a thread."""
KEEP_ALIVE_S = 10.0
"""Interval of comments to a silent page, which also detect that it has disconnected."""
NAME_LIMIT = 60

PAGE = (Path(__file__).parent / "page.html").read_text(encoding="utf-8")


def _content_policy(page: str) -> str:
    """Return the Content-Security-Policy of a page that runs only its own style and script and loads nothing else."""

    def digest(tag: str) -> str:
        match = re.search(rf"<{tag}>(.*?)</{tag}>", page, re.DOTALL)
        assert match is not None
        return base64.b64encode(hashlib.sha256(match[1].encode()).digest()).decode()

    return (
        f"default-src 'none'; script-src 'sha256-{digest('script')}'; style-src 'sha256-{digest('style')}'; "
        "img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


CONTENT_POLICY = _content_policy(PAGE)


def binding_error(error: OSError, host: str, port: int) -> InputError:
    """Return the user's error behind an address to which a server cannot bind."""
    if error.errno == errno.EADDRINUSE:
        return InputError(
            "--port", "", f"port {port} in use on {host}", "a free port (another desk may be open), or 0 for any"
        )
    if error.errno == errno.EACCES:
        return InputError("--port", "", f"port {port}, which needs special rights", "1024 or above")
    return InputError("--host", "", f"{host!r} ({error.strerror})", "an address of this machine")


class DeskServer(ThreadingHTTPServer):
    """Serves one inbox until it is shut down."""

    daemon_threads = True

    def __init__(
        self, inbox: Inbox, host: str = "127.0.0.1", port: int = 8765, token: str = "", watch_period_s: float = 0.2
    ) -> None:
        """Bind to an address.

        Args:
            inbox: The inbox to serve.
            host: Address to listen on; any but this machine's own (loopback) needs a token, made if none is given.
            port: Port; 0 chooses a free one.
            token: Required in `?token=` (once; a cookie follows) or in `Authorization: Bearer`.
            watch_period_s: Interval of reading the inbox (s).

        Raises:
            InputError: The port is in use, the address is not one of this machine's, or the token is unsuitable.
        """
        if not 0 <= port <= 65535:
            raise InputError("--port", "", port, "a port from 1 to 65535, or 0 for a free one")
        token = choose_token(host, token)
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            super().__init__((host, port), _Handler)
        except OSError as error:
            raise binding_error(error, host, port) from None
        self.inbox, self.host = inbox, host
        self.access = Access(host, self.server_address[1], token)
        self.watch = InboxWatch(inbox, watch_period_s)
        self.pages = threading.BoundedSemaphore(PAGES)
        self.answered = 0
        """Number of answers accepted by this server."""

    def server_bind(self) -> None:
        """Bind without resolving this machine's name, which may take seconds."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = str(self.server_address[0]), int(self.server_address[1])

    @property
    def url(self) -> str:
        """Return the URL for a browser, token included."""
        return self.access.url

    def serve_forever(self, poll_interval: float = 0.2) -> None:
        """Answer requests until `shutdown`."""
        self.watch.start()
        super().serve_forever(poll_interval)

    def server_close(self) -> None:
        """Release the port and disconnect every page."""
        if hasattr(self, "watch"):
            self.watch.stop()
        super().server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore pages that disconnect in the middle of a request."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: DeskServer
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "coral-desk", ""
    timeout = 20.0

    def do_GET(self) -> None:
        """Serve the page, its state (live or at once), a question, or a picture."""
        if not self._is_admitted():
            return
        parts = self._parts
        if not parts:
            self._send(HTTPStatus.OK, PAGE.encode(), "text/html; charset=utf-8")
        elif parts == ["api", "state"]:
            self.server.watch.look()
            self._send(HTTPStatus.OK, self.server.watch.wait(-1, 0.0)[1].encode(), "application/json")
        elif parts == ["api", "events"]:
            self._events()
        elif parts[:2] == ["api", "questions"] and len(parts) == 3:
            try:
                content = {**self.server.inbox.question(parts[2]), "now": round(time.time(), 3)}
                self._json(HTTPStatus.OK, content)
            except NoSuchQuestion:
                self._refuse(HTTPStatus.NOT_FOUND, "There is no such question.")
        elif parts[:1] == ["pictures"] and len(parts) == 3:
            try:
                self._send(HTTPStatus.OK, self.server.inbox.picture(parts[1], parts[2]), "image/png")
            except NoSuchQuestion:
                self._refuse(HTTPStatus.NOT_FOUND, "There is no such picture.")
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "There is nothing here.")

    def do_POST(self) -> None:
        """Accept an answer."""
        # The connection cannot be reused before the body has been read.
        self.close_connection = True
        if not self._is_admitted():
            return
        # Pages of other sites need a CORS preflight to set a custom header, and it is never granted.
        if self._headers.get("X-Coral-Desk") != "1":
            self._refuse(
                HTTPStatus.FORBIDDEN, "Answers are taken from the desk's own page, or with the header X-Coral-Desk: 1."
            )
            return
        parts = self._parts
        if parts[:2] != ["api", "questions"] or parts[3:] != ["answer"]:
            self._refuse(HTTPStatus.NOT_FOUND, "There is nothing here.")
            return
        content = self._body()
        if content is not None:
            self._answer(parts[2], content)

    def _answer(self, question_id: str, content: Mapping[str, Any]) -> None:
        operator = content.get("operator", "")
        if "answer" not in content or not isinstance(operator, str):
            self._refuse(HTTPStatus.BAD_REQUEST, 'The request must be {"answer": ..., "operator": "name"}.')
            return
        try:
            self.server.inbox.answer(question_id, content["answer"], " ".join(operator.split())[:NAME_LIMIT])
        except NoSuchQuestion:
            self._refuse(HTTPStatus.NOT_FOUND, "There is no such question.")
        except NotOpen as why:
            self._refuse(HTTPStatus.CONFLICT, str(why))
        except Unfit as why:
            self._json(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                {
                    "error": "The answer does not fit the question.",
                    "faults": [
                        {"path": fault.path, "place": fault.place, "reason": fault.reason} for fault in why.faults
                    ],
                },
            )
        except OSError as error:
            self._refuse(HTTPStatus.INTERNAL_SERVER_ERROR, f"The inbox cannot be written: {error.strerror}.")
        else:
            self.server.answered += 1
            self._json(HTTPStatus.OK, {"ok": True})
        self.server.watch.look()

    def _body(self) -> Mapping[str, Any] | None:
        """Read the JSON object of the request; None after refusing it."""
        if self._headers.get("Content-Type", "").partition(";")[0].strip().lower() != "application/json":
            self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "Answers are sent as application/json.")
            return None
        length = self._headers.get("Content-Length", "")
        if not re.fullmatch(r"\d{1,12}", length):
            self._refuse(HTTPStatus.LENGTH_REQUIRED, "The length of the request is missing.")
            return None
        if int(length) > BODY_LIMIT:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"At most {BODY_LIMIT} bytes are read.")
            return None
        try:
            content = json.loads(self.rfile.read(int(length)), parse_constant=_no_constant)
        except (ValueError, RecursionError) as error:
            self._refuse(HTTPStatus.BAD_REQUEST, f"The request is not valid JSON: {error}")
            return None
        if not isinstance(content, dict):
            self._refuse(HTTPStatus.BAD_REQUEST, "The request must be a JSON object.")
            return None
        return content

    def _is_admitted(self) -> bool:
        """Check whether to continue; otherwise the request has been answered."""
        instead = self.server.access.refuse_or_redirect(self.command, self.path, self._headers)
        if instead is None:
            return True
        if instead.headers:
            self._send(instead.status, b"", "text/plain", instead.headers)
        else:
            self._refuse(instead.status, instead.reason)
        return False

    def _events(self) -> None:
        """Send server-sent events: the state now, and after every change."""
        if not self.server.pages.acquire(blocking=False):
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, f"{PAGES} pages are connected already.")
            return
        try:
            self.close_connection = True
            self.send_response(HTTPStatus.OK)
            self._send_common_headers("text/event-stream")
            self.send_header("Connection", "close")
            self.end_headers()
            seen = -1
            while True:
                version, text = self.server.watch.wait(seen, KEEP_ALIVE_S)
                news = f"id: {version}\ndata: {text}\n\n" if version != seen else ": still here\n\n"
                self.wfile.write(news.encode())
                self.wfile.flush()
                seen = version
        except OSError:
            pass
        finally:
            self.server.pages.release()

    @property
    def _headers(self) -> Mapping[str, str]:
        return self.headers  # type: ignore[return-value]  # an email.message.Message, read like a mapping

    @property
    def _url(self) -> urllib.parse.SplitResult:
        return urllib.parse.urlsplit("/" + self.path.lstrip("/"))

    @property
    def _parts(self) -> list[str]:
        """Return the decoded parts of the path; each is looked up by name, never joined to a path unchecked."""
        return [urllib.parse.unquote(part) for part in self._url.path.split("/") if part]

    def _json(self, status: HTTPStatus, content: Any) -> None:
        self._send(status, plain_json(content).encode(), "application/json")

    def _refuse(self, status: HTTPStatus, reason: str) -> None:
        self._json(status, {"error": reason})

    def _send(
        self, status: HTTPStatus, content: bytes, content_type: str, more: Mapping[str, str] | None = None
    ) -> None:
        self.send_response(status)
        self._send_common_headers(content_type)
        self.send_header("Content-Length", str(len(content)))
        for name, value in (more or {}).items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)

    def _send_common_headers(self, content_type: str) -> None:
        for name, value in (
            ("Content-Type", content_type),
            ("Cache-Control", "no-store"),
            ("Content-Security-Policy", CONTENT_POLICY),
            ("X-Content-Type-Options", "nosniff"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Frame-Options", "DENY"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
        ):
            self.send_header(name, value)

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing: a request line could contain the token."""


def _no_constant(name: str) -> Any:
    raise ValueError(f"{name} is not JSON")
