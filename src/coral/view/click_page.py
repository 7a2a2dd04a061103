"""A page on which a person clicks each object once in a picture; one local port, open until the answer has come."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import queue
import re
import socketserver
from collections.abc import Mapping, Sequence
from html import escape
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from coral.access import Access, choose_token

PAGE = (Path(__file__).parent / "click_page.html").read_text(encoding="utf-8")
BODY_LIMIT = 16 * 1024
"""Maximum size of an answer, bytes."""
HEADER = "X-Coral-Click"
"""A page of another site cannot send it: it would need a permission that is never given."""

Clicks = dict[str, tuple[int, int]]


class ClickPage(ThreadingHTTPServer):
    """Shows one picture and takes one answer.

    Args:
        names: What to click, in this order.
        png: The picture.
        size: Its width and height.
        port: Port on this machine's own address; 0 chooses a free one.

    Raises:
        OSError: The port cannot be used.
    """

    daemon_threads = True

    def __init__(self, names: Sequence[str], png: bytes, size: tuple[int, int], port: int = 0) -> None:
        super().__init__(("127.0.0.1", port), _Handler)
        self.access = Access("127.0.0.1", self.server_address[1], choose_token("127.0.0.1", ""))
        self.names, self.png, self.size = tuple(names), png, size
        self.page = PAGE.replace("{{names}}", escape(json.dumps(self.names), quote=True))
        self.answers: queue.Queue[Clicks] = queue.Queue()

    @property
    def url(self) -> str:
        """Return the address for a browser."""
        return self.access.url

    def server_bind(self) -> None:
        """Bind without resolving this machine's name, which may take seconds."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = str(self.server_address[0]), int(self.server_address[1])

    def parse(self, content: Any) -> Clicks | str:
        """Return the clicks of an answer, or why it is none."""
        if not isinstance(content, dict) or set(content) != set(self.names):
            return f"Expected one pixel for each of {', '.join(self.names)}."
        clicks = {}
        for name in self.names:
            pixel = content[name]
            if not isinstance(pixel, list) or len(pixel) != 2 or not all(_is_number(one) for one in pixel):
                return f"{name}: expected [column, row]."
            column, row = (math.floor(one) for one in pixel)
            if not (0 <= column < self.size[0] and 0 <= row < self.size[1]):
                return f"{name}: expected a pixel of {self.size[0]} x {self.size[1]}."
            clicks[name] = (column, row)
        return clicks


class _Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: ClickPage
    server_version, sys_version = "coral-click", ""
    timeout = 20.0

    def do_GET(self) -> None:
        """Serve the page or the picture."""
        if not self._is_admitted():
            return
        if self.path == "/":
            self._send(HTTPStatus.OK, self.server.page.encode(), "text/html; charset=utf-8")
        elif self.path == "/picture.png":
            self._send(HTTPStatus.OK, self.server.png, "image/png")
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "There is nothing here.")

    def do_POST(self) -> None:
        """Take the answer."""
        if not self._is_admitted():
            return
        length = self.headers.get("Content-Length", "")
        if self.headers.get(HEADER) != "1" or self.path != "/clicks":
            self._refuse(HTTPStatus.FORBIDDEN, "Clicks are taken from this program's own page.")
        elif not re.fullmatch(r"\d{1,6}", length) or int(length) > BODY_LIMIT:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"At most {BODY_LIMIT} bytes are read.")
        else:
            try:
                found = self.server.parse(json.loads(self.rfile.read(int(length))))
            except (ValueError, RecursionError):
                found = "Expected JSON."
            if isinstance(found, str):
                self._refuse(HTTPStatus.UNPROCESSABLE_ENTITY, found)
            else:
                self._send(HTTPStatus.OK, b'{"ok": true}', "application/json")
                self.server.answers.put(found)

    def _is_admitted(self) -> bool:
        headers: Mapping[str, str] = self.headers  # type: ignore[assignment]  # a message, read like a mapping
        instead = self.server.access.refuse_or_redirect(self.command, self.path, headers)
        if instead is not None:
            self._refuse(instead.status, instead.reason)
        return instead is None

    def _refuse(self, status: HTTPStatus, reason: str) -> None:
        self._send(status, json.dumps({"error": reason}).encode(), "application/json")

    def _send(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", CONTENT_POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("X-Frame-Options", "DENY")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing."""


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _digest(tag: str) -> str:
    match = re.search(rf"<{tag}>(.*?)</{tag}>", PAGE, re.DOTALL)
    assert match is not None
    return base64.b64encode(hashlib.sha256(match[1].encode()).digest()).decode()


CONTENT_POLICY = (
    f"default-src 'none'; script-src 'sha256-{_digest('script')}'; style-src 'sha256-{_digest('style')}'; "
    "img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
