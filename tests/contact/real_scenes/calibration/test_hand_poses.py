import pytest

from coral.contact.real_scenes.calibration.hand_poses import read_hand_poses
from coral.errors import InputError


def test_poses_are_read_in_their_order(tmp_path):
    path = tmp_path / "poses.yaml"
    lines = [f"- {{position: {place}, quaternion: [1, 0, 0, 0]}}" for place in ([1, 2, 3], [4, 5, 6])]
    path.write_text("\n".join(["poses:", *lines]))
    assert [pose[:3, 3].tolist() for pose in read_hand_poses(path)] == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    ("text", "told"),
    [("poses: []", "poses"), ("poses: [{position: [1, 2]}]", r"poses\[0\]\.position"), ("poses: [3]", r"poses\[0\]")],
)
def test_a_broken_file_names_the_field(tmp_path, text, told):
    (tmp_path / "poses.yaml").write_text(text)
    with pytest.raises(InputError, match=told):
        read_hand_poses(tmp_path / "poses.yaml")
