import json

import pytest

from coral.cli import main
from coral.contact.real_scenes.masks.click_masks import read_clicks
from coral.view.click_page import ClickPage


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A picture of pick-box."""
    folder = tmp_path_factory.mktemp("recording") / "pick-box"
    words = ["contact", "track", "pick-box", "--width", "80", "--rate-hz", "1", "--export", str(folder)]
    assert main(words) == 0
    return folder


def test_the_clicks_are_written_as_masks_read_them(recording, tmp_path, capsys, monkeypatch):
    shown = []

    class Clicked(ClickPage):
        def __init__(self, *given):
            super().__init__(*given)
            shown.append((self.names, self.size, self.png[:4]))
            self.answers.put({"box": (12, 34)})

    monkeypatch.setattr("coral.view.click_page.ClickPage", Clicked)
    out = tmp_path / "new" / "clicks.yaml"
    words = ["contact", "click", "pick-box", "--camera", f"recording:{recording}", "--out", str(out), "--json"]
    assert main(words) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["objects"] == {"box": [12, 34]}
    assert "click box at http://127.0.0.1:" in said.err
    assert shown == [(("box",), (80, 60), b"\x89PNG")]
    assert read_clicks(out) == {"box": (12.0, 34.0)}
    assert main(words) == 2  # not overwritten


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--camera", "recording:none"], "a folder of recorded pictures"),
        (["--camera", "kinect"], "--camera"),
        (["--camera", "recording:none", "--port", "70000"], "--port: found 70000"),
    ],
)
def test_what_cannot_be_used_is_one_line(words, told, tmp_path, capsys):
    assert main(["contact", "click", "pick-box", "--out", str(tmp_path / "c.yaml"), *words]) == 2
    assert told in capsys.readouterr().err
