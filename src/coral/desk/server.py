"""The desk on the web: one page, its questions and their pictures, and no other files."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from http import HTTPStatus
from pathlib import Path
from typing import Any

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute, Route

from coral.advisor.log import plain_json
from coral.desk.inbox import Inbox, NoSuchQuestion, NotOpen, Unfit
from coral.desk.notice import NAME_LIMIT
from coral.foreign_file import read_text
from coral.web import WebServer, read_json

RECENT, MISSIONS = 300, 8
"""Number of questions and missions that a page lists, the latest."""
PAGE = read_text(Path(__file__).parent / "page.html", "a file of this package")


class DeskServer(WebServer):
    """Serves one inbox."""

    def __init__(self, inbox: Inbox, host: str = "127.0.0.1", port: int = 8765, token: str = "") -> None:
        """Bind to an address; arguments and errors as for `WebServer`."""
        self.inbox = inbox
        self.answered = 0
        """Number of answers accepted by this server."""
        super().__init__(self._routes(), page=PAGE, host=host, port=port, token=token)

    def _routes(self) -> Sequence[BaseRoute]:
        return [
            Route("/api/state", self._state),
            Route("/api/questions/{question}", self._question),
            Route("/api/questions/{question}/answer", self._answer, methods=["POST"]),
            Route("/api/missions/{mission}/instruction", self._instruct, methods=["POST"]),
            Route("/pictures/{question}/{name}", self._picture),
        ]

    def _state(self, request: Request) -> Response:
        """Send the inbox, or nothing to a page that has just this version of it."""
        text = state_json(self.inbox).encode()
        version = f'"{hashlib.sha256(text).hexdigest()[:24]}"'
        if request.headers.get("If-None-Match") == version:
            return Response(status_code=HTTPStatus.NOT_MODIFIED, headers={"ETag": version})
        return Response(text, media_type="application/json", headers={"ETag": version})

    def _question(self, request: Request) -> Response:
        with _refusing("question"):
            content = self.inbox.question(request.path_params["question"])
        return _json({**content, "now": round(time.time(), 3)})

    def _picture(self, request: Request) -> Response:
        with _refusing("picture"):
            png = self.inbox.picture(request.path_params["question"], request.path_params["name"])
        return Response(png, media_type="image/png")

    async def _answer(self, request: Request) -> Response:
        content = await read_json(request)
        operator = content.get("operator", "")
        if "answer" not in content or not isinstance(operator, str):
            raise HTTPException(HTTPStatus.BAD_REQUEST, 'The request must be {"answer": ..., "operator": "name"}.')
        try:
            with _refusing("question"):
                self.inbox.answer(request.path_params["question"], content["answer"], _name(operator))
        except Unfit as why:
            faults = [{"path": fault.path, "place": fault.place, "reason": fault.reason} for fault in why.faults]
            reason = "The answer does not fit the question."
            return _json({"error": reason, "faults": faults}, HTTPStatus.UNPROCESSABLE_ENTITY)
        self.answered += 1
        return _json({"ok": True})

    async def _instruct(self, request: Request) -> Response:
        content = await read_json(request)
        words, operator = content.get("instruction"), content.get("operator", "")
        if not isinstance(words, str) or not isinstance(operator, str):
            raise HTTPException(
                HTTPStatus.BAD_REQUEST, 'The request must be {"instruction": "words", "operator": "name"}.'
            )
        try:
            with _refusing("mission"):
                self.inbox.instruct(request.path_params["mission"], words, _name(operator))
        except ValueError as why:
            raise HTTPException(HTTPStatus.UNPROCESSABLE_ENTITY, str(why)) from None
        return _json({"ok": True})


@contextmanager
def _refusing(what: str) -> Iterator[None]:
    """Answer the page with the reason why the inbox refuses."""
    try:
        yield
    except NoSuchQuestion:
        raise HTTPException(HTTPStatus.NOT_FOUND, f"There is no such {what}.") from None
    except NotOpen as why:
        raise HTTPException(HTTPStatus.CONFLICT, str(why)) from None
    except OSError as error:
        reason = f"The inbox cannot be written: {error.strerror}."
        raise HTTPException(HTTPStatus.INTERNAL_SERVER_ERROR, reason) from None


def _name(operator: str) -> str:
    return " ".join(operator.split())[:NAME_LIMIT]


def state_json(inbox: Inbox) -> str:
    """Return the latest questions and missions of an inbox as JSON."""
    questions = [asdict(entry) for entry in inbox.entries()[-RECENT:]]
    return plain_json({"questions": questions, "missions": inbox.missions()[-MISSIONS:]})


def _json(content: Any, status: HTTPStatus = HTTPStatus.OK) -> Response:
    return Response(plain_json(content), int(status), media_type="application/json")
