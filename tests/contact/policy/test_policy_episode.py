import dataclasses
import json
import re

import mujoco
import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml

from config_reads import watched
from coral.cli import _parse, main
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.policy_cfg import LiberoCfg, PolicyCfg
from coral.contact.episode.trial_log import END_REASONS
from coral.contact.policy.address import Address
from coral.contact.policy.client import PolicyError
from coral.contact.policy.policy_episode import PolicyCameras, PolicyEpisode, wrist_pose
from coral.contact.scene.observation import BodyState
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.hand_world import HandWorld
from coral.contact.worlds.robot_world import WorldError
from coral.errors import InputError

CFG = EpisodeCfg(policy=PolicyCfg(libero=LiberoCfg(pixels=16)))
DOWN = np.array([0.0, 1.0, 0.0, 0.0])
SMALL = 48
SCENE = """
<mujoco><worldbody>
  <geom name="table" type="box" size="0.5 0.5 0.05" pos="0 0 -0.05" rgba="1 1 1 1"/>
  <geom name="left" type="sphere" size="0.04" pos="0 0.15 0.04" rgba="1 0 0 1"/>
  <body><geom name="cover" type="sphere" size="0.05" pos="0 -0.15 0.04" rgba="0 1 0 1"/>
    <geom name="pretty" type="sphere" size="0.04" pos="0 -0.15 0.04" rgba="0 0 1 1" group="1"/></body>
</worldbody></mujoco>"""


class Scripted:
    """A policy that is a function of what it is shown."""

    def __init__(self, answer):
        self.answer, self.asked, self.metadata = answer, [], {"who": "a script"}

    def infer(self, observation):
        self.asked.append(observation)
        return {"actions": self.answer(observation)}


def steady(*action, n=10):
    return Scripted(lambda seen: np.tile(np.array(action, float), (n, 1)))


@pytest.fixture
def episode(tmp_path):
    def make(policy, seconds=0.5, cfg=CFG, task="pick-box", seed=0, folder="run"):
        held = load_task(task)
        square = tuple(item.model_copy(update={"yaw_deg": (0.0, 0.0)}) for item in held.objects)
        held = held.model_copy(update={"time_limit_s": seconds, "objects": square})
        return PolicyEpisode(
            sample_trial(held, seed), "hand", policy, cfg, tmp_path / folder, Address("script", "ws://here:1")
        )

    return make


def events(episode, name):
    lines = [json.loads(line) for line in (episode.writer.folder / "events.jsonl").read_text().splitlines()]
    return [line for line in lines if line["event"] == name]


def pick(trial):
    """Straight to the box, down, close, up: what a perfect policy would answer, from the state alone."""
    box = trial.objects["box"].pose.position + LiberoCfg().origin_m
    closing = []

    def answer(seen):
        state = seen["observation/state"]
        error = box - state[:3]
        over = np.linalg.norm(error[:2]) < 0.01
        near = over and abs(error[2]) < 0.015
        if near or closing:
            closing.append(1)
        goal = error * [1, 1, 1.0 if over else 0.0]
        if len(closing) > 5:
            goal = np.array([0, 0, 0.13 + (box[2] - state[2])])
        return np.tile([*np.clip(goal / 0.05 * 0.7, -1, 1), 0, 0, 0, 1.0 if closing else -1.0], (10, 1))

    return answer


def test_a_policy_that_knows_how_picks_the_box(episode):
    one = episode(Scripted(lambda seen: answer(seen)), seconds=15.0)
    answer = pick(one.trial)
    result = one.run()
    assert (result["success"], result["end_reason"], result["strategy"]) == (True, "success", "script")
    assert result["policy_calls"] == len(one.policy.asked) > 3
    assert (result["plans"], result["poses"]) == (0, "pictures")


def test_the_observation_is_that_of_libero(episode):
    policy = steady(0, 0, 0, 0, 0, 0, -1)
    episode(policy, seconds=0.3).run()
    seen = policy.asked[0]
    assert set(seen) == {"observation/image", "observation/wrist_image", "observation/state", "prompt"}
    assert seen["observation/image"].shape == seen["observation/wrist_image"].shape == (16, 16, 3)
    np.testing.assert_allclose(seen["observation/state"], [-0.26, 0, 1.15, np.pi, 0, 0, 0.04, -0.04], atol=1e-6)
    assert seen["prompt"] == load_task("pick-box").instruction


@pytest.mark.parametrize(("execute", "n", "calls"), [(5, 10, 2), (2, 10, 5), (5, 1, 10), (10, 10, 1)])
def test_so_many_actions_of_a_chunk_are_taken_at_the_policys_rate(episode, execute, n, calls):
    cfg = dataclasses.replace(CFG, policy=dataclasses.replace(CFG.policy, libero=LiberoCfg(pixels=16, execute=execute)))
    policy = steady(0, 0, 0, 0, 0, 0, -1, n=n)
    result = episode(policy, cfg=cfg).run()
    assert (result["end_reason"], result["sim_time_s"], result["steps"]) == ("timeout", 0.5, 50)
    assert len(policy.asked) == result["policy_calls"] == calls


def test_a_step_moves_the_hand_the_way_it_says(episode):
    one = episode(steady(0.5, 0, 0.2, 0, 0, 0, -1))
    one.run()
    moved = one.now.tool.position - [-0.1, 0, 0.25]
    assert moved[0] > 0.05
    assert abs(moved[1]) < 0.002
    assert moved[2] / moved[0] == pytest.approx(0.4, abs=0.05)


def test_wild_actions_stay_within_force_and_workspace(episode, monkeypatch):
    commands = []
    step = HandWorld.step
    monkeypatch.setattr(
        HandWorld, "step", lambda world, target: commands.append((target, world._observe().tool)) or step(world, target)
    )
    one = episode(steady(1e6, -1e6, -1e6, 0, 0, 0, 1), seconds=1.5)
    one.run()
    low, high = CFG.controller.workspace_low_m, CFG.controller.workspace_high_m
    for target, tool in commands:
        assert np.linalg.norm(target.position - tool.position) * target.stiffness <= CFG.reactive.force_limit_n + 1e-6
        assert (target.position >= np.array(low) - 1e-9).all()
        assert (target.position <= np.array(high) + 1e-9).all()


@pytest.mark.parametrize("code", ["silence", "bad-message", "error"])
def test_a_failure_of_the_policy_ends_the_episode_with_its_name(episode, code):
    class Failing(Scripted):
        def infer(self, observation):
            if len(self.asked) == 2:
                raise PolicyError(code, "it broke")
            return super().infer(observation)

    one = episode(Failing(lambda seen: np.zeros((10, 7))), seconds=5.0)
    result = one.run()
    assert (result["success"], result["end_reason"], result["policy_calls"]) == (False, f"policy: {code}", 2)
    assert events(one, "end")[0]["detail"] == "it broke"
    assert "policy" in END_REASONS


@pytest.mark.parametrize(
    ("actions", "reason"),
    [(np.zeros((10, 8)), "policy: bad-actions"), (np.full((10, 7), np.nan), "policy: not-finite")],
)
def test_actions_that_are_none_end_the_episode_before_a_step(episode, actions, reason):
    result = episode(Scripted(lambda seen: actions)).run()
    assert (result["end_reason"], result["steps"], result["success"]) == (reason, 0, False)


def test_a_fault_of_the_world_is_named(episode, monkeypatch):
    def broken(world, target):
        raise WorldError("diverged", "it flew away")

    monkeypatch.setattr(HandWorld, "step", broken)
    result = episode(steady(0, 0, 0, 0, 0, 0, 0)).run()
    assert (result["end_reason"], result["steps"]) == ("diverged", 0)


def test_an_interrupt_leaves_a_readable_run(episode):
    def interrupt(seen):
        raise KeyboardInterrupt

    one = episode(Scripted(interrupt))
    assert one.run()["end_reason"] == "stopped by the operator"
    assert (one.writer.folder / "metrics.json").is_file()


def test_the_same_answers_give_the_same_files(episode):
    for folder in ("a", "b"):
        episode(steady(0.3, 0.1, -0.4, 0, 0, 0.2, 1), folder=folder).run()
    one = episode(steady(), folder="c").writer.folder.parent
    for name in ("metrics.json", "events.jsonl", "trajectory.csv", "states.csv", "seen.png"):
        assert (one / "a" / name).read_bytes() == (one / "b" / name).read_bytes()


def test_a_world_that_ticks_too_fast_is_refused(episode):
    cfg = dataclasses.replace(
        CFG, policy=dataclasses.replace(CFG.policy, libero=LiberoCfg(pixels=16, rate_hz=200, ticks=5))
    )
    with pytest.raises(InputError, match=r"policy\.libero\.ticks"):
        episode(steady(), cfg=cfg)


# The commands, through a real server.

TINY = ["--quiet", "--cfg.policy.libero.pixels", "16", "--cfg.policy.client.wait-s", "0"]


@pytest.fixture(scope="module")
def task(tmp_path_factory):
    path = tmp_path_factory.mktemp("task") / "short.yaml"
    content = load_task("pick-box").model_copy(update={"time_limit_s": 0.5}).model_dump(mode="json")
    path.write_text(yaml.safe_dump(content))
    return str(path)


def test_the_command_runs_a_served_policy_and_makes_its_report(serve, task, tmp_path, capsys):
    server = serve(greeting={"model": "fake"})
    folder = tmp_path / "run"
    words = ["contact", "run", task, "--world", "hand", "--policy", f"pi05={server.url}", "--out", str(folder)]
    assert main([*words, "--json", *TINY]) == 0
    result = json.loads(capsys.readouterr().out)
    assert (result["end_reason"], result["policy_calls"], result["strategy"]) == ("timeout", 2, "pi05")
    assert {path.name for path in folder.iterdir()} == {
        "config.yaml",
        "task.yaml",
        "events.jsonl",
        "trajectory.csv",
        "states.csv",
        "metrics.json",
        "timing.json",
        "report.html",
        "keyframes.png",
        "seen.png",
    }
    config = yaml.safe_load((folder / "config.yaml").read_text())
    assert (config["variant"], config["policy"], config["server"]) == ("pi05", server.url, "{'model': 'fake'}")
    assert main([*words[:-1], str(tmp_path / "other"), *TINY]) == 0
    assert "2 answers of" in capsys.readouterr().out


def test_of_the_planner_a_policy_reads_the_workspace_alone(serve, task, tmp_path):
    words = ["--world", "hand", "--policy", serve().url, "--out", str(tmp_path / "run"), *TINY]
    command = _parse("contact run", [task, *words])
    with watched(command.cfg) as reads:
        command()
    groups = ("planning.", "controller.", "tracked.", "sight.")
    read = {key for key in reads.by_key if key.startswith(groups)}
    assert read == {"controller.workspace_low_m", "controller.workspace_high_m"}


def test_no_server_is_one_line_and_no_folder(task, tmp_path, capsys):
    words = ["contact", "run", task, "--world", "hand", "--policy", "ws://127.0.0.1:1", "--out", str(tmp_path / "run")]
    assert main([*words, *TINY]) == 1
    error = capsys.readouterr().err
    assert "no policy: unreachable" in error
    assert error.count("\n") == 1
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--policy", "localhost:8000"], "ws://HOST:PORT"),
        (["--policy", "expert=ws://localhost:8000"], "a name that no variant has"),
        (["--policy", "ws://localhost:8000", "--variant", "expert"], "one of the two"),
    ],
)
def test_a_bad_policy_flag_is_bad_input(task, words, said, capsys):
    assert main(["contact", "run", task, "--world", "hand", "--quiet", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_bench_tabulates_a_policy_in_the_papers_row(serve, task, tmp_path, capsys):
    server = serve()
    out = tmp_path / "bench"
    words = ["contact", "bench", "--tasks", task, "--worlds", "hand", "--seeds", "0-1", "--out", str(out)]
    assert main([*words, "--variants", "none", "--policies", f"pi05={server.url}", "--json", *TINY]) == 0
    assert json.loads(capsys.readouterr().out)["done"] == 2
    assert re.search(r"pi-0\.5 +\| +0/2 ", (out / "tables.md").read_text())
    assert [row["end_reason"] for row in pq.read_table(out / "results.parquet").to_pylist()] == ["timeout"] * 2


@pytest.mark.slow
def test_bench_does_not_count_an_outage_against_the_policy(serve, task, tmp_path):
    server = serve(lambda k, seen: ConnectionError if k in (2, 3, 4) else {"actions": np.zeros((10, 7))})
    out = tmp_path / "bench"
    words = ["contact", "bench", "--tasks", task, "--worlds", "hand", "--seeds", "0-1", "--out", str(out), *TINY]
    assert main([*words, "--variants", "none", "--policies", f"pi05={server.url}"]) == 0
    rows = pq.read_table(out / "results.parquet").to_pylist()
    assert sorted(row["status"] for row in rows) == ["done", "failed"]


@pytest.fixture(scope="module")
def scene():
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def look(scene, pixels, tool=(0.0, 0.0, 0.3)):
    return PolicyCameras(scene[0], pixels).look(scene[1], BodyState(np.array(tool), DOWN))


def columns(picture, channel):
    """Mean column of what has mostly this colour, as a share of the width; None when nothing has."""
    others = [k for k in range(3) if k != channel]
    seen = picture[..., channel] > 2.0 * picture[..., others].max(axis=-1)
    return None if not seen.any() else float(np.flatnonzero(seen.any(axis=0)).mean() / picture.shape[1])


def test_pictures_have_the_shape_and_type_that_policies_take(scene):
    for picture in look(scene, SMALL):
        assert (picture.shape, picture.dtype, picture.flags.c_contiguous) == ((48, 48, 3), np.uint8, True)


def test_the_outer_camera_faces_the_robot_and_mirrors(scene):
    """It looks along -x, so that +y is on its right, and in the mirrored picture on the left."""
    assert columns(look(scene, SMALL)[0], 0) < 0.5


def test_collision_shapes_do_not_cover_pretty_ones(scene):
    outside, _ = look(scene, SMALL)
    assert columns(outside, 1) is None
    assert columns(outside, 2) is not None


def test_the_wrist_camera_looks_out_of_the_palm_and_moves_with_the_hand(scene):
    _, here = look(scene, SMALL)
    _, aside = look(scene, SMALL, (-0.05, 0.15, 0.3))  # the camera is 5 cm ahead: straight above the red ball
    assert columns(aside, 0) == pytest.approx(0.5, abs=0.05)
    assert abs(columns(here, 0) - 0.5) > 0.15


def test_the_wrist_camera_is_robosuites():
    """Its place on the Panda's hand: 5 cm along x, at the flange; its top towards the hand's x."""
    pose = wrist_pose(BodyState(np.zeros(3), np.array([1.0, 0, 0, 0])))
    np.testing.assert_allclose(pose[:3, 3], [0.05, 0, -0.097])
    np.testing.assert_allclose(pose[:3, 1], [-1, 0, 0])  # down in the picture
    np.testing.assert_allclose(pose[:3, 2], [0, 0, 1])
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)
