import numpy as np
import pytest

from coral.contact.real_scenes.cameras import camera_registry
from coral.contact.real_scenes.cameras.camera_registry import make_camera_by_name
from coral.errors import InputError


def test_a_word_makes_a_camera():
    assert make_camera_by_name("drawn:flip-box").newest() is not None


@pytest.mark.parametrize("word", ["bag", "bag:", "drawn", "kinect", ""])
def test_a_word_that_names_none_is_one_line(word):
    with pytest.raises(InputError, match=r"^--camera: found"):
        make_camera_by_name(word)


def test_another_package_offers_a_camera(monkeypatch):
    monkeypatch.setattr(camera_registry, "named_plugin", lambda *words: lambda rest, placed: (rest, placed))
    rest, placed = make_camera_by_name("mine:192.168.1.5", np.eye(4))
    assert rest == "192.168.1.5"
    assert placed is not None
