"""The desk as an MCP server: an agent lists the questions, looks at their pictures, and answers."""

from __future__ import annotations

import asyncio
import json
import socket
import time
from collections.abc import Awaitable, Callable, MutableMapping
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

from coral.access import Access, choose_token
from coral.desk.inbox import Inbox, NoSuchQuestion, NotOpen, Unfit
from coral.desk.server import NAME_LIMIT, binding_error
from coral.errors import InputError

if TYPE_CHECKING:
    import uvicorn
    from mcp.server import MCPServer

PATH = "/mcp"
LONGEST_WAIT_S = 60.0
"""Clients give up on a call after a minute or more."""
_LOOK_S = 0.2
INSTRUCTIONS = (
    "You are the operator of a robot that asks when it needs a decision. Call list_questions, read a question with "
    "get_question, look at its pictures with get_picture, and send your answer with answer_question. An answer that "
    "does not fit its schema comes back with the reasons. A verifier checks accepted answers; if it refuses one, the "
    "question is asked again, with the reason. The robot goes on while you think."
)
Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]


class McpDesk:
    """The tools of one inbox, over standard input and output or over HTTP."""

    def __init__(self, inbox: Inbox) -> None:
        """Make the tools.

        Args:
            inbox: The inbox to serve.

        Raises:
            InputError: The package mcp is not installed.
        """
        try:
            from mcp.server import MCPServer
        except ImportError:
            raise InputError(
                "--mcp", "", "no package mcp", "the extra mcp: pip install 'coral-robotics[mcp]'"
            ) from None
        self.inbox = inbox
        self._http: uvicorn.Server | None = None
        self.answered = 0
        """Number of answers accepted by this server."""
        self.server: MCPServer[Any] = MCPServer("coral-desk", instructions=INSTRUCTIONS, log_level="ERROR")
        for tool in (self.list_questions, self.get_question, self.get_picture, self.answer_question):
            self.server.tool()(tool)

    async def list_questions(self, wait_s: float = 0.0) -> list[dict[str, Any]]:
        """List the questions that wait for an answer, the oldest first.

        Args:
            wait_s: Wait at most this long (s, up to 60) for the first one.
        """
        end = time.monotonic() + min(max(wait_s, 0.0), LONGEST_WAIT_S)
        while True:
            found = [
                {"id": entry.id, "kind": entry.kind, "asked_at": entry.asked_at, "refused_answers": entry.attempt}
                for entry in self.inbox.entries()
                if entry.state == "open"
            ]
            if found or time.monotonic() >= end:
                return found
            await asyncio.sleep(_LOOK_S)

    def get_question(self, question_id: str) -> dict[str, Any]:
        """Read a question: prompt, JSON schema of the answer, pictures, facts, reasons of refused answers."""
        try:
            question = self.inbox.question(question_id)
        except NoSuchQuestion:
            raise _tool_error(f"There is no question {question_id!r}.") from None
        names = ("id", "kind", "prompt", "answer_schema", "images", "captions", "facts", "rejections", "asked_at")
        return {name: question[name] for name in names if name in question}

    def get_picture(self, question_id: str, name: str) -> Any:
        """Look at a picture of a question; `images` of the question has the names."""
        from mcp.server.mcpserver import Image

        try:
            return Image(data=self.inbox.picture(question_id, name), format="png")
        except NoSuchQuestion:
            raise _tool_error(f"Question {question_id!r} has no picture {name!r}.") from None

    def answer_question(self, question_id: str, answer: dict[str, Any], operator: str = "an agent") -> str:
        """Answer a question with an object that fits its `answer_schema`. The first answer counts.

        Args:
            question_id: Id of the question.
            answer: The answer.
            operator: Your name, for the record.
        """
        try:
            self.inbox.answer(question_id, answer, " ".join(operator.split())[:NAME_LIMIT])
        except NoSuchQuestion:
            raise _tool_error(f"There is no question {question_id!r}.") from None
        except NotOpen as why:
            raise _tool_error(str(why)) from None
        except Unfit as why:
            raise _tool_error(f"The answer does not fit the question: {why}") from None
        except OSError as error:
            raise _tool_error(f"The inbox cannot be written: {error.strerror}.") from None
        self.answered += 1
        return "The answer is taken; the robot's verifier checks it."

    def serve_stdio(self) -> None:
        """Serve the program that started this one, until it closes standard input."""
        self.server.run("stdio")

    def serve_http(self, host: str, port: int, token: str, opened: Callable[[Access], None]) -> None:
        """Serve HTTP at `PATH` until interrupted, with the access rules of the desk's page.

        Args:
            host: Address to listen on; any but this machine's own needs a token, made if none is given.
            port: Port; 0 chooses a free one.
            token: Required in `Authorization: Bearer`.
            opened: Called once the port is open.

        Raises:
            InputError: The port is in use, the address is not one of this machine's, or the token is unsuitable.
        """
        import uvicorn
        from mcp.server.transport_security import TransportSecuritySettings

        token = choose_token(host, token)
        if not 0 <= port <= 65535:
            raise InputError("--port", "", port, "a port from 1 to 65535, or 0 for a free one")
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            listening = socket.create_server((host, port), family=family)
        except OSError as error:
            raise binding_error(error, host, port) from None
        with listening:
            access = Access(host, listening.getsockname()[1], token)
            # Ours checks Host and Origin, too, and knows this machine's names.
            open_to_all = TransportSecuritySettings(enable_dns_rebinding_protection=False)
            app = self.server.streamable_http_app(streamable_http_path=PATH, transport_security=open_to_all)
            config = uvicorn.Config(guarded(app, access), log_level="critical", lifespan="on")
            self._http = uvicorn.Server(config)
            opened(access)
            asyncio.run(self._http.serve(sockets=[listening]))

    def stop(self) -> None:
        """End `serve_http`; may be called from another thread."""
        if self._http is not None:
            self._http.should_exit = True


def guarded(app: App, access: Access) -> App:
    """Return an ASGI application that refuses what the desk's page would refuse."""

    async def answer(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            headers = {name.decode("latin-1").title(): value.decode("latin-1") for name, value in scope["headers"]}
            if scope["path"] != PATH:
                status, reason = HTTPStatus.NOT_FOUND, f"There is nothing here; the server is at {PATH}."
            else:
                refusal = access.refuse_or_redirect(scope["method"], scope["path"], headers)
                if refusal is None:
                    await app(scope, receive, send)
                    return
                status, reason = refusal.status, refusal.reason
            head = [(b"content-type", b"application/json"), (b"cache-control", b"no-store")]
            await send({"type": "http.response.start", "status": int(status), "headers": head})
            await send({"type": "http.response.body", "body": json.dumps({"error": reason}).encode()})
        elif scope["type"] == "lifespan":
            await app(scope, receive, send)

    return answer


def _tool_error(reason: str) -> Exception:
    from mcp.server.mcpserver.exceptions import ToolError

    return ToolError(reason)
