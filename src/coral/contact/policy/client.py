"""Client of a policy server over a websocket: openpi's protocol, with its own deadlines and limits.

The server first sends its metadata, then one message for each observation. A text message instead of bytes reports an
error. Messages are not numbered, so a late answer could be taken for the next one's: a connection that missed its
deadline is dropped.
"""

from __future__ import annotations

import asyncio
import logging
import os
from collections.abc import Mapping
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidURI

from coral.contact.episode.policy_cfg import ClientCfg
from coral.contact.policy.wire import WireError, decode, encode

KEY_VARIABLE = "CORAL_POLICY_KEY"
"""Environment variable with the key, for servers that require one (sent as by openpi's client)."""
OUTAGES = ("unreachable", "silence", "closed")
"""Failures of the connection, not of the policy: worth another attempt."""


class PolicyError(RuntimeError):
    """The policy failed; `code` is the reason, as the reference lists them."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


class PolicyClient:
    """A connection to a policy server, renewed when it breaks."""

    def __init__(self, url: str, cfg: ClientCfg) -> None:
        self.url, self.cfg = url, cfg
        self.metadata: dict[str, Any] = {}
        self._runner = asyncio.Runner()
        self._line: ClientConnection | None = None
        logging.getLogger("websockets.client").setLevel(logging.CRITICAL)  # PolicyError reports what fails

    def connect(self) -> None:
        """Connect, unless connected; the server's metadata is then in `metadata`.

        Raises:
            PolicyError: The server does not answer, or not like a policy server.
        """
        self._runner.run(self._connect())

    def infer(self, observation: Mapping[str, Any]) -> Mapping[Any, Any]:
        """Request the actions for an observation.

        Raises:
            PolicyError: There is no usable answer.
        """
        try:
            question = encode(observation)
        except WireError as error:
            raise PolicyError("bad-message", f"the observation cannot be sent: {error}") from None
        return self._runner.run(self._ask(question))

    def close(self) -> None:
        """Close the connection."""
        if self._line is not None:
            self._runner.run(self._line.close())
            self._line = None
        self._runner.close()

    async def _ask(self, question: bytes) -> Mapping[Any, Any]:
        for attempt in range(1, self.cfg.attempts + 1):
            try:
                await self._connect()
                assert self._line is not None
                return await self._receive(self._line, self.cfg.answer_s, question)
            except PolicyError as error:
                self._drop()
                if error.code not in OUTAGES or attempt == self.cfg.attempts:
                    raise
                await asyncio.sleep(self.cfg.wait_s)
        raise AssertionError("attempts is at least 1")

    async def _connect(self) -> None:
        if self._line is not None:
            return
        key = os.environ.get(KEY_VARIABLE)
        try:
            async with asyncio.timeout(self.cfg.connect_s):
                # No pings: inference may keep a server busy for longer than their time-out; the deadlines cover this
                # case.
                self._line = await connect(
                    self.url,
                    compression=None,
                    max_size=self.cfg.most_bytes,
                    open_timeout=None,
                    ping_interval=None,
                    close_timeout=1.0,
                    proxy=None,
                    additional_headers={"Authorization": f"Api-Key {key}"} if key else None,
                )
        except TimeoutError:
            raise PolicyError("unreachable", f"{self.url} did not answer in {self.cfg.connect_s:g} s") from None
        except (OSError, InvalidHandshake, InvalidURI, EOFError) as error:
            raise PolicyError("unreachable", f"{self.url}: {_line(error)}") from None
        try:
            told = await self._receive(self._line, self.cfg.connect_s)
        except PolicyError:
            self._drop()
            raise
        self.metadata = {str(name): value for name, value in told.items()}

    async def _receive(
        self, line: ClientConnection, within_s: float, question: bytes | None = None
    ) -> Mapping[Any, Any]:
        """Receive the server's next message, after sending a request if there is one."""
        try:
            async with asyncio.timeout(within_s):
                if question is not None:
                    await line.send(question)
                message = await line.recv()
        except TimeoutError:
            raise PolicyError("silence", f"no answer from {self.url} in {within_s:g} s") from None
        except ConnectionClosed as error:
            if error.sent is not None and error.sent.code == 1009 and not error.rcvd_then_sent:
                raise PolicyError("too-large", f"a message of more than {self.cfg.most_bytes} bytes") from None
            raise PolicyError("closed", f"{self.url} closed the connection: {_line(error)}") from None
        if isinstance(message, str):
            raise PolicyError("error", f"the server says: {_last_line(message)}")
        try:
            answer = decode(message)
        except WireError as error:
            raise PolicyError("bad-message", str(error)) from None
        if not isinstance(answer, dict):
            raise PolicyError("bad-message", f"a {type(answer).__name__} where a map is expected")
        return answer

    def _drop(self) -> None:
        """Drop the connection without a closing handshake: the server may not answer."""
        if self._line is not None:
            self._line.transport.abort()
            self._line = None


def _line(error: BaseException) -> str:
    return printable(str(error) or type(error).__name__)


def _last_line(text: str) -> str:
    lines = [line for line in text.splitlines() if line.strip()]
    return printable(lines[-1]) if lines else "nothing"


def printable(text: str, most: int = 200) -> str:
    """Shorten a server's text to one line without control characters."""
    return " ".join("".join(c if c.isprintable() else " " for c in text[: 4 * most]).split())[:most]
