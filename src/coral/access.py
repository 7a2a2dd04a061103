"""Who may talk to a port that we open: its token, the names it answers to, and the pages that may ask it."""

from __future__ import annotations

import hmac
import ipaddress
import re
import secrets
import socket
import urllib.parse
from collections.abc import Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie

from coral.errors import InputError

TOKEN = re.compile(r"[A-Za-z0-9_-]{12,200}")


@dataclass(frozen=True)
class Instead:
    """What a request gets instead of what it asked for."""

    status: HTTPStatus
    reason: str = ""
    headers: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Access:
    """The rules of one server. Every request goes through `instead` first."""

    host: str
    """Address it is bound to."""
    port: int
    token: str
    """"" when none is needed."""

    @property
    def cookie(self) -> str:
        """Name of the cookie; browsers share cookies between the ports of a machine."""
        return f"coral_{self.port}"

    @property
    def url(self) -> str:
        """Where to point a browser, token included."""
        everywhere = self.host in ("0.0.0.0", "::", "")
        host = socket.gethostname() if everywhere else f"[{self.host}]" if ":" in self.host else self.host
        token = f"?token={self.token}" if self.token else ""
        return f"http://{host}:{self.port}/{token}"

    def instead(self, method: str, target: str, headers: Mapping[str, str]) -> Instead | None:
        """A refusal or a redirection; None when the request may go on.

        The address that was printed holds the token. Opening it sets a cookie and leads to the page itself, so that
        the token leaves the address bar and is not shared with a screenshot.

        Args:
            method: Of the HTTP request; a WebSocket is opened by GET.
            target: Path and query as requested.
            headers: Of the request, looked up as "Host", "Origin", "Cookie", "Authorization".
        """
        if not self.names_us(headers.get("Host")):
            return Instead(HTTPStatus.MISDIRECTED_REQUEST, "This server does not answer to this name.")
        if not self.same_origin(headers):
            return Instead(HTTPStatus.FORBIDDEN, "Pages of other sites are not served.")
        url = urllib.parse.urlsplit("/" + target.lstrip("/"))
        given = urllib.parse.parse_qs(url.query).get("token", [""])[0]
        if self.token and method == "GET" and url.path == "/" and given:
            if not self.is_token(given):
                return Instead(HTTPStatus.FORBIDDEN, "This token is not the one that was printed.")
            cookie = f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Strict"
            return Instead(HTTPStatus.SEE_OTHER, headers={"Location": "/", "Set-Cookie": cookie})
        if not self.has_token(headers):
            return Instead(
                HTTPStatus.UNAUTHORIZED,
                "Open the page with the address that was printed when it started: it ends in ?token=...",
            )
        return None

    def names_us(self, host_header: str | None) -> bool:
        """Whether the Host header means this server.

        A page from elsewhere whose name was made to point here (DNS rebinding) still carries that name. An address
        cannot be made to point anywhere else.
        """
        name = _host_name(host_header or "", self.port)
        if name is None:
            return False
        if is_loopback(self.host):
            return name == "localhost" or is_loopback(name)
        if _address(name) is not None:
            return True
        own = socket.gethostname().lower()
        return name in {"localhost", self.host.lower(), own, own.partition(".")[0], f"{own.partition('.')[0]}.local"}

    def has_token(self, headers: Mapping[str, str]) -> bool:
        """Whether a request's cookie or `Authorization: Bearer` header holds the token."""
        if not self.token:
            return True
        scheme, _, given = headers.get("Authorization", "").partition(" ")
        if scheme.lower() == "bearer" and self.is_token(given.strip()):
            return True
        try:
            cookie = SimpleCookie(headers.get("Cookie", "")).get(self.cookie)
        except CookieError:
            return False
        return cookie is not None and self.is_token(cookie.value)

    def is_token(self, given: str) -> bool:
        """Compare in a time that tells nothing."""
        return hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode())

    def same_origin(self, headers: Mapping[str, str]) -> bool:
        """Whether a request comes from our own page or from a program, and not from a page elsewhere.

        Browsers add a page's origin to every WebSocket that it opens and to whatever it sends; no page can forge it.
        """
        origin = headers.get("Origin")
        return origin is None or origin == f"http://{headers.get('Host', '')}"


def choose_token(host: str, token: str) -> str:
    """The token to ask for: the given one, none on this machine alone, else a new one.

    Raises:
        InputError: The given one is too short or does not fit into an address.
    """
    if token:
        if not TOKEN.fullmatch(token):
            raise InputError(
                "--token",
                "",
                f"a token of {len(token)} characters",
                "12 or more letters, digits, - or _, or no token to have one made",
            )
        return token
    return "" if is_loopback(host) else new_token()


def new_token() -> str:
    """A token that nobody can guess."""
    return secrets.token_urlsafe(24)


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address."""
    address = _address(host)
    return host == "localhost" if address is None else address.is_loopback


def _address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None


def _host_name(header: str, port: int) -> str | None:
    """Name or address in a Host header for this port; None when it is for another one, or malformed."""
    match = re.fullmatch(r"(?:\[([0-9A-Fa-f:.]+)\]|([A-Za-z0-9.-]+))(?::(\d{1,5}))?", header)
    if match is None or int(match[3] or 80) != port:
        return None
    return (match[1] or match[2]).lower()
