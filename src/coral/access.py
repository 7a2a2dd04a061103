"""Access control of a port: its token, the host names that it answers to, and the origins that may send requests."""

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
class AccessResponse:
    """Response to a request that is refused or redirected."""

    status: HTTPStatus
    reason: str = ""
    headers: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Access:
    """Access rules of one server. Every request goes through `refuse_or_redirect` first."""

    host: str
    """Address that the server is bound to."""
    port: int
    token: str
    """"" if none is needed."""

    @property
    def cookie(self) -> str:
        """Return the name of the cookie; browsers share cookies between the ports of a machine."""
        return f"coral_{self.port}"

    @property
    def url(self) -> str:
        """Return the URL for a browser, token included."""
        everywhere = self.host in ("0.0.0.0", "::", "")
        host = socket.gethostname() if everywhere else f"[{self.host}]" if ":" in self.host else self.host
        token = f"?token={self.token}" if self.token else ""
        return f"http://{host}:{self.port}/{token}"

    def refuse_or_redirect(self, method: str, target: str, headers: Mapping[str, str]) -> AccessResponse | None:
        """Return a refusal or a redirection; None if the request may continue.

        The printed address contains the token. Opening it sets a cookie and redirects to the page itself, so that the
        token disappears from the address bar and from screenshots. The target is path and query as requested; headers
        are looked up as "Host", "Origin", "Cookie", "Authorization".
        """
        if not self.is_own_host(headers.get("Host")):
            return AccessResponse(HTTPStatus.MISDIRECTED_REQUEST, "This server does not answer to this name.")
        if not self.is_same_origin(headers):
            return AccessResponse(HTTPStatus.FORBIDDEN, "Pages of other sites are not served.")
        url = urllib.parse.urlsplit("/" + target.lstrip("/"))
        given = urllib.parse.parse_qs(url.query).get("token", [""])[0]
        if self.token and method == "GET" and url.path == "/" and given:
            if not self.is_token(given):
                return AccessResponse(HTTPStatus.FORBIDDEN, "This token is not the one that was printed.")
            cookie = f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Strict"
            return AccessResponse(HTTPStatus.SEE_OTHER, headers={"Location": "/", "Set-Cookie": cookie})
        if not self.has_token(headers):
            return AccessResponse(
                HTTPStatus.UNAUTHORIZED,
                "Open the page with the address that was printed when it started: it ends in ?token=...",
            )
        return None

    def is_own_host(self, host_header: str | None) -> bool:
        """Check whether the Host header names this server.

        A foreign page whose name was made to resolve to this machine (DNS rebinding) still sends that name. An IP
        address cannot be redirected.
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
        """Check whether a request's cookie or `Authorization: Bearer` header contains the token."""
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
        """Compare in constant time."""
        return hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode())

    def is_same_origin(self, headers: Mapping[str, str]) -> bool:
        """Check whether a request comes from our own page or from a program, not from a page of another site.

        Browsers add a page's origin to every WebSocket and to every request that sends data; no page can forge it.
        """
        origin = headers.get("Origin")
        return origin is None or origin == f"http://{headers.get('Host', '')}"


def choose_token(token: str = "") -> str:
    """Choose the token: the given one, else a new one that nobody can guess.

    Raises:
        InputError: The given token is too short or does not fit into an address.
    """
    if token and not TOKEN.fullmatch(token):
        expected = "12 or more letters, digits, - or _, or no token to have one made"
        raise InputError("token", "", f"a token of {len(token)} characters", expected)
    return token or secrets.token_urlsafe(24)


def is_loopback(host: str) -> bool:
    """Check whether only this machine can reach an address."""
    address = _address(host)
    return host == "localhost" if address is None else address.is_loopback


def _address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(host)
    except ValueError:
        return None


def _host_name(header: str, port: int) -> str | None:
    """Return the name or address in a Host header for this port; None if it is for another port, or malformed."""
    match = re.fullmatch(r"(?:\[([0-9A-Fa-f:.]+)\]|([A-Za-z0-9.-]+))(?::(\d{1,5}))?", header)
    if match is None or int(match[3] or 80) != port:
        return None
    return (match[1] or match[2]).lower()
