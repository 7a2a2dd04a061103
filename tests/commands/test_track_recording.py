"""`coral contact track FOLDER`."""

import json
import shutil

import pytest

from coral.cli import main


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recorded") / "scene"
    words = ["--width", "160", "--rate-hz", "1", "--export", str(folder)]
    assert main(["contact", "track", "flip-box", *words]) == 0
    return folder


def test_a_recorded_scene_gives_the_errors_of_its_motion(recorded, tmp_path, capsys):
    results = tmp_path / "results.csv"
    capsys.readouterr()
    assert main(["contact", "track", str(recorded), "--results", str(results), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["tracked"] == found["lost"] == []
    fresh, followed = found["recorded"]
    assert (fresh["followed"], followed["followed"]) == (False, True)
    assert fresh["poses"] == followed["poses"] + 1 == len(results.read_text().splitlines()) - 1
    assert fresh["mm"] < 5
    assert fresh["add_recall"] == 1.0
    assert main(["contact", "track", str(recorded), "--every", "3"]) == 0
    text = capsys.readouterr().out
    assert "followed" not in text.replace("followed from", "")


def test_a_scene_without_depth_is_named(recorded, tmp_path, capsys):
    scene = tmp_path / "scene"
    shutil.copytree(recorded, scene)
    shutil.rmtree(scene / "depth")
    assert main(["contact", "track", str(scene)]) == 2
    assert "pictures of depth" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("flags", "named"),
    [
        (["flip-box", "--results", "poses.csv"], "--results"),
        (["--every", "0"], "--every"),
        (["--export", "folder"], "--export"),
        (["{scene}", "--export", "folder"], "--export"),
        (["flip-box", "--export", "{scene}"], "new or empty"),
        (["{scene}", "--results", "{scene}/scene_gt.json"], "a new file"),
        (["{scene}/depth"], "scene_gt.json"),
    ],
)
def test_bad_flags_of_recordings_are_named(flags, named, recorded, capsys):
    assert main(["contact", "track", *(flag.format(scene=recorded) for flag in flags)]) == 2
    assert named in capsys.readouterr().err
