"""The viewer: one page for a run under way and for a recorded one, fed by what the run writes into its folder."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from pathlib import Path
from typing import Any

import numpy as np
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import BaseRoute, Route

from coral.drawing import Image, png
from coral.foreign_file import read_text
from coral.interrupts import wait_for_interrupt
from coral.reef.pictures.cameraview import camera_picture
from coral.reef.pictures.mapframe import CELL_COLORS
from coral.run_files import RunFiles, SurveyFiles, TaskFiles
from coral.terminal import tell
from coral.view.live.controls import RunControls, SurveyControls
from coral.view.live.stream import RunStream, Subject
from coral.view.run import RunFolder, read_camera_frame, read_frame
from coral.web import WebServer, read_json

PAGE = read_text(Path(__file__).parent / "page.html", "a file of this package")
PICTURE = (320, 240)
PERIOD_S = 0.3
"""Shortest wall time between two sketches of a plan."""
GONE_S = 3.0
"""A page that has not asked for this long is closed."""


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """A line of the present plan, which no record keeps."""

    name: str
    color: str
    points: Any
    """Shape=(N, 2 or 3), metres."""
    width: float = 2.0
    layer: str = ""
    """"rollouts" can be hidden."""


@dataclass
class Now:
    """What only a run under way can tell."""

    status: str = "waiting"
    note: str = ""
    numbers: Sequence[tuple[str, str]] = ()
    strokes: Sequence[Stroke] = ()


class Viewer(WebServer):
    """Serves one run folder."""

    def __init__(
        self,
        folder: Path,
        controls: RunControls | SurveyControls | None = None,
        *,
        rate: float = 10.0,
        port: int = 0,
        flag: str = "--port",
    ) -> None:
        """Open the page on this machine, of a run folder that is written or being written; port 0 chooses a free one.

        A recorded run has no controls, the operator's buttons; it is played at a `rate`, in multiples of real time.

        Raises:
            InputError: The port is in use or invalid.
        """
        self.folder, self.controls, self._rate = folder, controls, rate
        self.stream = RunStream(folder, lambda: subject_of(folder))
        self.now = Now()
        self._frames: dict[str, Any] = {"maps": [], "eyes": [], "colour": False}
        self._looked = self._asked = -10.0
        self._visited = threading.Event()
        super().__init__(self._routes(), page=PAGE, port=port, flag=flag)

    @property
    def watched(self) -> bool:
        """Return whether a browser looks at the page."""
        return time.monotonic() - self._asked < GONE_S

    def wait_for_viewer(self, what: str) -> None:
        """Print the address, and wait until a browser has opened it.

        Raises:
            KeyboardInterrupt: Ctrl-C.
        """
        tell(f"the {what} begins when you open {self.url} (--no-wait: at once)")
        self._visited.wait()

    def stay(self) -> None:
        """Keep the page until Ctrl-C: the run can be played again."""
        wait_for_interrupt(f"the page stays, and plays the run again: {self.url}; Ctrl-C closes it")

    def close(self) -> None:
        """Close the page."""
        super().close()
        self.stream.close()

    def _routes(self) -> Sequence[BaseRoute]:
        return [
            Route("/api/head", self._head),
            Route("/api/news", self._news),
            Route("/api/press", self._press, methods=["POST"]),
            Route("/frames/{step:int}/{kind}", self._frame),
            Route("/pictures/{digest}", self._picture),
        ]

    def _head(self, _: Request) -> Response:
        subject = self.stream.subject
        told = subject.head if subject is not None else {}
        return JSONResponse({"live": self.controls is not None, "rate": self._rate, **told})

    def _news(self, request: Request) -> Response:
        self._asked = time.monotonic()
        self._visited.set()
        have = request.query_params
        try:
            moments, rows = int(have.get("moments", "0")), int(have.get("rows", "0"))
        except ValueError:
            raise HTTPException(HTTPStatus.BAD_REQUEST, "The request must count what the page has.") from None
        news = self.stream.news(max(moments, 0), max(rows, 0))
        return JSONResponse({**news, **self._pictures(), "now": self._now()})

    def _now(self) -> dict[str, Any] | None:
        if self.controls is None:
            return None
        now = self.now
        strokes = [
            {**vars(stroke), "points": np.asarray(stroke.points, np.float64).round(3).tolist()}
            for stroke in now.strokes
        ]
        panel = self.controls.panel(now.status)
        return {"status": now.status, "note": now.note, "numbers": now.numbers, "strokes": strokes, **panel}

    def _pictures(self) -> dict[str, Any]:
        """Return the steps that have a map, those that have a camera picture, and whether it has colours."""
        if time.monotonic() - self._looked > 1.0:
            self._looked, frames = time.monotonic(), self.folder / SurveyFiles.FRAMES
            for key, kind in (("maps", "map"), ("eyes", "labels")):
                names = [path.name for path in frames.glob(f"*_{kind}.png")]
                self._frames[key] = sorted(int(name.partition("_")[0]) for name in names if name[:6].isdigit())
            self._frames["colour"] = self._frames["colour"] or any(frames.glob("*_rgb.jpg"))
        return self._frames

    def _frame(self, request: Request) -> Response:
        picture = frame_picture(self.folder, request.path_params["step"], request.path_params["kind"])
        if picture is None:
            raise HTTPException(HTTPStatus.NOT_FOUND, "There is no such picture.")
        return Response(png(picture), media_type="image/png")

    def _picture(self, request: Request) -> Response:
        digest = request.path_params["digest"]
        path = self.folder / RunFiles.PICTURES / f"{digest}.png"
        if not re.fullmatch(r"\w{1,128}", digest) or path.is_symlink() or not path.is_file():
            raise HTTPException(HTTPStatus.NOT_FOUND, "There is no such picture.")
        return FileResponse(path, media_type="image/png")

    async def _press(self, request: Request) -> Response:
        content = await read_json(request)
        name = content.get("name")
        if self.controls is None or not isinstance(name, str) or not self.controls.press(name, content.get("value")):
            raise HTTPException(HTTPStatus.BAD_REQUEST, "There is no such button.")
        return JSONResponse({"ok": True})


def subject_of(folder: Path) -> Subject | None:
    """Return what a run is about; None as long as it has not begun.

    Raises:
        InputError: It is a task, and its folder has no task file or no seed.
    """
    events = folder / RunFiles.EVENTS
    if not (folder / RunFiles.CONFIG).is_file() and not (events.is_file() and events.stat().st_size):
        return None
    run = RunFolder.read(folder)
    if (folder / TaskFiles.TASK).is_file():
        from coral.view.live.task_subject import TaskSubject

        return TaskSubject(run)
    from coral.view.live.reef_subject import ReefSubject

    return ReefSubject(run)


def frame_picture(folder: Path, step: int, kind: str) -> Image | None:
    """Draw one picture of a run: "map", "segmentation", "depth" or "colour"; None if it was not kept."""
    if kind == "map":
        cells = read_frame(folder, step, "map")
        return None if cells is None else CELL_COLORS[np.minimum(cells, 3)][::-1]
    frame = read_camera_frame(folder, step)
    if frame is None or kind not in ("segmentation", "depth", "colour") or (kind == "colour" and frame.rgb is None):
        return None
    return camera_picture(frame, kind, PICTURE)  # type: ignore[arg-type]


Sketch = Callable[[Any], Sequence[Stroke]]
