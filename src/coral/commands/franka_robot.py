"""The arm of `coral contact run --world franka`: connect, go through the list, ask, and hand over a world."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from coral.check_line import blocking, list_text
from coral.commands.robot_flags import SIMULATED, RobotFlags
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.franka.double import Double, cfg_for_double
from coral.contact.franka.franky_arm import FrankyArm, franky
from coral.contact.franka.preflight import MARKS, preflight_arm
from coral.contact.franka.stream_process import StreamProcess
from coral.contact.franka.world import FrankaDoubleWorld, FrankaWorld
from coral.contact.scene.trial import Trial
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.errors import InputError, RunError
from coral.terminal import tell

if TYPE_CHECKING:
    from coral.contact.franka.camera_process import CameraProcess

WORD = "move"
DRY_RUN_S = 3.0
"""Duration of a dry run: the arm does not move, and the plan's beginning repeats."""
_SEEN_WITHIN_S = 10.0


def robot_trial(trial: Trial, flags: RobotFlags) -> Trial:
    """Return the trial as it is attempted: a dry run is short."""
    if not flags.dry_run:
        return trial
    limit_s = min(DRY_RUN_S, trial.task.time_limit_s)
    return replace(trial, task=trial.task.model_copy(update={"time_limit_s": limit_s}))


def robot_cfg(cfg: EpisodeCfg, flags: RobotFlags) -> EpisodeCfg:
    """Return the configuration for an arm.

    It does not wait for plans: their latency is measured, unless it is given.

    Raises:
        InputError: Nobody could judge at a real arm.
    """
    if flags.robot != SIMULATED and cfg.judged_by == "truth":
        if not flags.dry_run:  # in which there is nothing to judge
            raise InputError("--cfg", "judged-by", "truth", "operator or perception: an arm does not know the truth")
        cfg = replace(cfg, judged_by="operator")
    if cfg.planning.latency == "0":
        cfg = replace(cfg, planning=replace(cfg.planning, latency="measured"))
    if flags.robot == SIMULATED:
        cfg = replace(cfg, franka=cfg_for_double(cfg.franka))
    return cfg


def make_robot_world(trial: Trial, cfg: EpisodeCfg, flags: RobotFlags, quiet: bool = False) -> FrankaWorld:
    """Connect with the arm, show the list, and wait for the operator's word.

    Raises:
        InputError: The extra is missing, or nothing answers at the address.
        RunError: A line of the list is not in order, or the operator did not say the word.
    """
    assert flags.robot is not None
    franky()  # a missing extra is said before anything is started
    arm, names = cfg.franka, tuple(item.name for item in trial.task.objects)
    double: Double | None = None
    stream: StreamProcess | None = None
    camera: CameraProcess | None = None
    show = tell if flags.dry_run and not quiet else None
    try:
        if flags.robot == SIMULATED:
            tell("starting the simulated arm ...")
            double = Double(trial, arm)
        stream = StreamProcess(FrankyArm, double.address if double else flags.robot, arm, trial)
        if flags.camera is not None:
            camera = _start_camera(trial, cfg, flags, (arm.poses_host, stream.poses_port), double)
        elif double is not None:
            double.send_poses_to(arm.poses_host, stream.poses_port)
        go_through(stream, arm, names)
        if not flags.dry_run and not flags.yes:
            ask_for_word()
    except BaseException:
        for part in (camera, stream, double):
            if part is not None:
                part.close()
        raise
    kind = FrankaWorld if double is None else FrankaDoubleWorld
    period_s = cfg.planning.step_s
    return kind(stream, arm, period_s, names, double=double, camera=camera, dry_run=flags.dry_run, show=show)


def _start_camera(
    trial: Trial, cfg: EpisodeCfg, flags: RobotFlags, poses_to: tuple[str, int], double: Double | None
) -> CameraProcess:
    from coral.contact.franka.camera_process import CameraJob, CameraProcess

    assert flags.camera is not None
    host = "127.0.0.1" if poses_to[0] in ("", "0.0.0.0") else poses_to[0]
    masks, state = flags.masks or "colour", None if double is None else double.state
    return CameraProcess(
        CameraJob(trial, flags.camera, masks, flags.camera_pose, cfg.tracked, (host, poses_to[1]), state)
    )


def go_through(
    stream: StreamProcess, arm: FrankaCfg, names: tuple[str, ...], sleep: Callable[[float], None] = time.sleep
) -> None:
    """Show the preflight list once all is in order, or when it does not come into order.

    Raises:
        RunError: A line is not in order.
    """
    waited = 0.0
    while True:
        checks = preflight_arm(stream.report(), arm, names)
        wrong = blocking(checks)
        if not wrong or waited >= _SEEN_WITHIN_S:
            break
        sleep(0.05)
        waited += 0.05
    tell(list_text(checks, MARKS))
    if wrong:
        raise RunError(f"the arm does not move: {wrong[0].subject}: {wrong[0].text}")


def ask_for_word(read: Callable[[], str] = sys.stdin.readline) -> None:
    """Wait for the operator's word.

    Raises:
        RunError: Another word came, or none.
    """
    print(
        f"The arm will move to its start posture and then on its own. Keep the stop button in your hand; Ctrl-C stops\n"
        f"it too. Type {WORD} and Enter: ",
        end="",
        file=sys.stderr,
        flush=True,
    )
    if read().strip().lower() != WORD:
        raise RunError(f"the arm does not move: the operator did not say {WORD!r}")
