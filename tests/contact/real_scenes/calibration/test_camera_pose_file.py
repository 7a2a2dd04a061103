import pytest

from coral.contact.perception.camera import look_at
from coral.contact.real_scenes.calibration.camera_pose_file import (
    CameraCalibration,
    read_camera_pose,
    read_hand_poses,
    write_camera_pose,
)
from coral.errors import InputError

PLACED = look_at((-0.3, -0.5, 0.5), (0.1, 0.0, 0.0))


def test_a_pose_is_read_as_it_was_written(tmp_path):
    write_camera_pose(tmp_path / "camera.yaml", CameraCalibration(PLACED, {"rms_px": 0.2}), "board")
    assert read_camera_pose(tmp_path / "camera.yaml") == pytest.approx(PLACED, abs=1e-5)


def test_nothing_is_overwritten(tmp_path):
    (tmp_path / "camera.yaml").write_text("mine")
    with pytest.raises(InputError, match="a new file"):
        write_camera_pose(tmp_path / "camera.yaml", CameraCalibration(PLACED, {}), "board")
    assert (tmp_path / "camera.yaml").read_text() == "mine"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("coral-camera-pose/1", "coral-camera-pose/2", "format"),
        ("position_m", "position", "position"),
        ("quaternion:", "quaternion: [1, 1, 0, 0]\nmethod: x\n#", "of length 1"),
        ("quaternion:", "quaternion: [1, 0]\nmethod: x\n#", "quaternion"),
        ("[0, 0, 1]", f"[0, 0, {10**400}]", r"position_m\[2\]"),
    ],
)
def test_a_broken_file_names_the_field(tmp_path, old, new, told):
    path = tmp_path / "camera.yaml"
    text = "format: coral-camera-pose/1\nposition_m: [0, 0, 1]\nquaternion: [1, 0, 0, 0]\n"
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=told):
        read_camera_pose(path)


def test_poses_of_the_hand_are_read_in_their_order(tmp_path):
    path = tmp_path / "poses.yaml"
    lines = [f"- {{position: {place}, quaternion: [1, 0, 0, 0]}}" for place in ([1, 2, 3], [4, 5, 6])]
    path.write_text("\n".join(["poses:", *lines]))
    assert [pose[:3, 3].tolist() for pose in read_hand_poses(path)] == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    ("text", "told"),
    [("poses: []", "poses"), ("poses: [{position: [1, 2]}]", r"poses\[0\]\.position"), ("poses: [3]", r"poses\[0\]")],
)
def test_broken_poses_of_the_hand_name_the_field(tmp_path, text, told):
    (tmp_path / "poses.yaml").write_text(text)
    with pytest.raises(InputError, match=told):
        read_hand_poses(tmp_path / "poses.yaml")
