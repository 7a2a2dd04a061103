"""A reef run as a recording for rerun."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from coral.errors import InputError
from coral.file_writer import scratch_for
from coral.reef.map.mapping import OccupancyMap
from coral.reef.recordings.bag_export import MAP_EVERY_S
from coral.reef.recordings.class_colours import CLASS_COLOURS
from coral.reef.recordings.picture_files import encode_depth, encode_jpeg
from coral.reef.recordings.recording import Recording
from coral.reef.recordings.transforms import body_transform, camera_in_body
from coral.reef.world.geometry import Label


def write_rerun(recording: Recording, path: Path) -> dict[str, int]:
    """Write a located recording.

    Returns:
        Number of logged keyframes and maps.

    Raises:
        InputError: rerun is not installed.
    """
    try:
        import rerun as rr
    except ImportError:
        raise InputError(
            str(path),
            "--to",
            "no package rerun",
            "rerun-sdk (some 500 MB: pip install 'coral-robotics[rerun]'), or --to mcap",
        ) from None
    with scratch_for(path) as scratch:
        return _write(rr, recording, scratch)


def _write(rr: Any, recording: Recording, path: Path) -> dict[str, int]:
    stream = rr.RecordingStream("coral", recording_id=recording.name)
    stream.set_log_time_enabled(False)  # the clock of this machine is no part of the survey
    stream.set_log_tick_enabled(False)
    stream.save(str(path))
    camera = recording.camera
    focal, _, cx, cy = camera.intrinsics
    mount = camera_in_body(camera)
    stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    stream.log("world", rr.AnnotationContext([(int(k), k.name.lower(), CLASS_COLOURS[k]) for k in Label]), static=True)
    stream.log("world/robot/camera", rr.Transform3D(translation=mount[:3, 3], mat3x3=mount[:3, :3]), static=True)
    stream.log(
        "world/robot/camera/image",
        rr.Pinhole(focal_length=focal, principal_point=(cx, cy), width=camera.width, height=camera.height),
        static=True,
    )
    cells = OccupancyMap(recording.size_m, camera, recording.map)
    counts, due = {"keyframes": 0, "maps": 0}, 0.0
    for keyframe in recording.keyframes():
        stream.set_time("t", duration=keyframe.t)
        at = body_transform(keyframe.pose, keyframe.height_m, keyframe.roll, keyframe.pitch)
        stream.log("world/robot", rr.Transform3D(translation=at[:3, 3], mat3x3=at[:3, :3]))
        frame = keyframe.frame
        if frame.rgb is not None:
            jpeg = rr.EncodedImage(contents=encode_jpeg(frame.rgb), media_type="image/jpeg")
            stream.log("world/robot/camera/image/colour", jpeg)
        stream.log("world/robot/camera/image/classes", rr.SegmentationImage(frame.labels))
        stream.log("world/robot/camera/image/depth", rr.DepthImage(encode_depth(frame.depth), meter=1000.0))
        counts["keyframes"] += 1
        cells.integrate(frame, keyframe.pose, keyframe.roll, keyframe.pitch)
        if keyframe.t >= due - 1e-9:
            due = keyframe.t + MAP_EVERY_S
            iy, ix = np.nonzero(cells.target)
            places = np.stack([ix + 0.5, iy + 0.5, np.zeros(len(ix))], axis=1) * cells.cfg.cell_m
            stream.log("world/oysters", rr.Points3D(places, radii=0.02, colors=(38, 166, 76)))
            counts["maps"] += 1
    stream.flush()
    stream.disconnect()
    return counts
