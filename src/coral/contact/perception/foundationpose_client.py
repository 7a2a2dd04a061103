"""HTTP client of a FoundationPose server, with deadlines; see `foundationpose_server`."""

from __future__ import annotations

import re
import time

import numpy as np

from coral.contact.perception.foundationpose_server import LIMIT_BYTES, Arrays, decode
from coral.contact.perception.tracker import TrackerFailed

URL = re.compile(r"http://(?:\[[\da-fA-F:.]+\]|[\w.-]+)(?::(?:[1-5]?\d{1,4}|6[0-4]\d{3}|65[0-5]\d{2}))?/?", re.ASCII)
"""Form of an address: a host, perhaps with a port."""
CONNECT_S = 5.0
"""Longest time to connect."""


class OutOfReach(TrackerFailed):
    """The server does not answer."""


def exchange(url: str, verb: str, question: bytes, timeout_s: float) -> Arrays:
    """Send one request to the server and return its answer.

    Args:
        url: Address of the server.
        verb: "init", "register", "track" or "close"; "" only asks whether there is a server, which has no answer.
        question: The request's arrays, as npz.
        timeout_s: Time for the answer, to its last byte.

    Raises:
        OutOfReach: The server does not answer in time.
        TrackerFailed: The server refuses, or its answer cannot be read.
    """
    import httpx2 as httpx

    body, end = b"", time.monotonic() + timeout_s
    address, timeout = f"{url.rstrip('/')}/{verb}", httpx.Timeout(timeout_s, connect=CONNECT_S)
    try:
        with httpx.stream("POST", address, content=question, timeout=timeout, trust_env=False) as reply:
            for part in reply.iter_raw():
                body += part
                if len(body) > LIMIT_BYTES:
                    raise ValueError("an answer of more than 256 MiB")
                if time.monotonic() > end:  # the library's own limit begins anew with every byte
                    raise httpx.ReadTimeout("too slow")
        if not verb:
            return {}
        if reply.status_code != 200:
            text = " ".join(body[:300].decode("utf-8", "replace").split())
            raise TrackerFailed(f"foundationpose at {url} refuses to {verb}: {text}")
        return {name: np.asarray(array) for name, array in decode(body).items()}
    except httpx.TimeoutException:
        raise OutOfReach(f"foundationpose at {url}: no answer to {verb or 'a request'} in {timeout_s:g} s") from None
    except httpx.HTTPError as error:
        text = " ".join(str(error).split()) or type(error).__name__
        raise OutOfReach(f"foundationpose at {url} does not answer: {text}") from None
    except ValueError as error:
        raise TrackerFailed(f"foundationpose at {url}: {error}") from None
