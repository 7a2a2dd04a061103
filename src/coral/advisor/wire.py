"""HTTP connections to models, with a limit on the size of a reply."""

from __future__ import annotations

from collections.abc import AsyncIterator

import httpx2

from coral.advisor.model_cfg import CONNECT_S


class ReplyTooLarge(httpx2.TransportError):
    """A reply was truncated because it was too long."""


class _Capped(httpx2.AsyncByteStream):
    def __init__(self, stream: httpx2.AsyncByteStream, limit: int) -> None:
        self._stream, self._limit = stream, limit

    async def __aiter__(self) -> AsyncIterator[bytes]:
        left = self._limit
        async for chunk in self._stream:
            left -= len(chunk)
            if left < 0:
                raise ReplyTooLarge(f"reply of more than {self._limit} bytes")
            yield chunk

    async def aclose(self) -> None:
        await self._stream.aclose()


def http_client(max_reply_bytes: int, timeout_s: float) -> httpx2.AsyncClient:
    """Make an HTTP client that closes the connection on a reply longer than `max_reply_bytes`.

    A body that is compressed although this was not requested gets a twentieth of it, so that it cannot unpack to much
    more. `timeout_s` is the longest wait between two pieces of a reply (s); for a connection, `CONNECT_S` if less.
    """

    async def cap(response: httpx2.Response) -> None:
        packed = response.headers.get("content-encoding", "identity").lower() != "identity"
        if isinstance(response.stream, httpx2.AsyncByteStream):
            response.stream = _Capped(response.stream, max_reply_bytes // 20 if packed else max_reply_bytes)

    return httpx2.AsyncClient(
        event_hooks={"response": [cap]},
        headers={"Accept-Encoding": "identity"},
        timeout=httpx2.Timeout(timeout_s, connect=min(CONNECT_S, timeout_s)),
    )


def caused_by(error: BaseException, kind: type[BaseException]) -> bool:
    """Check whether a client library's error was caused by one of this kind."""
    cause: BaseException | None = error
    for _ in range(10):
        if cause is None:
            return False
        if isinstance(cause, kind):
            return True
        cause = cause.__cause__ or cause.__context__
    return False
