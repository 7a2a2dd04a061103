import json
import socket

import cv2
import pytest

from coral.cli import main
from coral.commands.contact_poses import parse_receiver
from coral.contact.franka.object_poses import ObjectPoses
from coral.errors import InputError


def test_the_objects_in_pictures_are_tracked_sent_and_drawn(tmp_path, capsys):
    receiver = ObjectPoses(("box",), "127.0.0.1", 0)
    picture = tmp_path / "p.png"
    words = ["contact", "poses", "pick-box", "--camera", "drawn:pick-box", "--pictures", "2", "--json"]
    assert main([*words, "--send", f"localhost:{receiver.port}", "--picture", str(picture)]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["pictures"] == 2
    assert result["objects"]["box"]["lost"] == 0
    receiver.update(1.0)
    assert receiver.poses["box"].position.tolist() == pytest.approx(result["objects"]["box"]["position_m"], abs=1e-4)
    assert cv2.imread(str(picture)).shape == (720, 960, 3)
    receiver.close()
    assert main([*words, "--picture", str(picture)]) == 2  # not overwritten


def test_people_read_a_line_for_each_object(capsys):
    words = ["contact", "poses", "pick-box", "--camera", "drawn:pick-box", "--pictures", "1"]
    assert main(words) == 0
    told = capsys.readouterr()
    assert "box: last at " in told.out
    assert "0.00 s: box at " in told.err


@pytest.mark.parametrize(
    "word", ["5577", "localhost:", "localhost:0", "localhost:99999", ":5577", "no such host.invalid:1"]
)
def test_a_receiver_that_is_none_is_one_line(word, monkeypatch):
    def unknown(host):
        raise socket.gaierror(-2, "Name or service not known")

    monkeypatch.setattr(socket, "gethostbyname", unknown)
    with pytest.raises(InputError, match="--send"):
        parse_receiver(word)
