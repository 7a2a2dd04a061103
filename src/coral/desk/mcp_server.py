"""The desk as an MCP server: an agent lists the questions, looks at their pictures, and answers."""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING, Any

from coral.desk.inbox import Inbox, NoSuchQuestion, NotOpen, Unfit
from coral.desk.notice import NAME_LIMIT
from coral.errors import InputError, install_extra
from coral.web import WebServer

if TYPE_CHECKING:
    from mcp.server import MCPServer

PATH = "/mcp"
LONGEST_WAIT_S = 60.0
"""Clients give up on a call after a minute or more."""
_LOOK_S = 0.2
TOOLS = ("list_questions", "get_question", "get_picture", "answer_question", "list_missions", "change_instruction")
"""Methods of `McpDesk` that an agent may call."""
INSTRUCTIONS = (
    "You are the operator of a robot that asks when it needs a decision. Call list_questions, read a question with "
    "get_question, look at its pictures with get_picture, and send your answer with answer_question. An answer that "
    "does not fit its schema comes back with the reasons. A verifier checks accepted answers; if it refuses one, the "
    "question is asked again, with the reason. The robot keeps moving while you think. A mission in words has an "
    "instruction: list_missions shows it, change_instruction changes it. Only the person you work for decides on that."
)


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
            raise InputError("--mcp", "", "no package mcp", install_extra("mcp")) from None
        self.inbox = inbox
        self.answered = 0
        """Number of answers accepted by this server."""
        self.server: MCPServer[Any] = MCPServer("coral-desk", instructions=INSTRUCTIONS, log_level="ERROR")
        for tool in TOOLS:
            self.server.tool()(getattr(self, tool))

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

    def list_missions(self) -> list[dict[str, Any]]:
        """List the missions that ask here: id, state, what the robot is doing, and the instruction of one in words."""
        keys = ("id", "state", "world", "doing", "instruction", "outcome")
        return [{key: mission[key] for key in keys} for mission in self.inbox.missions()]

    def change_instruction(self, mission_id: str, instruction: str, operator: str = "an agent") -> str:
        """Change the instruction of a mission in words that is under way; open questions are asked anew.

        Args:
            mission_id: Id of the mission.
            instruction: What the robot is to do, in plain words.
            operator: Your name, for the record.
        """
        try:
            self.inbox.instruct(mission_id, instruction, " ".join(operator.split())[:NAME_LIMIT])
        except NoSuchQuestion:
            raise _tool_error(f"There is no mission {mission_id!r}.") from None
        except (NotOpen, ValueError) as why:
            raise _tool_error(str(why)) from None
        except OSError as error:
            raise _tool_error(f"The inbox cannot be written: {error.strerror}.") from None
        return "The mission takes the new words with its next step; its next question carries them."

    def serve_stdio(self) -> None:
        """Serve the program that started this one, until it closes standard input."""
        self.server.run("stdio")

    def serve_http(self, host: str, port: int, token: str) -> WebServer:
        """Return a server of HTTP at `PATH`, with the access rules of the desk's page.

        Args:
            host: Address to listen on.
            port: Port; 0 chooses a free one.
            token: Required in `Authorization: Bearer`; made if none is given.

        Raises:
            InputError: The port is in use, the address is not one of this machine's, or the token is unsuitable.
        """
        from mcp.server.transport_security import TransportSecuritySettings

        # Ours checks Host and Origin, too, and knows this machine's names.
        open_to_all = TransportSecuritySettings(enable_dns_rebinding_protection=False)
        app = self.server.streamable_http_app(streamable_http_path=PATH, transport_security=open_to_all)
        return WebServer(app, host=host, port=port, token=token)


def _tool_error(reason: str) -> Exception:
    from mcp.server.mcpserver.exceptions import ToolError

    return ToolError(reason)
