"""Removal of keys from every log and run folder."""

from __future__ import annotations

import os
import re
from urllib.parse import urlsplit, urlunsplit

_SECRET_NAME = re.compile(r"(KEY|TOKEN|SECRET|PASSWORD)$")
_SECRET_SHAPE = re.compile(r"\b(?:sk-[\w*-]{6,}|AIza[\w*-]{10,})|(?<=[Bb]earer )[\w.*+/=-]{6,}")


def scrub(text: str) -> str:
    """Remove everything from a text that is, or looks like, a key of this environment."""
    for name, value in os.environ.items():
        if len(value) >= 8 and _SECRET_NAME.search(name):
            text = text.replace(value, "***")
    return _SECRET_SHAPE.sub("***", text)


def public_url(url: str) -> str:
    """Return a URL without user name, password, query and fragment, for names and logs."""
    parts = urlsplit(url)
    host = parts.hostname or ""
    if ":" in host:
        host = f"[{host}]"
    return urlunsplit((parts.scheme, host + (f":{parts.port}" if parts.port else ""), parts.path, "", ""))
