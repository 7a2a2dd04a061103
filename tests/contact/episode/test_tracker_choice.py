"""Episodes whose poses come over the wire, from a stand-in of a FoundationPose server that knows the truth."""

import dataclasses
import json
import re

import numpy as np
import pytest
from episodes import COARSE, make_trial, strategy
from stub_foundationpose import Oracle, serving

from coral.cli import main
from coral.commands.contact_bench import ContactBench
from coral.contact.episode.episode import Episode
from coral.contact.episode.resolution import resolve_episode
from coral.contact.perception.camera import RgbdCameraCfg, look_at
from coral.contact.perception.tracked_cfg import TrackedCfg, viewpoint
from coral.contact.scene.geometry import inverse_transform, pose_matrix, rotation_of
from coral.contact.thinker.strategist import FixedStrategist
from coral.errors import InputError
from coral.view.contact.report import write_contact_report

NOBODY = "foundationpose:http://127.0.0.1:9"
SMALL = dataclasses.replace(COARSE, poses="tracked", tracked=TrackedCfg(camera=RgbdCameraCfg(width=160, height=120)))


def served(server, cfg=SMALL):
    return resolve_episode(cfg, tracker=f"foundationpose:{server.url}")


def truthful(episode):
    """Makes the server answer with where the box truly is."""
    camera = inverse_transform(look_at(*viewpoint(episode.trial, episode.cfg.tracked)))

    def answer():
        box = episode.world.truth().objects["box"]
        return camera @ pose_matrix(rotation_of(box.quaternion), box.position)

    return answer


def episode(cfg, folder, seconds=0.2):
    return Episode(make_trial(seconds), "hand", FixedStrategist(strategy()), cfg, folder, variant="expert")


def events(folder):
    return [json.loads(line) for line in (folder / "events.jsonl").read_text().splitlines()]


def test_an_episode_on_served_poses(tmp_path, monkeypatch):
    with serving() as server:
        one = episode(served(server), tmp_path / "run")
        monkeypatch.setattr(Oracle, "answer", staticmethod(truthful(one)))
        result = one.run()
        assert len(server.sessions._open) == 0
    assert (result["end_reason"], result["poses"], result["tracker"]) == ("timeout", "tracked", "foundationpose")
    assert (result["track_lost"], result["steps"]) == (0, 10)
    assert result["pose_error_mm"] < 0.5  # what is left is the way from the picture to the planner
    assert Oracle.calls[0][0] == "register"
    assert {verb for verb, _ in Oracle.calls[1:]} == {"track"}
    assert events(tmp_path / "run")[0]["tracker"] == "foundationpose"
    assert json.loads((tmp_path / "run" / "metrics.json").read_text())["tracker"] == "foundationpose"
    page = write_contact_report(tmp_path / "run").read_text()
    assert re.search(r"tracker</\w+>\s*<\w+>foundationpose<", page)


def test_colours_are_taken_only_for_a_tracker_that_wants_them(tmp_path):
    assert episode(SMALL, tmp_path / "a").tracked._eye.colours is False
    with serving() as server:
        assert episode(served(server), tmp_path / "b").tracked._eye.colours is True


def test_the_noise_is_the_same_for_every_tracker(tmp_path):
    frames = []
    with serving() as server:
        for name, cfg in (("a", SMALL), ("b", served(server))):
            world = episode(cfg, tmp_path / name).tracked
            world._world.reset()
            frames.append(world._eye.take(world.simulation.data, np.random.default_rng(0)))
    np.testing.assert_array_equal(frames[0].depth, frames[1].depth)
    np.testing.assert_array_equal(frames[0].instance, frames[1].instance)


def test_a_server_that_dies_in_the_middle_ends_the_episode_by_name(tmp_path, monkeypatch):
    class Ends:
        def tick(self, one):
            server.shutdown()
            server.socket.close()

        def stop_requested(self):
            return ""

    with serving() as server:
        one = episode(served(server), tmp_path / "run")
        monkeypatch.setattr(Oracle, "answer", staticmethod(truthful(one)))
        result = one.run([Ends()])
    assert (result["success"], result["end_reason"]) == (False, "tracker-failed")
    assert 0 < result["steps"] < 10
    assert server.url in events(tmp_path / "run")[-1]["detail"]


def test_a_server_that_refuses_ends_the_episode_by_name(tmp_path, monkeypatch):
    def fail():
        raise RuntimeError("CUDA out of memory")

    monkeypatch.setattr(Oracle, "answer", staticmethod(fail))
    with serving() as server:
        result = episode(served(server), tmp_path / "run").run()
    assert (result["end_reason"], result["steps"]) == ("tracker-failed", 0)
    assert "CUDA out of memory" in events(tmp_path / "run")[-1]["detail"]


def test_nobody_there_is_told_before_anything_is_made(tmp_path, capsys):
    out = tmp_path / "run"
    words = ["pick-box", "--world", "hand", "--samples", "4", "--tracker", NOBODY, "--out", str(out)]
    assert main(["contact", "run", *words]) == 1
    [line] = capsys.readouterr().err.splitlines()
    assert "http://127.0.0.1:9 does not answer" in line
    assert not out.exists()
    words = ["--tasks", "pick-box", "--worlds", "hand", "--seeds", "0", "--tracker", NOBODY, "--out", str(out)]
    assert main(["contact", "bench", *words]) == 1
    [line] = capsys.readouterr().err.splitlines()
    assert "http://127.0.0.1:9 does not answer" in line
    assert not out.exists()


@pytest.mark.parametrize(
    ("flags", "named"),
    [
        (["--tracker", "magic"], "--tracker: found 'magic'"),
        (["--tracker", "foundationpose:ws://127.0.0.1:9"], "expected model or foundationpose:http://HOST:PORT"),
        (["--tracker", NOBODY, "--poses", "ground-truth"], "--poses tracked"),
        (["--tracker", NOBODY, "--variant", "no-tracking"], "also --variant no-tracking"),
        (["--tracker", NOBODY, "--policy", "ws://127.0.0.1:9"], "also --policy"),
        (["--cfg.tracked.by", "magic"], "by: found 'magic'"),
    ],
)
def test_flags_that_cannot_be_meant_are_named(flags, named, capsys):
    assert main(["contact", "run", "pick-box", "--world", "hand", *flags]) == 2
    assert named in capsys.readouterr().err


def test_the_configuration_names_the_tracker_too(tmp_path, capsys):
    file = tmp_path / "cfg.yaml"
    file.write_text("tracked: {by: 'foundationpose:http://127.0.0.1:9'}\n")
    words = ["contact", "run", "pick-box", "--world", "hand", "--config", str(file), "--out", str(tmp_path / "run")]
    assert main(words) == 1
    assert "http://127.0.0.1:9 does not answer" in capsys.readouterr().err
    file.write_text("tracked: {by: magic}\n")
    assert main(words) == 2
    assert "magic" in capsys.readouterr().err


def test_a_campaign_tells_trackers_apart_but_not_where_they_run():
    def conditions(word):
        cfg = resolve_episode(SMALL, tracker=word)
        return ContactBench()._conditions(cfg, {}, None)["configuration"]

    assert conditions(NOBODY) == conditions("foundationpose:http://elsewhere:5070")
    assert conditions(NOBODY) != conditions("model") == conditions(None)


def test_poses_of_the_simulator_need_no_tracker():
    with pytest.raises(InputError, match="--poses tracked"):
        resolve_episode(COARSE, tracker="model")
