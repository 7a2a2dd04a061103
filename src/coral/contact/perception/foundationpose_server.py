"""A small server to start beside a FoundationPose installation; it needs that and numpy, and nothing of this package.

    python foundationpose_server.py --repository PATH_OF_FOUNDATIONPOSE [--host 127.0.0.1] [--port 5070]

Every request and answer is HTTP with arrays in NumPy's npz format (requests are POST); nothing is unpickled.

    /init      vertices (n, 3) m, faces (m, 3), symmetry (k, 4, 4)            -> session
    /register  session, K (3, 3), rgb (H, W, 3), depth (H, W) m, mask (H, W)  -> pose (4, 4), object to camera
    /track     session, K, rgb, depth                                         -> pose
    /close     session                                                        -> (nothing)

An error is status 400 with a line of text. There is no password: serve only to networks that you trust.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import sys
import uuid
import zipfile
import zlib
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import Any, Callable, Dict, Tuple  # noqa: UP035 (FoundationPose's own environment is Python 3.8 or 3.9)

import numpy as np

LIMIT_BYTES = 256 * 1024 * 1024
MAX_SESSIONS = 16
Arrays = Dict[str, np.ndarray]  # noqa: UP006
Estimators = Callable[[np.ndarray, np.ndarray, np.ndarray], Any]
"""Makes an estimator with FoundationPose's `register` and `track_one` from vertices, faces and symmetry transforms."""


def encode(arrays: Arrays) -> bytes:
    """Encode arrays as npz, uncompressed."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    return buffer.getvalue()


def decode(data: bytes) -> Arrays:
    """Decode arrays from npz.

    Raises:
        ValueError: The data are not npz, contain anything but plain arrays, or exceed 256 MiB unpacked.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            if sum(item.file_size for item in archive.infolist()) > LIMIT_BYTES:
                raise ValueError("more than 256 MiB of arrays")
        with np.load(io.BytesIO(data), allow_pickle=False) as found:
            return {name: found[name] for name in found.files}
    except (zipfile.BadZipFile, zlib.error, KeyError, EOFError, OSError, RuntimeError, MemoryError) as error:
        raise ValueError(f"not an npz file: {error}") from None


class Sessions:
    """Keeps one estimator for each object of each client."""

    def __init__(self, make: Estimators) -> None:
        self._make = make
        self._open: Dict[str, Any] = {}  # noqa: UP006

    def answer(self, verb: str, request: Arrays) -> Arrays:
        """Answer one request.

        Raises:
            ValueError: The request is invalid.
        """
        if verb == "init":
            if len(self._open) >= MAX_SESSIONS:
                self._open.pop(next(iter(self._open)))
            session = uuid.uuid4().hex
            vertices, faces = _get(request, "vertices", (None, 3)), _get(request, "faces", (None, 3))
            if len(faces) and not (faces.min() >= 0 and faces.max() < len(vertices)):
                raise ValueError("a face names a vertex that is not there")
            symmetry = _get(request, "symmetry", (None, 4, 4))
            self._open[session] = self._make(vertices.astype(float), faces.astype(int), symmetry.astype(float))
            return {"session": np.array(session)}
        session = str(request.get("session"))
        if session not in self._open:
            raise ValueError("no such session: init again")
        if verb == "close":
            del self._open[session]
            return {}
        if verb not in ("register", "track"):
            raise ValueError(f"no such verb: {verb!r}")
        rgb = _get(request, "rgb", (None, None, 3)).astype(np.uint8)
        depth = _get(request, "depth", rgb.shape[:2]).astype(np.float32)
        camera = _get(request, "K", (3, 3)).astype(np.float64)
        steps = int(request["iterations"]) if "iterations" in request else (5 if verb == "register" else 2)
        if verb == "register":
            mask = _get(request, "mask", rgb.shape[:2]).astype(bool)
            pose = self._open[session].register(K=camera, rgb=rgb, depth=depth, ob_mask=mask, iteration=steps)
        else:
            pose = self._open[session].track_one(rgb=rgb, depth=depth, K=camera, iteration=steps)
        return {"pose": np.asarray(pose, np.float64).reshape(4, 4)}


def _get(request: Arrays, name: str, shape: Tuple[Any, ...]) -> np.ndarray:  # noqa: UP006
    if name not in request:
        raise ValueError(f"missing: {name}")
    array = request[name]
    fits = array.ndim == len(shape) and all(want in (None, have) for want, have in zip(shape, array.shape))  # noqa: B905 (Python 3.8)
    if not fits or array.dtype.kind not in "fiub" or not np.isfinite(array).all():
        raise ValueError(f"{name}: expected finite numbers of shape {shape}, found {array.dtype} {array.shape}")
    return array


def serve(sessions: Sessions, host: str, port: int) -> HTTPServer:
    """Make a server that is bound and not yet started; it handles one request at a time, as there is one GPU."""

    class Handler(BaseHTTPRequestHandler):
        timeout = 30.0  # a silent client must not block the others

        def do_POST(self) -> None:
            try:
                length = int(self.headers.get("Content-Length", "0"))
                if not 0 < length <= LIMIT_BYTES:
                    raise ValueError("a body of 1 byte to 256 MiB is needed")
                reply, status = encode(sessions.answer(self.path.strip("/"), decode(self.rfile.read(length)))), 200
            except Exception as error:  # report any error to the client and continue
                reply, status = str(error).encode("utf-8", "replace"), 400
            with contextlib.suppress(OSError):  # the client has disconnected
                self.send_response(status)
                self.send_header("Content-Length", str(len(reply)))
                self.end_headers()
                self.wfile.write(reply)

        def log_message(self, format: str, *args: Any) -> None:
            """Suppress the log line of each request."""

    return HTTPServer((host, port), Handler)


def foundationpose() -> Estimators:
    """Load FoundationPose's networks once and return a maker of estimators."""
    import nvdiffrast.torch as dr  # type: ignore[import-not-found]
    import trimesh  # type: ignore[import-not-found]
    from estimater import (  # type: ignore[import-not-found]
        FoundationPose,
        PoseRefinePredictor,
        ScorePredictor,
    )

    scorer, refiner, context = ScorePredictor(), PoseRefinePredictor(), dr.RasterizeCudaContext()

    def make(vertices: np.ndarray, faces: np.ndarray, symmetry: np.ndarray) -> Any:
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        return FoundationPose(
            model_pts=mesh.vertices,
            model_normals=mesh.vertex_normals,
            symmetry_tfs=symmetry,
            mesh=mesh,
            scorer=scorer,
            refiner=refiner,
            glctx=context,
        )

    return make


def main() -> None:
    """Serve until interrupted."""
    parser = argparse.ArgumentParser(description="Serve FoundationPose's register and track_one over HTTP.")
    parser.add_argument("--repository", default=".", help="folder of the FoundationPose checkout")
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=5070)
    given = parser.parse_args()
    sys.path.insert(0, os.path.abspath(given.repository))
    try:
        make = foundationpose()
    except ImportError as error:
        sys.exit(f"no FoundationPose in {given.repository} ({error}): name its folder by --repository")
    server = serve(Sessions(make), given.host, given.port)
    print(f"serving on http://{given.host}:{given.port}", flush=True)
    with contextlib.suppress(KeyboardInterrupt):
        server.serve_forever()


if __name__ == "__main__":
    main()
