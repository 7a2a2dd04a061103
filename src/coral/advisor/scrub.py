"""Removal of keys from every log and run folder."""

from __future__ import annotations

import base64
import html
import json
import os
import re
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote, quote_plus, urlsplit, urlunsplit

from coral.errors import without_password

_SECRET_NAME = re.compile(r"(KEY|TOKEN|SECRET|PASSWORD)$")
_SECRET_SHAPE = re.compile(r"\b(?:sk-[\w*-]{6,}|AIza[\w*-]{10,})|(?:(?<=[Bb]earer )|(?<=[Bb]asic ))[\w.*+/=-]{6,}")
SHORTEST = 8
"""Characters of a key: shorter ones are words of other texts, too."""


def scrub(text: str) -> str:
    """Remove everything from a text that is, or looks like, a key of this environment, also in a usual encoding."""
    return _scrubbed(text, _secret_forms())


def scrub_values(value: Any) -> Any:
    """Scrub all text in JSON-like values, keys included."""
    return _walk(value, _secret_forms())


def _walk(value: Any, forms: list[str]) -> Any:
    if isinstance(value, str):
        return _scrubbed(value, forms)
    if isinstance(value, Mapping):
        return {_walk(key, forms): _walk(item, forms) for key, item in value.items()}
    return type(value)(_walk(item, forms) for item in value) if isinstance(value, list | tuple) else value


def _scrubbed(text: str, forms: list[str]) -> str:
    for form in forms:
        text = text.replace(form, "***")
    return without_password(_SECRET_SHAPE.sub("***", text))


def _secret_forms() -> list[str]:
    """Return the keys of this environment as servers, JSON, URLs and pages write them, the longest first."""
    keys = {value for name, value in os.environ.items() if len(value) >= SHORTEST and _SECRET_NAME.search(name)}
    forms = set(keys)
    for key in keys:
        raw = key.encode("utf-8", "surrogateescape")
        escaped = json.dumps(key)[1:-1]
        forms |= {escaped, escaped.replace("/", "\\/"), html.escape(key), raw.hex()}
        forms |= {quote(key, safe=""), quote(key), quote_plus(key)}
        forms |= {code(raw).decode().rstrip("=") for code in (base64.b64encode, base64.urlsafe_b64encode)}
    return sorted(forms, key=lambda form: (-len(form), form))


def public_url(url: str) -> str:
    """Return a URL without user name, password, query and fragment, for names and logs."""
    parts = urlsplit(url)
    host = parts.hostname or ""
    if ":" in host:
        host = f"[{host}]"
    return urlunsplit((parts.scheme, host + (f":{parts.port}" if parts.port else ""), parts.path, "", ""))
