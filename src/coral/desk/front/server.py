"""The server of the front page: it starts runs, and opens the pages that show them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from http import HTTPStatus
from pathlib import Path
from typing import Any

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

from coral.desk.front.jobs import MOST, Job
from coral.desk.front.run_list import run_card, run_folders
from coral.desk.inbox import Inbox
from coral.desk.server import DeskServer
from coral.errors import InputError
from coral.foreign_file import read_text
from coral.run_files import RunFiles
from coral.view.live.viewer import Viewer
from coral.web import WebServer, read_json

PAGE = read_text(Path(__file__).parent / "page.html", "a file of this package")
MOST_PAGES = 20
"""Pages of runs that are open at once; the oldest is closed for another."""

Start = Callable[[Mapping[str, Any]], tuple[list[str], Path]]
"""Makes the words of a command and its run folder from the choices on the page. Raises InputError."""


class FrontServer(WebServer):
    """Serves the front page of a folder of runs, and on ports of their own the pages that it opens.

    `choices` are what the page offers: by system, the names of its reefs or tasks and its settings.

    Raises:
        InputError: The port is in use or invalid.
    """

    def __init__(self, root: Path, choices: Mapping[str, Any], start: Start, *, port: int = 0) -> None:
        self.root, self.jobs = root, list[Job]()
        self._choices, self._start = choices, start
        self._pages: dict[tuple[str, str], WebServer] = {}
        super().__init__(self._routes(), page=PAGE, port=port)

    def close(self) -> None:
        """Stop the runs, so that their folders are complete, and close all pages."""
        for job in self.jobs:
            job.stop()
        for job in self.jobs:
            job.stop(20.0)
        for page in self._pages.values():
            page.close()
        super().close()

    def _routes(self) -> Sequence[BaseRoute]:
        return [
            Route("/api/choices", self._offer),
            Route("/api/state", self._state),
            Route("/api/start", self._begin, methods=["POST"]),
            Route("/api/stop", self._end, methods=["POST"]),
            Route("/api/open", self._open, methods=["POST"]),
        ]

    def _offer(self, _: Request) -> Response:
        return JSONResponse(self._choices)

    def _state(self, _: Request) -> Response:
        going = {job.folder: job for job in self.jobs if job.running}
        runs = [{**run_card(path, self.root), "running": path in going} for path in run_folders(self.root)]
        jobs = [
            {
                "number": number,
                "command": " ".join(("coral", *job.words)),
                "name": job.folder.relative_to(self.root).as_posix(),
                "running": job.running,
                "code": job.code,
                "told": job.told,
                "opens": bool(job.url) or not job.running,
                "asks": (job.folder / RunFiles.INBOX).is_dir(),
            }
            for number, job in enumerate(self.jobs)
        ]
        return JSONResponse({"runs": runs, "jobs": jobs[::-1]})

    async def _begin(self, request: Request) -> Response:
        wanted = await read_json(request)
        if sum(job.running for job in self.jobs) >= MOST:
            raise HTTPException(HTTPStatus.CONFLICT, f"{MOST} runs are going on; stop one, or wait.")
        try:
            words, folder = self._start(wanted)
        except InputError as error:
            raise HTTPException(HTTPStatus.BAD_REQUEST, str(error)) from None
        self.jobs.append(Job(words, folder))
        return JSONResponse({"number": len(self.jobs) - 1})

    async def _end(self, request: Request) -> Response:
        number = (await read_json(request)).get("number")
        if not isinstance(number, int) or not 0 <= number < len(self.jobs):
            raise HTTPException(HTTPStatus.NOT_FOUND, "There is no such run.")
        self.jobs[number].stop()
        return JSONResponse({})

    async def _open(self, request: Request) -> Response:
        """Open a page of a run: `watch` it, read its `report`, or `answer` its questions. Send the address."""
        wanted = await read_json(request)
        name, what = wanted.get("name"), wanted.get("what")
        folders = {path.relative_to(self.root).as_posix(): path for path in run_folders(self.root)}
        folders |= {job.folder.relative_to(self.root).as_posix(): job.folder for job in self.jobs}
        if not isinstance(name, str) or name not in folders or what not in ("watch", "report", "answer"):
            raise HTTPException(HTTPStatus.NOT_FOUND, "There is no such run.")
        going = next((job for job in self.jobs if job.running and job.folder == folders[name]), None)
        if what == "watch" and going is not None:
            if not going.url:
                raise HTTPException(HTTPStatus.CONFLICT, "It has not opened its page yet.")
            return JSONResponse({"url": going.url})
        try:
            return JSONResponse({"url": self._page(folders[name], what).url})
        except InputError as error:
            raise HTTPException(HTTPStatus.BAD_REQUEST, str(error)) from None

    def _page(self, folder: Path, what: str) -> WebServer:
        key = (str(folder), what)
        if key not in self._pages:
            page: WebServer
            if what == "watch":
                page = Viewer(folder)
                page.stream.subject  # noqa: B018  # tells what is wrong before the page opens
            elif what == "answer":
                page = DeskServer(Inbox(folder / RunFiles.INBOX), port=0)
            else:
                page = WebServer((), page=read_text(folder / RunFiles.REPORT, "the report of a run"))
            if len(self._pages) >= MOST_PAGES:
                self._pages.pop(next(iter(self._pages))).close()
            self._pages[key] = page.__enter__()
        return self._pages[key]
