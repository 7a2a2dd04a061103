import cv2
import numpy as np

from coral.view.mp4 import write_mp4


def test_a_video_has_the_size_and_number_of_its_pictures(tmp_path):
    write_mp4(tmp_path / "a.mp4", (np.full((36, 50, 3), k, np.uint8) for k in (0, 80, 160)), (50, 36), 10.0)
    video = cv2.VideoCapture(str(tmp_path / "a.mp4"))
    shown = [video.read()[1] for _ in range(3)]
    assert [picture.shape for picture in shown] == [(36, 50, 3)] * 3
    assert not video.read()[0]
    assert shown[0].mean() < 20 < shown[2].mean()
