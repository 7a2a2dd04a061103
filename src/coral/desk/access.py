"""Who may talk to the desk: the token, the names it answers to, and requests that other pages cannot forge."""

from __future__ import annotations

import hmac
import ipaddress
import re
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie

from coral.errors import InputError

TOKEN = re.compile(r"[A-Za-z0-9_-]{12,200}")


@dataclass(frozen=True)
class Access:
    """The rules of one server."""

    host: str
    """Address it is bound to."""
    port: int
    token: str
    """"" when none is needed."""

    @property
    def cookie(self) -> str:
        """Name of the cookie; browsers share cookies between the ports of a machine."""
        return f"coral_desk_{self.port}"

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

    def from_our_page(self, headers: Mapping[str, str]) -> bool:
        """Whether a request that changes something comes from our page or from a program.

        Other sites cannot set a header of their own without asking first, and we never agree.
        """
        origin = headers.get("Origin")
        ours = origin is None or origin == f"http://{headers.get('Host', '')}"
        return ours and headers.get("X-Coral-Desk") == "1"


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
    return "" if is_loopback(host) else secrets.token_urlsafe(24)


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
