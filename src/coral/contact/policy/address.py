"""`[NAME=]ws://HOST:PORT` on the command line: the server of a policy, and its name in tables."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from urllib.parse import urlsplit

from coral.errors import InputError

_NAME = re.compile(r"[a-z0-9][a-z0-9.-]{0,40}")
_EXPECTED = "ws://HOST:PORT or NAME=ws://HOST:PORT"


@dataclass(frozen=True)
class Address:
    """Name and URL of a served policy."""

    name: str
    """Name for records; `openvla-oft` and `pi05` are compared with the paper's rows of Table 1."""
    url: str
    """URL of its server."""


def parse_address(text: str, taken: Collection[str] = (), where: str = "--policy") -> Address:
    """Parse an address.

    Raises:
        InputError: It is not an address.
    """
    name, separator, url = text.partition("=")
    if not separator:
        name, url = "policy", text
    if not _NAME.fullmatch(name):
        raise InputError(where, "", repr(name), "a name of small letters, digits, dots and hyphens")
    if name in taken:
        raise InputError(where, "", repr(name), "a name that no variant has")
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname, parts.port
    except ValueError:
        raise InputError(where, "", repr(url), _EXPECTED) from None
    if parts.scheme not in ("ws", "wss") or not host or parts.fragment or any(c.isspace() for c in url):
        raise InputError(where, "", repr(url), _EXPECTED)
    if parts.username is not None or parts.password is not None:
        raise InputError(where, "", "a password in the address", f"{_EXPECTED}; a key goes into the environment")
    return Address(name, url)
