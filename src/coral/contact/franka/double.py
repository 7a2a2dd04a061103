"""A simulated arm at a table: franky-sim's robot, which speaks the arm's own protocol, with contacts and poses added.

It runs in a process of its own. What the driver sees of it is what it would see of an arm: the protocol on a loopback
address, and the objects' poses as datagrams. The truth goes by another way, to the judge only.
"""

from __future__ import annotations

import contextlib
import os
import socket
import time
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from coral.contact.control.hand_model import FLANGE_TO_TOOL_M
from coral.contact.franka.child_process import ChildProcess, get_ready, leave_interrupts_to_the_program
from coral.contact.franka.double_scene import HAND, DoubleScene, make_rubber, scene_elements
from coral.contact.franka.object_poses import poses_datagram
from coral.contact.franka.shared_block import SharedBlock
from coral.contact.scene.geometry import from_rotvec, multiply, rotate
from coral.contact.scene.observation import Array, BodyState, Observation, Truth
from coral.contact.scene.trial import Trial
from coral.contact.worlds.evaluation_world import body_state
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError, RunError

MISSING = "pip install franky-sim (with the extra franka)"
NICENESS = -10
"""Priority of the simulated arm, where it is allowed."""
JOINT_FRICTION_N_M = (1.137, 1.137, 1.137, 1.137, 0.763, 0.44, 0.248)
"""Dry friction of the joints in franky-sim's model of the arm."""
COMPENSATED = 0.8
"""Share of it that the driver makes up for: who identifies an arm's friction errs by some of it."""
_GROUND_M = -0.912
_ANSWER_S = 5.0


WRENCH_BIAS = (1.5, -1.0, 2.0, 0.1, -0.1, 0.05)
"""Bias of the measured wrench, N and N m, base axes; assumed, not measured on an arm."""
WRENCH_NOISE_N, WRENCH_LAG_S = 0.3, 0.005
"""Standard deviation of each force, and time constant of the arm's own estimate; assumed."""
POSES_EVERY = 33
"""Steps of 1 ms from one pose of the objects to the next."""
POSES_NOISE_M, POSES_NOISE_RAD = 0.001, 0.01
"""Standard deviations of the poses."""


def cfg_for_double(cfg: FrankaCfg, silence_s: float = 2.0) -> FrankaCfg:
    """Return an arm's configuration for the simulated one: its friction, and patience.

    A simulated arm and the program slow down on a busy machine, so their silence is awaited for longer: link and
    watchdog time out after `silence_s` at the earliest.
    """
    friction = cfg.joint_friction_n_m
    if not any(friction):
        friction = tuple(COMPENSATED * each for each in JOINT_FRICTION_N_M)  # type: ignore[assignment]
    return replace(
        cfg,
        joint_friction_n_m=friction,
        link_timeout_s=max(cfg.link_timeout_s, silence_s),
        watchdog_s=max(cfg.watchdog_s, silence_s),
    )


class Double:
    """Starts the simulated arm and stops it.

    `speed` is the seconds of the arm's clock in a second of the machine's: below 1, plans of a busy machine are not
    later by the arm's clock than those of a quiet one.

    Raises:
        InputError: franky-sim is not installed.
        RunError: It did not start.
    """

    def __init__(self, trial: Trial, arm: FrankaCfg, speed: float = 1.0) -> None:
        try:
            import franky_sim  # noqa: F401
        except ImportError as error:
            raise InputError("--robot", "", f"sim ({error})", f"the package franky-sim: {MISSING}") from None
        self.state: SharedBlock[Observation | None] = SharedBlock(None)
        """The true state, for a simulated camera and nobody else."""
        self._child = ChildProcess("the simulated arm", _serve, (trial, arm, speed, self.state))
        self.address: str = self._child.answer

    def send_poses_to(self, host: str, port: int) -> None:
        """Begin to send the objects' poses."""
        self._ask(("poses", (host, port)))

    def truth(self) -> Truth:
        """Return the true state, for the judge only."""
        found: Truth = self._ask(("truth", None))
        return found

    def close(self) -> None:
        """Stop the process."""
        with contextlib.suppress(OSError):
            self._child.connection.send(("stop", None))
        self._child.end()

    def _ask(self, question: tuple[str, Any]) -> Any:
        connection = self._child.connection
        try:
            connection.send(question)
            if connection.poll(_ANSWER_S):
                kind, answer = connection.recv()
                if kind == "ok":
                    return answer
                raise RunError(f"the simulated arm failed: {answer}")
        except (EOFError, OSError):
            raise RunError("the simulated arm has ended") from None
        raise RunError(f"the simulated arm did not answer within {_ANSWER_S:.0f} s ({question[0]})")


def _serve(
    trial: Trial, arm: FrankaCfg, speed: float, state: SharedBlock[Observation | None], connection: Connection
) -> None:
    leave_interrupts_to_the_program()
    with contextlib.suppress(OSError, AttributeError):  # an arm does not slow down because the machine is busy
        os.setpriority(os.PRIO_PROCESS, 0, NICENESS)
    server = get_ready(connection, lambda: _Server(trial, arm, speed, state, connection), lambda made: made.hostname)
    try:
        server.run()
    except Exception as error:
        connection.send(("error", f"{type(error).__name__}: {error}"))


class _Server:
    """Steps the simulation in real time or slower, as far as the machine allows."""

    def __init__(
        self, trial: Trial, arm: FrankaCfg, speed: float, state: SharedBlock[Observation | None], connection: Connection
    ) -> None:
        import franky_sim
        from franky_sim.franka_robot_server import FrankaRobotServer
        from franky_sim.mujoco_simulator import MujocoSimulator

        self._period_s, self._state, self._connection = 0.001 / speed, state, connection
        self._rng = np.random.default_rng([trial.seed, 7])
        self._wrench = np.zeros(6)
        self._sending: tuple[str, int] | None = None
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        simulator = MujocoSimulator()
        measured = self

        class RobotServer(FrankaRobotServer):  # type: ignore[misc]
            def _get_state_bytes(self) -> bytes:
                wrench = tuple(measured.reported_wrench())
                return bytes(self.robot_state.replace(O_F_ext_hat_K=wrench, K_F_ext_hat_K=wrench).pack_state())

        class Server(franky_sim.SimulationServer):  # type: ignore[misc]
            def init(self) -> None:
                for robot in self.sim.robots:
                    server = RobotServer(robot, self._remaining_hostname_candidates)
                    server.init()
                    self.robot_servers.append(server)
                self.sim.start()

        self._simulator, self._server = simulator, Server(simulator)
        simulator.init()
        robot = simulator.add_robot(initial_q=arm.start_rad, initial_hand_width=0.08, position=arm.base_m)
        simulator.worldbody.find("geom[@name='ground']").set("pos", f"0 0 {_GROUND_M}")
        for section, elements in scene_elements(trial).items():
            into = simulator.worldbody if section == "worldbody" else simulator.scene.find(section)
            into.extend(elements)
        self._server.init()
        self.hostname = str(robot.hostname)
        make_rubber(simulator.model)
        self._scene = DoubleScene(simulator.model, simulator.data, trial)

    def run(self) -> None:
        """Run until the program says stop or is gone."""
        step, due = 0, time.perf_counter()
        while not (self._connection.poll() and not self._answer()):
            for server in self._server.robot_servers:
                server.process_commands()
            self._simulator.step()
            self._measure()
            for server in self._server.robot_servers:
                server.send_state()
            step += 1
            if step % POSES_EVERY == 0:
                self._send_poses()
            # A late simulation catches up with 20 ms at most.
            due = max(due + self._period_s, time.perf_counter() - 0.02)
            if (early_s := due - time.perf_counter()) > 0.0:
                time.sleep(early_s)

    def reported_wrench(self) -> Array:
        """Return the wrench as the arm would report it: filtered, biased and noisy."""
        noise = WRENCH_NOISE_N * self._rng.standard_normal(6) * np.array([1, 1, 1, 0.1, 0.1, 0.1])
        return np.asarray(self._wrench + WRENCH_BIAS + noise)

    def _measure(self) -> None:
        self._wrench += (1.0 - np.exp(-0.001 / WRENCH_LAG_S)) * (self._scene.measure() - self._wrench)

    def _answer(self) -> bool:
        """Answer the program; return False if it wants the end."""
        try:
            question, value = self._connection.recv()
        except (EOFError, OSError):
            return False
        if question == "stop":
            return False
        answer: Any = None
        if question == "poses":
            self._sending = value
        elif question == "truth":
            answer = self._scene.truth(float(self._simulator.data.time), self._tool(), self._opening())
        self._connection.send(("ok", answer))
        return True

    def _send_poses(self) -> None:
        poses = self._scene.poses()
        now = float(self._simulator.data.time)
        self._state.write(Observation(now, self._tool(), self._opening(), self._wrench, poses))
        if self._sending is None:
            return
        noisy = {}
        for name, pose in poses.items():
            turn = from_rotvec(POSES_NOISE_RAD * self._rng.standard_normal(3))
            position = pose.position + POSES_NOISE_M * self._rng.standard_normal(3)
            noisy[name] = BodyState(position, multiply(turn, pose.quaternion))
        self._socket.sendto(poses_datagram(noisy), self._sending)

    def _tool(self) -> BodyState:
        model, data = self._simulator.model, self._simulator.data
        hand = body_state(model, data, HAND)
        offset = rotate(hand.quaternion, np.array([0.0, 0.0, FLANGE_TO_TOOL_M]))
        velocity = hand.velocity + np.cross(hand.angular_velocity, offset)
        return BodyState(hand.position + offset, hand.quaternion, velocity, hand.angular_velocity)

    def _opening(self) -> float:
        data = self._simulator.data
        joints = ("robot0_finger_joint1", "robot0_finger_joint2")
        return float(sum(data.joint(name).qpos[0] for name in joints))
