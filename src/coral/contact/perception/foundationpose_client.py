"""HTTP client of a FoundationPose server, with deadlines; see `foundationpose_server`."""

from __future__ import annotations

import contextlib
import http.client
import socket
import threading
from collections.abc import Iterator
from urllib.parse import urlsplit

import numpy as np

from coral.contact.perception.foundationpose_server import LIMIT_BYTES, Arrays, decode
from coral.contact.perception.tracker import TrackerFailed
from coral.errors import InputError


class OutOfReach(TrackerFailed):
    """The server does not answer."""


def reach(url: str, connect_s: float) -> None:
    """Check that a server accepts connections, without a request.

    Raises:
        InputError: The address is not that of an HTTP server.
        OutOfReach: No server accepts the connection.
    """
    address = parse_url(url)
    try:
        socket.create_connection(address, timeout=connect_s).close()
    except OSError as error:
        raise OutOfReach(_silence_text(url, error)) from None


def parse_url(url: str, where: str = "foundationpose", field: str = "url") -> tuple[str, int]:
    """Read host and port of an address.

    Raises:
        InputError: The address is not that of an HTTP server; `where` and `field` name its source.
    """
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError:
        parts, port = urlsplit(""), None
    if (
        parts.scheme != "http"
        or not parts.hostname
        or parts.path.strip("/")
        or parts.query
        or parts.fragment
        or parts.username is not None
        or any(c.isspace() for c in url)
    ):
        raise InputError(where, field, repr(url), "an address such as http://127.0.0.1:5070")
    return parts.hostname, port or 80


def exchange(url: str, verb: str, question: bytes, connect_s: float, timeout_s: float) -> Arrays:
    """Send one request to the server and return its answer.

    Args:
        url: Address of the server.
        verb: "init", "register", "track" or "close".
        question: The request's arrays, as npz.
        connect_s: Time to connect.
        timeout_s: Time for the answer, from its first byte to its last.

    Raises:
        OutOfReach: The server does not answer in time.
        TrackerFailed: The server refuses, or its answer cannot be read.
    """
    connection = http.client.HTTPConnection(*parse_url(url), timeout=connect_s)
    late = threading.Event()
    try:
        connection.connect()
        line: socket.socket = connection.sock
        line.settimeout(timeout_s)
        with _hang_up_after(line, timeout_s, late):
            connection.request("POST", f"/{verb}", question)
            reply = connection.getresponse()
            body = reply.read(LIMIT_BYTES + 1)
        if late.is_set():
            raise TimeoutError
        if reply.status != 200:
            text = " ".join(body[:300].decode("utf-8", "replace").split())
            raise TrackerFailed(f"foundationpose at {url} refuses to {verb}: {text}")
        if len(body) > LIMIT_BYTES:
            raise ValueError("an answer of more than 256 MiB")
        return {name: np.asarray(array) for name, array in decode(body).items()}
    except (OSError, http.client.HTTPException) as error:
        if late.is_set() or (isinstance(error, TimeoutError) and connection.sock is not None):
            raise OutOfReach(f"foundationpose at {url}: no answer to {verb} in {timeout_s:g} s") from None
        raise OutOfReach(_silence_text(url, error)) from None
    except ValueError as error:
        raise TrackerFailed(f"foundationpose at {url}: {error}") from None
    finally:
        connection.close()


@contextlib.contextmanager
def _hang_up_after(line: socket.socket, seconds: float, late: threading.Event) -> Iterator[None]:
    """Close the connection after a while: the socket's own timeout restarts with every byte."""

    def hang_up() -> None:
        late.set()
        with contextlib.suppress(OSError):
            line.shutdown(socket.SHUT_RDWR)

    clock = threading.Timer(seconds, hang_up)
    clock.daemon = True
    clock.start()
    try:
        yield
    finally:
        clock.cancel()


def _silence_text(url: str, error: Exception) -> str:
    return f"foundationpose at {url} does not answer: {' '.join(str(error).split()) or type(error).__name__}"
