"""Which kind of recording a path is."""

from __future__ import annotations

from pathlib import Path

from coral.errors import InputError
from coral.reef.recordings.bag_recording import BagTopics, read_bag
from coral.reef.recordings.log_recording import find_log, read_log_folder
from coral.reef.recordings.picture_folder import TABLE, read_folder
from coral.reef.recordings.recorded_pictures import PicturePerception
from coral.reef.recordings.recording import Recording
from coral.reef.recordings.run_recording import is_run, read_run
from coral.reef.sea.recorded_camera import read_camera
from coral.ros.bag_reader import is_bag

KINDS = "a run folder, a ROS bag, an MCAP file, or a folder of pictures with poses.csv or an autopilot's log"


def find_recording(
    path: Path,
    *,
    camera: Path | None = None,
    topics: BagTopics | None = None,
    perception: PicturePerception | None = None,
    period_s: float = 0.0,
    pictures_start_s: float | None = None,
) -> Recording:
    """Read a recording of any kind.

    A run and a bag know their camera; a folder of pictures has it in `camera.yaml` unless a file is given
    (`CameraFileCfg`). Topics are those of a bag; the other settings as for `read_bag`. `pictures_start_s` is the time
    of an autopilot's log at which the first picture was taken (s).

    Raises:
        InputError: The path is nothing of that, or something in it is missing or wrong.
    """
    given = None if camera is None else read_camera(camera)
    if not path.exists():
        raise InputError(str(path), "", "nothing", KINDS)
    log = None if is_bag(path) or is_run(path) or (path / TABLE).is_file() else find_log(path)
    if pictures_start_s is not None and log is None:
        raise InputError(
            "--pictures-start-s", "", pictures_start_s, "an autopilot's log (.tlog, .BIN) as the recording"
        )
    if is_bag(path):
        return read_bag(path, topics or BagTopics(), given, perception, period_s)
    if is_run(path):
        if given is not None:
            raise InputError("--camera", "", str(camera), "none: a run knows its camera")
        return read_run(path, perception, period_s)
    if log is None and not (path / TABLE).is_file():
        raise InputError(str(path), "", "something else", KINDS)
    folder = path if log is None else log.parent
    if given is None:
        if not (folder / "camera.yaml").is_file():
            raise InputError(str(folder), "camera.yaml", "nothing", "the camera, there or by --camera FILE.yaml")
        given = read_camera(folder / "camera.yaml")
    if log is None:
        return read_folder(path, given, perception, period_s)
    return read_log_folder(log, given, perception, period_s, pictures_start_s)
