"""A pose tracker whose poses come from a FoundationPose server (Wen et al., CVPR 2024); see `foundationpose_server`."""

from __future__ import annotations

import http.client
from dataclasses import dataclass, field
from urllib.parse import urlsplit

import numpy as np
from numpy.typing import NDArray

from coral.config import Count, Positive
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.confidence import ConfidenceCfg, judge, unseen, view_of
from coral.contact.perception.foundationpose_server import Arrays, decode, encode
from coral.contact.perception.rotation import inverse
from coral.contact.perception.shapes import ObjectModel
from coral.contact.perception.tracker import Estimate
from coral.errors import InputError, RunError

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FoundationPoseCfg:
    """Defaults are those of FoundationPose's own demo."""

    url: str = "http://127.0.0.1:5070"
    register_steps: Count = 5
    track_steps: Count = 2
    timeout_s: Positive = 30.0
    confidence: ConfidenceCfg = field(default_factory=ConfidenceCfg)


class FoundationPoseTracker:
    """Tracks one object by a server; whether its poses can be relied on is judged here, since it does not say.

    Args:
        model: The object; its triangles go to the server.
        cfg: Which server, and how.
        expected: T_world_object, Shape=(4, 4), as in `ModelTracker`.

    Raises:
        InputError: The address is none of an HTTP server.
        RunError: The server does not answer, or refuses the object.
    """

    name = "foundationpose"

    def __init__(
        self, model: ObjectModel, cfg: FoundationPoseCfg | None = None, expected: Array | None = None,
    ) -> None:
        self.model, self.cfg = model, cfg or FoundationPoseCfg()
        address = urlsplit(self.cfg.url)
        if address.scheme != "http" or not address.hostname:
            raise InputError("foundationpose", "url", self.cfg.url, "an address as http://127.0.0.1:5070")
        self._host, self._port = address.hostname, address.port or 80
        self._reference = np.eye(4) if expected is None else expected
        self._found, self._lost = False, False
        vertices, faces = np.unique(model.triangles.reshape(-1, 3).round(7), axis=0, return_inverse=True)
        self._session = self._ask("init", {
            "vertices": vertices, "faces": faces.reshape(-1, 3), "symmetry": model.symmetry.members(36)})["session"]

    def register(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> Estimate:
        """See `PoseTracker`.

        Raises:
            InputError: The picture has no colours.
            RunError: The server fails.
        """
        if unseen(frame, mask, self.cfg.confidence):  # the network would return the identity without a word
            return self._give_up("not seen")
        request = self._picture(frame) | {"mask": mask, "iterations": np.array(self.cfg.register_steps)}
        return self._judge(frame, mask, self._pose("register", request), registered=True)

    def track(self, frame: RgbdFrame, mask: NDArray[np.bool_]) -> Estimate:
        """See `PoseTracker`; FoundationPose itself does without the mask, which here tells whether the object is lost.

        Raises:
            InputError: The picture has no colours.
            RunError: The server fails.
        """
        if not self._found or self._lost:
            return self.register(frame, mask)
        if unseen(frame, mask, self.cfg.confidence):
            return self._give_up("not seen")
        request = self._picture(frame) | {"iterations": np.array(self.cfg.track_steps)}
        return self._judge(frame, mask, self._pose("track", request))

    def _picture(self, frame: RgbdFrame) -> Arrays:
        if frame.rgb is None:
            raise InputError("foundationpose", "camera", "a picture without colours", "a camera that takes colours")
        return {"session": self._session, "K": frame.K, "rgb": frame.rgb, "depth": frame.depth}

    def _pose(self, verb: str, request: Arrays) -> Array:
        pose = np.asarray(self._ask(verb, request).get("pose", np.zeros(0)), float)
        if pose.shape != (4, 4) or not np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-3):
            raise RunError(f"foundationpose at {self.cfg.url}: the answer to {verb} is no pose")
        return pose

    def _judge(self, frame: RgbdFrame, mask: NDArray[np.bool_], pose: Array, registered: bool = False) -> Estimate:
        cfg = self.cfg.confidence
        view = view_of(frame, mask, self.model, [pose, inverse(frame.T_world_camera) @ self._reference], cfg, 12000)
        following = self._found and not self._lost
        verdict = judge(self.model, view, pose, cfg, following)
        if verdict.reason:
            return self._give_up(verdict.reason, verdict.visible)
        self._reference = self.model.symmetry.nearest(frame.T_world_camera @ pose, self._reference)
        self._found, self._lost = True, False
        return Estimate(self._reference, verdict.confidence, False, verdict.visible, "", registered)

    def _give_up(self, reason: str, visible: float = 0.0) -> Estimate:
        self._lost = True
        return Estimate(self._reference, 0.0, True, visible, reason)

    def _ask(self, verb: str, request: Arrays) -> Arrays:
        connection = http.client.HTTPConnection(self._host, self._port, timeout=self.cfg.timeout_s)
        try:
            connection.request("POST", f"/{verb}", encode(request))
            reply = connection.getresponse()
            body = reply.read()
            if reply.status != 200:
                text = body[:300].decode("utf-8", "replace")
                raise RunError(f"foundationpose at {self.cfg.url} refuses to {verb}: {text}")
            return decode(body)
        except (OSError, http.client.HTTPException) as error:
            raise RunError(f"foundationpose at {self.cfg.url} does not answer: {error}") from None
        except ValueError as error:
            raise RunError(f"foundationpose at {self.cfg.url}: {error}") from None
        finally:
            connection.close()
