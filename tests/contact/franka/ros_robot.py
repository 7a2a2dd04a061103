"""The robot of `arm_node.py` beside its truth, and attempts of tasks with it over real DDS.

Usage: python ros_robot.py TASK SEEDS [SPEED], such as: python ros_robot.py pick-box 0-9 0.25
"""

import subprocess
import sys
import tempfile
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from coral.campaign.spec import parse_seeds
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.resolution import resolve_episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.franka.double import Double, cfg_for_double
from coral.contact.franka.ros_arm import RosArm
from coral.contact.franka.stream_process import StreamProcess
from coral.contact.franka.world import FrankaDoubleWorld
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task

NAMESPACE = "/robot"


@contextmanager
def robot(trial, arm, speed):
    """Start simulated arm and node, each in a process of its own; yield the arm, for its truth, and the node."""
    double = Double(trial, arm, speed)
    command = [sys.executable, str(Path(__file__).with_name("arm_node.py")), double.address, NAMESPACE]
    node = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        double.send_poses_to("127.0.0.1", int(node.stdout.readline()))
        yield double, node
    finally:
        node.kill()
        node.wait()
        double.close()


@contextmanager
def world_over_ros(trial, arm, speed, step_s=0.02):
    """Yield a world behind ROS 2, and the node that plays the robot."""
    with robot(trial, arm, speed) as (double, node):
        stream = StreamProcess(partial(RosArm, objects=tuple(trial.objects)), f"ros2:{NAMESPACE}", arm, trial)
        world = FrankaDoubleWorld(stream, arm, step_s, list(trial.objects), double=double)
        try:
            yield world, node
        finally:
            world.close()


def attempt(name, seed, speed=0.25, samples=40):
    """Attempt a task, judged by the truth, which is on no topic; a plan takes 0.05 s by the arm's clock."""
    task = load_task(name)
    trial = sample_trial(task, seed, name)
    cfg = resolve_episode(EpisodeCfg(), samples=samples, poses=None, tracker=None, fallback=None)
    arm = cfg_for_double(replace(cfg.franka, poses_port=0), silence_s=6.0)  # a busy machine compiles for seconds
    cfg = replace(cfg, franka=arm, planning=replace(cfg.planning, latency="fixed:0.05"))
    cfg = replace(cfg, record=replace(cfg.record, report=False))
    with tempfile.TemporaryDirectory() as folder, world_over_ros(trial, arm, speed, cfg.planning.step_s) as (world, _):
        setup = AdvisorSetup(advisor="none", seed=seed, world="franka", folder=Path(folder), think=cfg.think)
        strategist = make_strategist("expert-fsm", task, setup)
        result = Episode(trial, world, strategist, cfg, Path(folder) / "run", variant="expert-fsm").run()
    told = {
        key: result.get(key)
        for key in ("success", "end_reason", "end_detail", "sim_time_s", "wall_time_s", "peak_hand_force_n")
    }
    return {"task": name, "seed": seed, **told}


def main():
    name, seeds, *speed = sys.argv[1:]
    for seed in parse_seeds(seeds):
        print(attempt(name, seed, *map(float, speed)), flush=True)


if __name__ == "__main__":
    main()
