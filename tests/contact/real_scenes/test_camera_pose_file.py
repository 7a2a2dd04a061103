import pytest

from coral.contact.perception.camera import look_at
from coral.contact.real_scenes.camera_pose_file import read_camera_pose
from coral.contact.scene.geometry import quaternion_of
from coral.errors import InputError

PLACED = look_at((-0.3, -0.5, 0.5), (0.1, 0.0, 0.0))


@pytest.mark.parametrize("more", ["", "method: board\nresiduals: {rms_px: 0.2}\n"])
def test_a_pose_is_read_with_what_was_noted_beside_it(tmp_path, more):
    path, turn = tmp_path / "camera.yaml", quaternion_of(PLACED[:3, :3]).round(6).tolist()
    path.write_text(f"format: coral-camera-pose/1\nposition_m: [-0.3, -0.5, 0.5]\nquaternion: {turn}\n{more}")
    assert read_camera_pose(path) == pytest.approx(PLACED, abs=1e-5)


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
