import numpy as np
import pytest

from coral.contact.perception.camera import RgbdFrame, look_at
from coral.contact.real_scenes.calibration.touch_calibration import (
    Touch,
    align_points,
    calibrate_by_touch,
    read_touches,
)
from coral.contact.scene.geometry import rotation_from_vector
from coral.contact.scene.rigid_transform import inverse_transform, pose_matrix
from coral.errors import InputError

LENS = np.array([300.0, 300.0, 159.5, 119.5])
PLACED = look_at((-0.3, -0.6, 0.5), (0.05, 0.0, 0.0))
POINTS = np.array([[0.0, 0.0, 0.0], [0.2, 0.0, 0.05], [0.0, 0.15, 0.0], [0.15, 0.15, 0.1], [-0.1, 0.1, 0.03]])


def clicked():
    """A picture with depth around the points, and the points as they would be clicked: whole pixels."""
    camera = inverse_transform(PLACED)
    seen = POINTS @ camera[:3, :3].T + camera[:3, 3]
    pixels = np.rint(LENS[2:] + LENS[:2] * seen[:, :2] / seen[:, 2:])
    depth = np.zeros((240, 320), np.float32)
    for (column, row), z in zip(pixels.astype(int), seen[:, 2], strict=True):
        depth[row - 2 : row + 3, column - 2 : column + 3] = z
    frame = RgbdFrame(depth, np.zeros(depth.shape, np.uint8), (), LENS, np.eye(4))
    return frame, [Touch(pixel=p, touched_m=m) for p, m in zip(pixels.tolist(), POINTS.tolist(), strict=True)]


def test_points_are_aligned_exactly():
    pose = pose_matrix(rotation_from_vector([0.3, -2.0, 1.0]), [1.0, 2.0, 3.0])
    assert align_points(POINTS, POINTS @ pose[:3, :3].T + pose[:3, 3]) == pytest.approx(pose)


def test_a_plane_of_points_is_not_mirrored():
    flat = POINTS * [1, 1, 0]
    assert np.linalg.det(align_points(flat, flat)[:3, :3]) == pytest.approx(1.0)


def test_touched_points_tell_where_the_camera_stands():
    found = calibrate_by_touch(*clicked(), "touches.yaml")
    assert np.linalg.norm(found.T_world_camera[:3, 3] - PLACED[:3, 3]) < 0.01  # clicks are whole pixels
    assert found.residuals["largest_mm"] < 3.0


def test_a_wrong_correspondence_is_named():
    frame, touches = clicked()
    touches[2] = touches[2].model_copy(update={"touched_m": (0.0, 0.1, 0.0)})
    with pytest.raises(InputError, match=r"touches\.yaml: touches\[2\]: .* without it the others agree"):
        calibrate_by_touch(frame, touches, "touches.yaml")


def test_two_swapped_points_are_refused():
    frame, touches = clicked()
    a, b = touches[0], touches[3]
    touches[0], touches[3] = (
        Touch(pixel=a.pixel, touched_m=b.touched_m),
        Touch(pixel=b.pixel, touched_m=a.touched_m),
    )
    with pytest.raises(InputError, match=r"touches: found a residual of .* mm"):
        calibrate_by_touch(frame, touches, "touches.yaml")


def test_points_on_a_line_are_refused():
    frame, touches = clicked()
    line = [Touch(pixel=touch.pixel, touched_m=(0.1 * k, 0.0, 0.0)) for k, touch in enumerate(touches)]
    with pytest.raises(InputError, match="of a line"):
        calibrate_by_touch(frame, line, "touches.yaml")


@pytest.mark.parametrize(("pixel", "told"), [((400.0, 3.0), "a pixel of 320 x 240"), ((5.0, 5.0), "no depth")])
def test_a_pixel_without_depth_is_named(pixel, told):
    frame, touches = clicked()
    touches[1] = touches[1].model_copy(update={"pixel": pixel})
    with pytest.raises(InputError, match=rf"touches\[1\]\.pixel.*{told}"):
        calibrate_by_touch(frame, touches, "t.yaml")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("touches: []", "at least 4"),
        ("touches: 3", "a list"),
        ("touches: [1, 2, 3, 4]", r"touches\[0\]: .* keys pixel, touched_m"),
        ("touches: [{pixel: [1, 2], touched_m: [1, 2]}, 2, 3, 4]", r"touches\[0\]\.touched_m"),
        (f"touches: [{{pixel: [1, {10**400}], touched_m: [1, 2, 3]}}, 2, 3, 4]", r"touches\[0\]\.pixel"),
    ],
)
def test_a_broken_file_names_the_field(tmp_path, text, told):
    (tmp_path / "t.yaml").write_text(text)
    with pytest.raises(InputError, match=told):
        read_touches(tmp_path / "t.yaml")


def test_a_file_is_read(tmp_path):
    (tmp_path / "t.yaml").write_text("touches:\n" + "- {pixel: [1, 2], touched_m: [0.1, 0.2, 0.3]}\n" * 4)
    assert read_touches(tmp_path / "t.yaml")[3] == Touch(pixel=(1, 2), touched_m=(0.1, 0.2, 0.3))
