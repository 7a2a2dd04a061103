"""The driver of a Franka arm against the simulated arm of franky-sim: successes, the stream's punctuality, stops.

    python benchmarks/franka_arm.py --seeds 0-9 --stops 0 --out arm.md
    python benchmarks/franka_arm.py --seeds '' --stops 1 --out stops.md

Each episode starts a simulated arm of its own, with contact forces, noisy wrenches and noisy poses. Plans are charged
with a fixed latency by the arm's clock, so a machine on which the simulated arm is slow gains nothing. With --speed
the arm's clock runs slower than the machine's, so that a plan is ready within that latency although the planner shares
two busy cores with the simulated arm. Each stop is caused while the arm moves on a circle, and counted to the stop
command; the table says from which moment.
"""

from __future__ import annotations

import argparse
import os
import signal
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from coral.campaign.spec import parse_seeds
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.episode.resolution import resolve_episode
from coral.contact.episode.variants import AdvisorSetup, make_strategist
from coral.contact.franka.camera_process import CameraJob, CameraProcess
from coral.contact.franka.camera_stream import CameraStream
from coral.contact.franka.double import Double, DoubleCfg, cfg_for_double
from coral.contact.franka.franky_arm import FrankyArm
from coral.contact.franka.stream import Phase, StopCause
from coral.contact.franka.stream_process import StreamProcess
from coral.contact.franka.stream_record import StreamReport
from coral.contact.franka.world import FrankaDoubleWorld, StreamHandle
from coral.contact.scene.observation import HandTarget
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.worlds.franka_cfg import FrankaCfg
from coral.contact.worlds.robot_world import WorldError

CAUSES = {
    StopCause.PAGE: "a request of the page, from the request",
    StopCause.KEYBOARD: "Ctrl-C, from the signal",
    StopCause.LIMIT: "a measured force beyond its limit, from the state that shows it",
    StopCause.POSES: "no poses, from the end of their time-out (250 ms by the arm's clock)",
    StopCause.LINK: "no states, from the last state; time-out 30 ms included",
    StopCause.WATCHDOG: "a silent program, from the end of its time-out (300 ms)",
}


def main() -> None:
    """Measure and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", default="pick-box,push-gently")
    parser.add_argument("--seeds", default="0-4")
    parser.add_argument("--samples", type=int, default=60, help="rollouts per plan")
    parser.add_argument("--latency-s", type=float, default=0.05, help="time of a plan by the arm's clock")
    parser.add_argument("--speed", type=float, default=1.0, help="speed of the arm's clock: see above")
    parser.add_argument("--touch-speed", type=float, help="limit on the speed at touch, m/s; 100: no slow approach")
    parser.add_argument("--camera", action="store_true", help="poses by a simulated camera, colour masks and trackers")
    parser.add_argument("--runs", type=Path, help="folder to keep the run folders in")
    parser.add_argument("--stops", type=int, default=5, help="stops for each cause")
    parser.add_argument("--until", default="", help="begin no episode after this time of the day, HH:MM")
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args()
    rows: list[dict[str, Any]] = []
    stops = {cause: list(measure_stops(cause, args.stops)) for cause in (CAUSES if args.stops else ())}
    args.out.write_text(table(rows, stops, args), encoding="utf-8")
    for seed in parse_seeds(args.seeds) if args.seeds else ():
        for task in args.tasks.split(","):
            if args.until and time.strftime("%H:%M") >= args.until:
                continue
            rows.append(attempt(task, seed, args))
            print(rows[-1], flush=True)
            args.out.write_text(table(rows, stops, args), encoding="utf-8")


def attempt(name: str, seed: int, args: argparse.Namespace) -> dict[str, Any]:
    """Run one episode and return its row."""
    task = load_task(name)
    trial = sample_trial(task, seed, name)
    cfg = resolve_episode(EpisodeCfg(), samples=args.samples, poses=None, tracker=None, fallback=None)
    arm = cfg_for_double(replace(cfg.franka, poses_port=0))
    if args.touch_speed is not None:
        arm = replace(arm, limits=replace(arm.limits, touch_speed_m_s=args.touch_speed))
    cfg = replace(cfg, franka=arm, planning=replace(cfg.planning, latency=f"fixed:{args.latency_s:g}"))
    cfg = replace(cfg, record=replace(cfg.record, report=False))
    double = Double(trial, arm, DoubleCfg(speed=args.speed))
    stream = StreamProcess(FrankyArm, double.address, arm, trial)
    handle: StreamHandle = stream
    if args.camera:
        job = CameraJob(trial, "sim", "colour", None, cfg.tracked, (arm.poses_host, stream.poses_port))
        camera = CameraProcess(job)
        double.send_state_to(camera.state_address)
        handle = CameraStream(stream, camera, arm.base_m)
    else:
        double.send_poses_to(arm.poses_host, stream.poses_port)
    world = FrankaDoubleWorld(handle, arm, cfg.planning.step_s, list(trial.objects), double)
    last = LastReport(stream)
    with tempfile.TemporaryDirectory() as folder:
        setup = AdvisorSetup(advisor="none", seed=seed, world="franka", folder=Path(folder), think=cfg.think)
        strategist = make_strategist("expert-fsm", task, setup)
        run = (args.runs or Path(folder)) / f"{name}-{seed}"
        result = Episode(trial, world, strategist, cfg, run, variant="expert-fsm").run([last])
    report = last.report
    return {
        "task": name,
        "seed": seed,
        "success": result["success"],
        "end": result["end_reason"],
        "arm_s": result["sim_time_s"],
        "wall_s": result["wall_time_s"],
        "peak_true_n": result["peak_hand_force_n"],
        "peak_measured_n": report.peak_force_n,
        "late_p99_ms": report.late_p99_ms,
        "late_max_ms": report.late_max_ms,
        "ticks": report.tick,
    }


class LastReport:
    """Keeps the stream's newest report; an observer of the episode.

    Args:
        stream: The stream.
    """

    def __init__(self, stream: StreamProcess) -> None:
        self._stream = stream
        self.report: StreamReport = stream.report()

    def tick(self, run: Episode) -> None:
        """See `Observer.tick`."""
        self.report = self._stream.report()

    def stop_requested(self) -> str:
        """See `Observer.stop_requested`."""
        return ""


def measure_stops(cause: StopCause, count: int) -> Iterator[tuple[float, float]]:
    """Yield the time to the stop command and to rest, for stops of a moving arm by one cause.

    Yields:
        Machine's time to the command (ms), and time from there to rest by the arm's clock (ms; nan without states).
    """
    trial = sample_trial(load_task("pick-box"), 0, "pick-box")
    done = attempts = 0
    while done < count and attempts < 3 * count:
        attempts += 1
        patient = cfg_for_double(FrankaCfg(poses_port=0))
        if cause is StopCause.LINK:
            patient = replace(patient, link_timeout_s=0.03)
        if cause is StopCause.WATCHDOG:
            patient = replace(patient, watchdog_s=0.3)
        if cause is StopCause.LIMIT:
            patient = replace(patient, limits=replace(patient.limits, contact_force_n=20.0))
        double = Double(trial, patient)
        stream = StreamProcess(FrankyArm, double.address, patient, trial)
        try:
            found = stop_once(cause, double, stream, patient)
        finally:
            stream.close()
            double.close()
        if found is None:  # another cause was first: on a busy machine states are late
            continue
        print(cause.name.lower(), found, flush=True)
        done += 1
        yield found


def stop_once(cause: StopCause, double: Double, stream: StreamProcess, cfg: FrankaCfg) -> tuple[float, float] | None:
    """Cause one stop; None if another cause was first."""
    double.send_poses_to(cfg.poses_host, stream.poses_port)
    world = FrankaDoubleWorld(stream, cfg, 0.02, (), double)
    try:
        world.reset()
        start = stream.report().tool
        down = np.array([0.0, 0.0, -0.3]) if cause is StopCause.LIMIT else np.zeros(3)
        for k in range(50):
            turn = 2.0 * np.pi * k / 100.0
            place = start.position + 0.08 * np.array([1.0 - np.cos(turn), np.sin(turn), 0.0]) + down
            world.step(HandTarget(place + np.asarray(cfg.base_m), start.quaternion, 0.08, 600.0))
        began = time.monotonic()
        if cause is StopCause.PAGE:
            stream.stop(StopCause.PAGE)
        elif cause is StopCause.KEYBOARD:
            os.kill(stream.pid, signal.SIGINT)
        elif cause is StopCause.POSES:
            double.hide_objects()
        elif cause is StopCause.LINK:
            double.drop_link()
        elif cause is StopCause.WATCHDOG:
            stream.pause_beat()
    except WorldError:
        began = 0.0
    deadline = time.monotonic() + 20.0
    while stream.report().phase is not Phase.STOPPED and time.monotonic() < deadline:
        time.sleep(0.01)
    time.sleep(2.0)
    report = stream.report()
    if report.cause is not cause:
        print(f"{cause.name.lower()}: {report.cause.name.lower()} was first ({stream.reason()})", flush=True)
        return None
    outside = cause in (StopCause.PAGE, StopCause.KEYBOARD)
    command_s = report.stopped_at_s - began if outside else report.stop_latency_s
    return 1e3 * command_s, 1e3 * report.still_after_s if report.still_after_s else float("nan")


def table(
    rows: Sequence[dict[str, Any]], stops: dict[StopCause, list[tuple[float, float]]], args: argparse.Namespace
) -> str:
    """Return the tables as Markdown."""
    lines = [
        "# The driver against the simulated arm",
        "",
        "`python benchmarks/franka_arm.py`: franky-sim's arm with contacts. Its wrench has bias, noise and lag,",
        "poses by a simulated camera with noise, masks by colour and trackers (`--camera`)."
        if args.camera
        else "its poses 1 mm and 0.6 degrees of noise at 30 Hz; these are assumptions.",
        "Nothing was measured on a real arm.",
    ]
    if rows:
        lines += [
            "",
            f"Variant `expert-fsm`, {args.samples} rollouts per plan, ready after {args.latency_s:g} s by the arm's",
            f"clock, which runs at {args.speed:g} of the machine's. Of the joints' friction 80 % are made up for.",
            "",
            "| task | seed | end | arm's clock | wall clock | peak force: true, measured | stream late: p99, worst |",
            "|---|---|---|---|---|---|---|",
        ]
    for row in rows:
        lines.append(
            f"| {row['task']} | {row['seed']} | {row['end']} | {row['arm_s']:.1f} s | {row['wall_s']:.0f} s "
            f"| {row['peak_true_n']:.0f} N, {row['peak_measured_n']:.0f} N "
            f"| {row['late_p99_ms']:.1f} ms, {row['late_max_ms']:.1f} ms |"
        )
    for task in dict.fromkeys(row["task"] for row in rows):
        those = [row for row in rows if row["task"] == task]
        lines.append(f"| {task} | all | {sum(row['success'] for row in those)} of {len(those)} successes | | | | |")
    if stops:
        lines += [
            "",
            "| stop by | stops | to the stop command: median, worst | from there to rest, arm's clock: median, worst |",
            "|---|---|---|---|",
        ]
    for cause, found in stops.items():
        command, rest = (np.array(values) for values in zip(*found, strict=True)) if found else (np.zeros(0),) * 2
        rest = rest[np.isfinite(rest)]
        lines.append(f"| {CAUSES[cause]} | {len(found)} | {_ms(command)} | {_ms(rest)} |")
    return "\n".join(lines) + "\n"


def _ms(values: Any) -> str:
    return f"{np.median(values):.0f} ms, {values.max():.0f} ms" if len(values) else "not known"


if __name__ == "__main__":
    main()
