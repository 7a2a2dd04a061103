"""The stream in a process of its own, so that neither planning nor writing files holds it up."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection

from coral.contact.franka.child_process import ChildProcess, get_ready
from coral.contact.franka.franky_arm import FrankyArm
from coral.contact.franka.hand_gaps import HandGaps
from coral.contact.franka.object_poses import ObjectPoses
from coral.contact.franka.shared_block import SharedBlock
from coral.contact.franka.stream import Orders, StopCause, Stream, StreamReport
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.trial import Trial
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import RunError

MakeArm = Callable[[str, FrankaCfg], FrankyArm]
"""Makes an arm from address and configuration; a function of a module, because a process is spawned."""
BEAT_S = 0.05
"""Time between the program's signs of life."""
PRIORITY = 10
"""Real-time priority of the stream, 1 to 99; most kernel threads have more."""


class StreamProcess:
    """Starts the stream, whose arm is made in the new process, and speaks with it.

    Raises:
        InputError, RunError: The arm cannot be used.
    """

    def __init__(self, make_arm: MakeArm, address: str, cfg: FrankaCfg, trial: Trial) -> None:
        self._orders = Orders()
        self._orders_block, self._report_block = SharedBlock(self._orders), SharedBlock(StreamReport())
        self._lock = threading.Lock()
        self._reason = ""
        self._ended = threading.Event()
        args = (make_arm, address, cfg, trial, self._orders_block, self._report_block)
        self.child = ChildProcess("the stream to the arm", _run, args)
        self.poses_port: int = self.child.answer
        threading.Thread(target=self._beat, name="franka-beat", daemon=True).start()

    def start(self) -> None:
        """Let the arm move: to its start posture first."""
        self._order(start=True)

    def follow(self, target: HandTarget) -> None:
        """Set the target, in the arm's base frame."""
        self._order(target=target)

    def stop(self, cause: StopCause) -> None:
        """Ask for a stop; the first cause counts."""
        self._order(stop=cause)

    def report(self) -> StreamReport:
        """Return the newest report.

        Raises:
            RunError: The process has died.
        """
        if not self.child.process.is_alive():
            raise RunError("the stream to the arm has ended")
        return self._report_block.read()

    def reason(self) -> str:
        """Return why the arm was stopped, in words; "" while it was not."""
        if not self._reason:
            try:
                if self.child.connection.poll(0.0):
                    self._reason = str(self.child.connection.recv())
            except (EOFError, OSError):
                self._reason = "the stream to the arm has ended"
        return self._reason

    def close(self) -> None:
        """Stop the arm and end the process."""
        self._order(stop=StopCause.END, quit=True)
        self._ended.set()  # without signs of life the process ends by itself
        self.child.end()

    def _order(
        self, start: bool = False, stop: StopCause | None = None, quit: bool = False, target: HandTarget | None = None
    ) -> None:
        with self._lock:
            before = self._orders
            self._orders = replace(
                before,
                start=before.start or start,
                stop=before.stop or stop or StopCause.NONE,
                quit=before.quit or quit,
                target=target or before.target,
            )
            self._orders_block.write(self._orders)

    def _beat(self) -> None:
        while not self._ended.wait(BEAT_S):
            with self._lock:
                self._orders = replace(self._orders, beat=self._orders.beat + 1)
                self._orders_block.write(self._orders)


def _run(
    make_arm: MakeArm,
    address: str,
    cfg: FrankaCfg,
    trial: Trial,
    orders_block: SharedBlock[Orders],
    report_block: SharedBlock[StreamReport],
    connection: Connection,
) -> None:
    pressed: list[int] = []
    if threading.current_thread() is threading.main_thread():  # it is not where a test runs it in a thread
        for number in (signal.SIGINT, signal.SIGTERM):  # Ctrl-C reaches this process, whatever the program does
            signal.signal(number, lambda number, _: pressed.append(number))
        _take_priority()

    def prepare() -> tuple[ObjectPoses, FrankyArm]:
        return ObjectPoses(trial.objects, cfg.poses_host, cfg.poses_port), make_arm(address, cfg)

    poses, arm = get_ready(connection, prepare, lambda made: made[0].port)
    stream = Stream(arm, poses, cfg, time.monotonic, HandGaps(trial))
    period_s, parent, told, due = 1.0 / cfg.rate_hz, os.getppid(), False, time.monotonic()
    try:
        while True:
            orders = orders_block.read()
            stream.tick(replace(orders, stop=StopCause.KEYBOARD) if pressed else orders)
            if stream.stopped:
                if not told:
                    connection.send(stream.reason or stream.cause.name.lower())
                    told = True
                if orders.quit or signal.SIGTERM in pressed or os.getppid() != parent:
                    break
            report_block.write(stream.report())
            due += period_s
            time.sleep(max(0.0, due - time.monotonic()))
            if time.monotonic() - due > period_s:  # missed ticks are not made up for
                due = time.monotonic()
    finally:
        stream.stop(StopCause.FAULT, "the stream failed")
        arm.close()
        poses.close()


def _take_priority() -> None:
    """Ask for real-time scheduling; where it is not allowed, the stream is as punctual as the machine is idle."""
    with contextlib.suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
