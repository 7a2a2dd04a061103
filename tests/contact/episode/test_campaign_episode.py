"""An episode of a campaign: its metrics, its memory, and what is no result."""

import dataclasses
import json

import numpy as np
import pytest
from episodes import COARSE, ObedientWorld, short_task
from experiences import experience
from stub_foundationpose import Oracle, serving

from coral.contact.episode import episode as module
from coral.contact.episode.campaign_episode import run_episode
from coral.contact.episode.resolution import resolve_episode
from coral.contact.memory.memory import Experience, Memory
from coral.contact.perception.camera import RgbdCameraCfg
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.scene.observation import BodyState
from coral.contact.worlds.hand_world import HandWorld
from coral.errors import RunError

pytestmark = pytest.mark.wing("coral.contact.experts")

EXPERT = {"world": "hand", "variant": "expert", "advisor": "none", "seed": 0}
FULL = {"world": "hand", "variant": "full", "advisor": "recorded", "seed": 0}


def test_the_result_is_that_of_the_run_folder_and_says_where_it_took_place(tmp_path):
    result = run_episode(short_task(), COARSE, tmp_path / "run", **EXPERT)
    written = {}
    for name in ("metrics", "timing"):
        written |= json.loads((tmp_path / "run" / f"{name}.json").read_text())
    about = {"evaluation_world": "hand", "fallback": COARSE.think.fallback, "memory_known": None}
    assert result == written | about
    assert result["end_reason"] == "timeout"
    assert not (tmp_path / "run" / "report.html").exists()
    assert not list((tmp_path / "run").glob("*.mp4"))


def test_the_same_arguments_give_the_same_episode_and_another_seed_another(tmp_path):
    for name, seed in (("a", 0), ("b", 0), ("c", 1)):
        run_episode(short_task(), COARSE, tmp_path / name, **{**EXPERT, "seed": seed})
    logs = [(tmp_path / name / "states.csv").read_bytes() for name in "abc"]
    assert logs[0] == logs[1] != logs[2]


def test_an_interrupted_episode_is_no_result(tmp_path, monkeypatch):
    def interrupt(world, target):
        raise KeyboardInterrupt

    monkeypatch.setattr(HandWorld, "step", interrupt)
    with pytest.raises(RunError, match="stopped by"):
        run_episode(short_task(), COARSE, tmp_path / "run", **EXPERT)


def test_a_failed_tracker_is_no_result(tmp_path, monkeypatch):
    monkeypatch.setattr(Oracle, "answer", np.zeros((4, 4)))
    small = dataclasses.replace(
        COARSE, poses="tracked", tracked=TrackedCfg(camera=RgbdCameraCfg(width=160, height=120))
    )
    with serving() as server, pytest.raises(RunError, match=r"^tracker-failed: .*no pose"):
        run_episode(
            short_task(), resolve_episode(small, tracker=f"foundationpose:{server.url}"), tmp_path / "run", **EXPERT
        )


@pytest.fixture
def practice(scene):
    """What a memory holds: one experience of another task."""
    return [experience(scene("flip-box"), run="practice")]


def succeeding(monkeypatch, after):
    """Lets the box rise into the hand after so many steps, whatever the hand does; after 0, never."""

    def script(k, box):
        return BodyState(box.position + np.array([0.0, 0.0, 0.12]), box.quaternion) if after and k >= after else box

    monkeypatch.setattr(module, "make_world", lambda name, trial, period: ObedientWorld(trial, script))


def test_a_success_is_remembered_beside_what_the_trial_began_with(practice, tmp_path, monkeypatch):
    succeeding(monkeypatch, after=5)
    result = run_episode(short_task(2.0), COARSE, tmp_path / "run", memory=practice, **FULL)
    assert (result["success"], result["memory_known"]) == (True, 1)
    kept = Memory(tmp_path / "run" / "remembered.sqlite").all()
    assert [one.experience.provenance["run"] for one in kept] == ["run"]


def test_a_success_is_remembered_beside_an_experience_that_cannot_be_read_again(practice, tmp_path, monkeypatch):
    succeeding(monkeypatch, after=5)
    text = practice[0].model_dump_json().replace('"stiffness":600.0', '"stiffness":NaN', 1)
    odd = Experience.model_validate_json(text)  # as a foreign file may hold it
    assert odd != practice[0]
    result = run_episode(short_task(2.0), COARSE, tmp_path / "run", memory=[odd, *practice], **FULL)
    assert (result["success"], result["memory_known"]) == (True, 1)
    assert len(Memory(tmp_path / "run" / "remembered.sqlite").all()) == 1


def test_a_failure_leaves_nothing_to_remember(practice, tmp_path, monkeypatch):
    succeeding(monkeypatch, after=0)
    result = run_episode(short_task(), COARSE, tmp_path / "run", memory=practice, **FULL)
    assert (result["success"], result["memory_known"]) == (False, 1)
    assert not (tmp_path / "run" / "remembered.sqlite").exists()


def test_a_variant_without_memory_begins_with_none_whatever_it_is_given(practice, tmp_path, monkeypatch):
    succeeding(monkeypatch, after=5)
    result = run_episode(short_task(2.0), COARSE, tmp_path / "run", memory=practice, **{**FULL, "variant": "no-memory"})
    assert (result["success"], result["memory_known"], result["memory_hit"]) == (True, None, False)
    assert not (tmp_path / "run" / "remembered.sqlite").exists()
