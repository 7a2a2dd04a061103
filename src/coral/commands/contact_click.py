"""`coral contact click`: click each object of a task once in a camera's first picture."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from coral.contact.real_scenes.cameras.camera_registry import camera_help, make_camera_by_name
from coral.contact.scene.task_names import shipped_tasks
from coral.errors import InputError, RunError
from coral.file_writer import write_whole
from coral.flags import Argument, Option


@dataclass(frozen=True, kw_only=True)
class ContactClick:
    """Click each object of a task once, on a page in your browser. The file of clicks serves --masks click: and onnx:.

    Leave camera and objects as they are until tracking has begun.
    """

    task: Annotated[str, Argument(metavar="TASK", names=shipped_tasks)]
    """A shipped task or a task file."""
    camera: Annotated[str, Option(metavar="CAMERA", help=f"The camera: {camera_help()}.")]
    out: Annotated[Path, Option(metavar="YAML")]
    """File of clicks to write, new."""
    port: int = 0
    """Port of the page on this machine; 0 chooses a free one."""
    json: bool = False
    """Print one JSON object on standard output."""

    def __call__(self) -> Mapping[str, Any]:
        """Take a picture, and wait for the clicks."""
        import cv2
        import numpy as np

        from coral.contact.real_scenes.cameras.frame_stream import stream_frames
        from coral.contact.tasks import load_task
        from coral.view.click_page import ClickPage

        if self.out.exists():
            raise InputError("--out", "", str(self.out), "a new file")
        if not 0 <= self.port <= 65_535:
            raise InputError("--port", "", self.port, "a port from 1 to 65535, or 0 for a free one")
        names = [item.name for item in load_task(self.task).objects]
        # Where the camera stands does not matter for a click.
        with closing(make_camera_by_name(self.camera, np.eye(4))) as camera:
            camera.start()
            frame = next(iter(stream_frames(camera)), None)
        if frame is None:
            raise RunError(f"the camera {self.camera} sent no picture")
        if frame.rgb is None:
            raise InputError("--camera", "", f"{self.camera}, without colours", "a camera or recording with colours")
        height, width = frame.rgb.shape[:2]
        png = cv2.imencode(".png", np.ascontiguousarray(frame.rgb[..., ::-1]))[1].tobytes()
        with ClickPage(names, png, (width, height), self.port) as page:
            print(f"click {', '.join(names)} at {page.url}", file=sys.stderr, flush=True)
            clicks = page.answers.get()
        self._write(clicks)
        return {"file": str(self.out), "objects": {name: list(pixel) for name, pixel in clicks.items()}}

    def describe(self, result: Mapping[str, Any]) -> str:
        """Say where the clicks are."""
        return f"clicks: {result['file']}"

    def _write(self, clicks: Mapping[str, tuple[int, int]]) -> None:
        lines = [f"  {json.dumps(name)}: [{column}, {row}]" for name, (column, row) in clicks.items()]
        write_whole(self.out, "\n".join(["objects:", *lines]) + "\n", replace=False)
