"""A page on which a person clicks each object once in a picture; open until the answer has come."""

from __future__ import annotations

import json
import math
import queue
from collections.abc import Sequence
from html import escape
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING, Any

from coral.foreign_file import read_text
from coral.web import WebServer, read_json, refusal

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

PAGE = read_text(Path(__file__).parent / "click_page.html", "a file of this package")
BODY_LIMIT = 16 * 1024
"""Maximum size of an answer, bytes."""

Clicks = dict[str, tuple[int, int]]


class ClickPage(WebServer):
    """Shows one picture and takes one answer.

    Args:
        names: What to click, in this order.
        png: The picture.
        size: Its width and height.
        port: Port on this machine's own address; 0 chooses a free one.

    Raises:
        InputError: The port cannot be used.
    """

    def __init__(self, names: Sequence[str], png: bytes, size: tuple[int, int], port: int = 0) -> None:
        from starlette.routing import Route

        self.names, self.png, self.size = tuple(names), png, size
        self.answers: queue.Queue[Clicks] = queue.Queue()
        routes = [Route("/picture.png", self._picture), Route("/clicks", self._take, methods=["POST"])]
        page = PAGE.replace("{{names}}", escape(json.dumps(self.names), quote=True))
        super().__init__(routes, page=page, port=port)

    def parse(self, content: Any) -> Clicks | str:
        """Return the clicks of an answer, or why it is none."""
        if set(content) != set(self.names):
            return f"Expected one pixel for each of {', '.join(self.names)}."
        clicks = {}
        for name in self.names:
            pixel = content[name]
            if not isinstance(pixel, list) or len(pixel) != 2 or not all(_is_number(one) for one in pixel):
                return f"{name}: expected [column, row]."
            column, row = (math.floor(one) for one in pixel)
            if not (0 <= column < self.size[0] and 0 <= row < self.size[1]):
                return f"{name}: expected a pixel of {self.size[0]} x {self.size[1]}."
            clicks[name] = (column, row)
        return clicks

    def _picture(self, _: Request) -> Response:
        from starlette.responses import Response

        return Response(self.png, media_type="image/png")

    async def _take(self, request: Request) -> Response:
        from starlette.responses import JSONResponse

        found = self.parse(await read_json(request, BODY_LIMIT))
        if isinstance(found, str):
            raise refusal(HTTPStatus.UNPROCESSABLE_ENTITY, found)
        self.answers.put(found)
        return JSONResponse({"ok": True})


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)
