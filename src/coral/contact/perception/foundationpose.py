"""A pose tracker that uses a FoundationPose server (Wen et al., CVPR 2024); see `foundationpose_server`."""

from __future__ import annotations

import contextlib
import re
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.confidence import PoseBelief, is_unseen, patch_around
from coral.contact.perception.foundationpose_server import LIMIT_BYTES, Arrays, decode, encode
from coral.contact.perception.object_model import ObjectModel
from coral.contact.perception.tracker import PoseEstimate, TrackerFailed
from coral.contact.scene.geometry import inverse_transform
from coral.contact.scene.observation import Array
from coral.errors import InputError

URL = re.compile(r"http://(?:\[[\da-fA-F:.]+\]|[\w.-]+)(?::(?:[1-5]?\d{1,4}|6[0-4]\d{3}|65[0-5]\d{2}))?/?", re.ASCII)
"""Form of an address: a host, perhaps with a port."""
CONNECT_S = 5.0
"""Longest time to connect."""
REGISTER_STEPS, TRACK_STEPS = 5, 2
"""Refinement steps per pose: those of FoundationPose's own demo."""
ANSWER_S = 30.0
"""Time for one answer, to its last byte."""


class OutOfReach(TrackerFailed):
    """The server does not answer."""


class FoundationPoseTracker:
    """Tracks one object through a server; it assesses the poses itself, because the server gives no confidence.

    The object's triangles are sent to the server at `url`; `expected` is as in `ModelTracker`.

    Raises:
        TrackerFailed: The server does not answer, or refuses the object.
    """

    def __init__(self, model: ObjectModel, url: str, expected: Array | None = None) -> None:
        self.model, self.url = model, url
        self._session: NDArray[Any] | None = None
        self.belief = PoseBelief(model, expected)
        vertices, faces = np.unique(model.triangles.reshape(-1, 3).round(7), axis=0, return_inverse=True)
        shape = {"vertices": vertices, "faces": faces.reshape(-1, 3), "symmetry": model.symmetry.members(36)}
        self._session = self._ask("init", shape).get("session")
        if self._session is None:
            raise TrackerFailed(f"foundationpose at {self.url}: the answer to init names no session")

    def register(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> PoseEstimate:
        """Find the object without a previous pose.

        Raises:
            InputError: The picture has no colours.
            TrackerFailed: The server fails.
        """
        if is_unseen(frame, mask):  # the network would silently return the identity
            return self.belief.lose("not seen")
        request = self._picture(frame) | {"mask": mask, "iterations": np.array(REGISTER_STEPS)}
        return self._assess(frame, mask, self._pose("register", request), registered=True)

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_], guess: Array | None = None) -> PoseEstimate:
        """See `PoseTracker`. FoundationPose tracks from its own last pose, without hint or mask.

        The mask is only used to detect whether the object is lost.

        Raises:
            InputError: The picture has no colours.
            TrackerFailed: The server fails.
        """
        if not self.belief.follows:
            return self.register(frame, mask)
        if is_unseen(frame, mask):
            return self.belief.lose("not seen")
        request = self._picture(frame) | {"iterations": np.array(TRACK_STEPS)}
        return self._assess(frame, mask, self._pose("track", request))

    def close(self) -> None:
        """See `PoseTracker`; the server deletes the object."""
        session, self._session = self._session, None
        if session is not None:
            with contextlib.suppress(TrackerFailed):
                self._ask("close", {"session": session})

    def _picture(self, frame: RgbdFrame) -> Arrays:
        if frame.rgb is None:
            raise InputError("foundationpose", "camera", "a picture without colours", "a camera that takes colours")
        if self._session is None:
            raise TrackerFailed(f"foundationpose at {self.url}: the tracker was closed, or lost its server")
        return {"session": self._session, "K": frame.K, "rgb": frame.rgb, "depth": frame.depth}

    def _pose(self, verb: str, request: Arrays) -> Array:
        pose = self._ask(verb, request).get("pose", np.zeros(0))
        if (
            pose.shape != (4, 4)
            or pose.dtype.kind != "f"
            or not np.isfinite(pose).all()
            or not np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-3)
            or np.linalg.det(pose[:3, :3]) < 0
        ):
            raise TrackerFailed(f"foundationpose at {self.url}: the answer to {verb} is no pose")
        return pose.astype(float)

    def _assess(self, frame: RgbdFrame, mask: NDArray[np.bool_], pose: Array, registered: bool = False) -> PoseEstimate:
        poses = [pose, inverse_transform(frame.T_world_camera) @ self.belief.pose]
        return self.belief.update(frame, patch_around(frame, mask, self.model, poses, 12000), pose, registered)

    def _ask(self, verb: str, request: Arrays) -> Arrays:
        try:
            return exchange(self.url, verb, encode(request), ANSWER_S)
        except OutOfReach:
            self._session = None  # so that `close` does not wait for a dead server again
            raise


def exchange(url: str, verb: str, question: bytes, timeout_s: float) -> Arrays:
    """Send one request, its arrays as npz, to a server and return its answer; see `foundationpose_server`.

    The verb is "init", "register", "track" or "close"; "" only asks whether there is a server, which has no answer. The
    time-out counts to the answer's last byte.

    Raises:
        OutOfReach: The server does not answer in time.
        TrackerFailed: The server refuses, or its answer cannot be read.
    """
    import httpx2 as httpx

    body, end = b"", time.monotonic() + timeout_s
    address, timeout = f"{url.rstrip('/')}/{verb}", httpx.Timeout(timeout_s, connect=CONNECT_S)
    try:
        with httpx.stream("POST", address, content=question, timeout=timeout, trust_env=False) as reply:
            for part in reply.iter_raw():
                body += part
                if len(body) > LIMIT_BYTES:
                    raise ValueError("an answer of more than 256 MiB")
                if time.monotonic() > end:  # the library's own limit begins anew with every byte
                    raise httpx.ReadTimeout("too slow")
        if not verb:
            return {}
        if reply.status_code != 200:
            text = " ".join(body[:300].decode("utf-8", "replace").split())
            raise TrackerFailed(f"foundationpose at {url} refuses to {verb}: {text}")
        return {name: np.asarray(array) for name, array in decode(body).items()}
    except httpx.TimeoutException:
        raise OutOfReach(f"foundationpose at {url}: no answer to {verb or 'a request'} in {timeout_s:g} s") from None
    except httpx.HTTPError as error:
        text = " ".join(str(error).split()) or type(error).__name__
        raise OutOfReach(f"foundationpose at {url} does not answer: {text}") from None
    except ValueError as error:
        raise TrackerFailed(f"foundationpose at {url}: {error}") from None
