"""Diagnosis of a client library's exception: whose fault it is, its name, and whether to try again."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from urllib.parse import urlsplit

import httpx2
from pydantic_ai import exceptions as wrong

from coral.advisor.model_cfg import CONNECT_S, NOBODY
from coral.advisor.question import AdvisorUnavailable, BadAnswer
from coral.advisor.scrub import scrub
from coral.advisor.wire import ReplyTooLarge, caused_by

RETRIED = (408, 409, 425, 429)
"""HTTP statuses below 500 after which the same request may succeed."""

CLIENT_ERRORS = (wrong.AgentRunError, wrong.UserError, ValueError, KeyError, TypeError, AttributeError, OSError)
"""Exceptions of a client library. A reply may make it fail, and that must not end the mission."""


@dataclass(frozen=True)
class Failure:
    """A request without an answer."""

    error: BadAnswer | AdvisorUnavailable
    retry: bool = False
    wait_s: float | None = None
    """Wait requested by the server (s)."""
    patience_s: float = math.inf
    """Time from the first request after which it is not tried again (s)."""

    @property
    def code(self) -> str:
        """Return the name of the failure in the attempt log."""
        return self.error.rejection.code if isinstance(self.error, BadAnswer) else self.error.code


def diagnose(error: BaseException, who: str, limit_bytes: int) -> Failure:
    """Name the failure behind an exception of `CLIENT_ERRORS`."""
    who += _address_hint(who)
    said = scrub(str(error))[:300]
    if caused_by(error, ReplyTooLarge):
        return Failure(BadAnswer("too-large", f"The reply was longer than {limit_bytes} bytes; keep it short."))
    if caused_by(error, json.JSONDecodeError) or isinstance(error, wrong.UnexpectedModelBehavior):
        return Failure(BadAnswer("bad-reply", f"The reply of {who} is not of its API: {said}"))
    if isinstance(error, wrong.ModelHTTPError):
        return _http(error, who)
    if isinstance(error, wrong.ModelAPIError):
        dead = caused_by(error, httpx2.ConnectError) or caused_by(error, httpx2.ConnectTimeout)
        reason = f"{who} cannot be reached: {NOBODY if dead else said}"
        return Failure(AdvisorUnavailable("connection", reason), retry=True, patience_s=CONNECT_S if dead else math.inf)
    return Failure(
        AdvisorUnavailable("client-error", f"{type(error).__name__}: {said}", final=isinstance(error, wrong.UserError))
    )


def _address_hint(who: str) -> str:
    """Return what to change in a local server's address that does not look like one of the API."""
    url = urlsplit(who.removeprefix("local:"))
    if not who.startswith("local:") or url.path.endswith("/v1"):
        return ""
    path = url.path.rstrip("/").removesuffix("/chat/completions").removesuffix("/v1") + "/v1"
    return f" (most servers want local:{url.scheme}://{url.netloc}{path}#{url.fragment})"


def _http(error: wrong.ModelHTTPError, who: str) -> Failure:
    status, said = error.status_code, scrub(str(error.body))[:300]
    if status in (401, 403):
        return Failure(AdvisorUnavailable("key-refused", f"{who} refused the key: {said}", final=True))
    if status == 404:
        return Failure(AdvisorUnavailable("no-such-model", f"{who} was not found: {said}", final=True))
    code = f"http-{status}"
    if status >= 500 or status in RETRIED:
        return Failure(
            AdvisorUnavailable(code, f"{who} answered {status}: {said}"), retry=True, wait_s=error.retry_after
        )
    return Failure(
        AdvisorUnavailable(
            code,
            f"{who} refused the request: {said} (`coral advisor probe` tells which output modes and pictures it takes)",
            final=True,
        )
    )
