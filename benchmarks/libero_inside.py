r"""Success inside LIBERO's own environment: its simulation, its OSC_POSE controller at 20 Hz, its success test.

    python -m venv ENV && ENV/bin/pip install robosuite==1.4.0 mujoco==2.3.7 numpy==1.26.4 bddl==1.0.1 easydict \
        'opencv-python-headless<4.12' future cloudpickle gymnasium termcolor pyyaml matplotlib
    python benchmarks/libero_inside.py --python ENV/bin/python --states 0,10,20,30,40 --out inside

`benchmarks/peers/libero_env.py` runs in ENV and steps the environment. The expert's state machine plans here, with the
time of planning charged. Object poses are tracked in depth pictures that LIBERO's renderer takes with its "agentview"
camera, with the noise of our simulated camera added; masks are the renderer's. The basket's place is that of the
initial state. Shapes are those of our tasks: simplified collision boxes, not LIBERO's meshes. A line of JSON for each
trial is appended to OUT/trials.jsonl; a second call goes on where the first one stopped, and prints the tables.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import mujoco
import numpy as np
from libero import TASKS, cleared, print_tables, run_missing  # benchmarks/libero.py

from coral.contact.control.hand_model import HandCfg
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.resolution import with_samples
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.libero.package import SUITES, Package, find_package
from coral.contact.libero.task import SHIFT_M
from coral.contact.perception.camera import RgbdFrame
from coral.contact.perception.depth_noise import DepthNoise
from coral.contact.perception.tracked_cfg import TrackedCfg
from coral.contact.perception.tracked_world import TrackedWorld
from coral.contact.scene.geometry import conjugate, multiply, quaternion_of, to_rotvec
from coral.contact.scene.mujoco_scene import add_scene
from coral.contact.scene.observation import Array, BodyState, HandTarget, Observation, Truth
from coral.contact.scene.rigid_transform import pose_matrix
from coral.contact.scene.trial import Trial, sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.think_cfg import resolved
from coral.contact.worlds.evaluation_world import Simulation, WorldError
from coral.contact.worlds.panda.names import PAD_OVERLAP_M, TOOL_IN_SITE

PERIOD_S = 0.05
WAIT_STEPS = 10
"""Steps without motion before a trial begins, as in published evaluations: the objects settle."""
PUBLISHED_STEPS = 280
"""Steps after which published evaluations of LIBERO-OBJECT end a trial."""
LIMIT_S = 20.0
"""Our limit, 400 steps; successes within the published one are counted apart."""
KP = 150.0
"""OSC_POSE's gain (1/s^2): the hand's acceleration for each metre or radian to its goal."""
STEP_M, STEP_RAD = 0.05, 0.5
"""Displacement for an action of 1."""
OPENING_STEP_M, OPEN_M = 0.01, 0.08
SHIFT = np.array([*SHIFT_M, 0.0])


class Link:
    """Talks to `peers/libero_env.py` in LIBERO's environment."""

    def __init__(self, python: Path, package: Package) -> None:
        program = Path(__file__).parent / "peers" / "libero_env.py"
        self._process = subprocess.Popen(
            [str(python), "-W", "ignore", str(program)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": str(package.root)},
        )

    def ask(self, do: str, **fields: Any) -> dict[str, Any]:
        """Send a request and return the answer.

        Raises:
            WorldError: The program has ended ("link-lost").
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps({"do": do, **fields}).encode() + b"\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except BrokenPipeError:
            line = b""
        if not line:
            raise WorldError("link-lost", "LIBERO's environment has ended")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def read(self, count: int) -> bytes:
        """Read bytes that follow an answer."""
        assert self._process.stdout is not None
        return self._process.stdout.read(count)

    def close(self) -> None:
        """End the program."""
        self._process.kill()
        self._process.wait()


class LiberoCamera:
    """Takes depth pictures with LIBERO's renderer."""

    def __init__(self, link: Link, about: dict[str, Any], names: dict[str, str]) -> None:
        self._link, self._noise = link, DepthNoise()
        self._lens = np.array(about["lens"])
        self._pose = pose_matrix(np.array(about["axes"]), np.array(about["position"]) + SHIFT)
        self._names = tuple(names.get(name, name) for name in about["names"])

    def take(self, data: mujoco.MjData, rng: np.random.Generator) -> RgbdFrame:
        """See `PictureSource.take`; LIBERO's state is drawn, not `data`."""
        height, width = self._link.ask("picture")["shape"]
        depth = np.frombuffer(self._link.read(4 * height * width), np.float32).reshape(height, width)
        labels = np.frombuffer(self._link.read(height * width), np.uint8).reshape(height, width)
        exact = depth.astype(float)
        noisy, labels = self._noise.apply(exact, _normals(exact, self._lens), labels, self._lens, rng)
        measured = np.where(np.isfinite(noisy), noisy, 0.0).astype(np.float32)
        return RgbdFrame(measured, labels, self._names, self._lens, self._pose.copy(), float(data.time))


def _normals(depth: Array, lens: Array) -> Array:
    """Compute unit normals towards the camera from a depth picture. Shape=(H, W, 3)."""
    fx, fy, cx, cy = lens
    v, u = np.indices(depth.shape)
    points = np.stack([(u - cx) / fx, (v - cy) / fy, np.ones(depth.shape)], axis=-1) * depth[..., None]
    normal = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    return np.asarray(normal * -np.sign((normal * points).sum(axis=-1, keepdims=True)))


class LiberoScene:
    """LIBERO's environment behind the interface of an evaluation world."""

    name, control_period_s = "libero", PERIOD_S

    def __init__(self, link: Link, trial: Trial, package: Package, task: str, state: int) -> None:
        self._link, self._hand = link, HandCfg()
        self._state = link.ask(
            "make",
            problem=str(package.problem(task)),
            states=str(package.states(task)),
            state=state,
            wait=WAIT_STEPS,
        )
        self._names = {name: name.rsplit("_", 1)[0] for name in self._state["objects"]}
        self.camera = LiberoCamera(link, self._state["camera"], self._names)
        self._objects = set(trial.objects)
        # At rest the wrist carries the hand's weight alone.
        self._weight = np.array(self._state["force"])
        self._before = np.array(self._state["velocity"])
        self._opening = OPEN_M
        self.steps = 0
        spec = mujoco.MjSpec()
        add_scene(spec, trial)
        model = spec.compile()
        # The tracker reads the objects' shapes from it; it is never stepped.
        self.simulation = Simulation(model, mujoco.MjData(model))

    @property
    def solved(self) -> bool:
        """Return LIBERO's own verdict on its present state."""
        return bool(self._state["solved"])

    def reset(self) -> Observation:
        """Return the first observation; the scene was made for this trial."""
        return self._observe(np.zeros(3))

    def step(self, target: HandTarget) -> Observation:
        """Take one action of OSC_POSE."""
        self._state = self._link.ask("step", action=self._action(target).tolist())
        self.steps += 1
        velocity = np.array(self._state["velocity"])
        mass = float(np.linalg.norm(self._weight)) / 9.81
        force = self._weight + mass * (velocity - self._before) / PERIOD_S - np.array(self._state["force"])
        self._before = velocity
        return self._observe(force)

    def truth(self) -> Truth:
        """Return LIBERO's state; contacts are not read."""
        now = self._observe(np.zeros(3))
        return Truth(now.time_s, now.tool, now.opening_m, now.objects, (), contacts_known=False)

    def stop(self) -> None:
        """Do nothing: the environment stands still between steps."""

    def close(self) -> None:
        """Do nothing: the program serves the next trial."""

    def _action(self, target: HandTarget) -> Array:
        """Convert the pull of an impedance to the action with the same acceleration of the hand.

        A spring K on the apparent mass m accelerates by K/m times its length, OSC_POSE by KP times the displacement.
        """
        tool, hand = self._tool(), self._hand
        way = target.position + target.force / target.stiffness - tool.position
        turn = to_rotvec(multiply(target.quaternion, conjugate(tool.quaternion)))
        way = way * target.stiffness / hand.mass_kg / (KP * STEP_M)
        turn = turn * hand.lever_m2 * target.stiffness / hand.inertia_kg_m2 / (KP * STEP_RAD)
        parts = [part / max(1.0, float(np.abs(part).max())) for part in (way, turn)]
        missing = target.opening_m - self._opening
        fingers = 0.0 if abs(missing) < OPENING_STEP_M / 2 and target.opening_m > 0 else -np.sign(missing)
        self._opening = float(np.clip(self._opening - fingers * OPENING_STEP_M, 0.0, OPEN_M))
        return np.array([*parts[0], *parts[1], fingers])

    def _tool(self) -> BodyState:
        state = self._state
        axes = np.array(state["axes"]) @ TOOL_IN_SITE
        velocity, spin = np.array(state["velocity"]), np.array(state["spin"])
        return BodyState(np.array(state["position"]) + SHIFT, quaternion_of(axes), velocity, spin)

    def _observe(self, force: Array) -> Observation:
        state = self._state
        left, right = state["fingers"]
        objects = {
            self._names[name]: BodyState(np.array(position) + SHIFT, np.array(quaternion))
            for name, (position, quaternion) in state["objects"].items()
            if self._names[name] in self._objects
        }
        opening = left - right - PAD_OVERLAP_M
        return Observation(state["time_s"], self._tool(), opening, np.array([*force, 0, 0, 0]), objects)


class LiberoWorld:
    """LIBERO's environment as a robot sees it: object poses are tracked in its pictures."""

    name, control_period_s = "libero", PERIOD_S

    def __init__(self, scene: LiberoScene, trial: Trial, cfg: TrackedCfg) -> None:
        self._scene = scene
        rng = np.random.default_rng([trial.seed, 4])
        self.tracked = TrackedWorld(scene, trial, cfg, rng, eye=scene.camera)
        self.lost = 0

    def reset(self) -> Observation:
        """See `RobotWorld.reset`."""
        self._now = self.tracked.reset()
        return self._now

    def step(self, target: HandTarget) -> Observation:
        """See `RobotWorld.step`."""
        self._now = self.tracked.step(self.tracked.retreat(target, self._now))
        self.lost += sum(one["lost"] for one in self.tracked.news())
        return self._now

    def truth(self) -> Truth:
        """See `TruthfulWorld.truth`."""
        return self._scene.truth()

    def stop(self) -> None:
        """See `RobotWorld.stop`."""

    def close(self) -> None:
        """See `RobotWorld.close`."""
        self.tracked.close()


class LiberoReferee:
    """Judges by LIBERO's own success test."""

    name: Literal["truth"] = "truth"

    def __init__(self, scene: LiberoScene) -> None:
        self._scene = scene

    @property
    def holding(self) -> tuple[bool, ...]:
        """See `Referee.holding`."""
        return (self._scene.solved,)

    def judged_state(self, now: Observation) -> Truth:
        """See `Referee.judged_state`."""
        return self._scene.truth()

    def end_reason(self, state: Truth, time_left: bool) -> str:
        """See `Referee.end_reason`."""
        return "success" if self._scene.solved else "" if time_left else "timeout"


def run_trial(link: Link, suite: str, task: int, state: int, samples: int, out: Path) -> dict[str, Any]:
    """Run a trial and return its row."""
    began = time.perf_counter()
    name = f"libero:{suite}/{task}/{state}"
    package = find_package(name, suite)
    trial = sample_trial(load_task(name).model_copy(update={"time_limit_s": LIMIT_S}), state)
    cfg = with_samples(
        EpisodeCfg(
            replan_steps=1,
            planning=PlanningCfg(step_s=PERIOD_S, latency=f"fixed:{PERIOD_S}", threads=1),
            controller=ControllerCfg(horizon=round(1.0 / PERIOD_S)),
        ),
        samples,
    )
    cfg = replace(cfg, record=replace(cfg.record, report=False, video=False, states=False))
    # No advisor is asked, but the period must be a whole number of the outer loop's steps.
    cfg = replace(cfg, think=replace(cfg.think, outer=replace(cfg.think.outer, replay_dt_s=0.005)))
    scene = LiberoScene(link, trial, package, package.tasks()[task], state)
    world = LiberoWorld(scene, trial, TrackedCfg(period_s=PERIOD_S, latency_s=PERIOD_S))
    folder = cleared(out / "runs" / trial.task.name)
    think = resolved(cfg.think, cfg.controller, "none")
    setup = AdvisorSetup(advisor="none", seed=state, world="panda", folder=folder, think=think)
    strategist = make_strategist("expert-fsm", trial.task, setup)
    episode = Episode(trial, world, strategist, cfg, folder, variant="expert-fsm")
    episode.referee = LiberoReferee(scene)
    row = episode.run()
    return {
        "suite": suite,
        "task": task,
        "state": state,
        "success": scene.solved,
        "end_reason": row["end_reason"],
        "detail": episode.detail,
        "sim_time_s": row["sim_time_s"],
        "steps": scene.steps,
        "in_published_steps": scene.solved and scene.steps <= PUBLISHED_STEPS,
        "track_lost": world.lost,
        "wall_time_s": round(time.perf_counter() - began, 1),
    }


def main() -> None:
    """Run the trials that are missing, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", type=Path, required=True, help="the interpreter of LIBERO's environment")
    parser.add_argument("--suites", default="object", help=f"of {', '.join(SUITES)}")
    parser.add_argument("--tasks", default=f"0-{TASKS - 1}")
    parser.add_argument("--states", default="0")
    parser.add_argument("--samples", type=int, default=40, help="rollouts per plan")
    parser.add_argument("--out", type=Path, default=Path("runs/libero-inside"))
    args = parser.parse_args()
    link = Link(args.python, find_package("libero:object"))
    try:
        rows = run_missing(args, lambda suite, task, state: run_trial(link, suite, task, state, args.samples, args.out))
    finally:
        link.close()
    print_tables(rows)
    print(f"\nwithin {PUBLISHED_STEPS} steps: {sum(row['in_published_steps'] for row in rows)} of {len(rows)}")


if __name__ == "__main__":
    main()
