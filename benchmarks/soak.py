"""A long soak: hours of `coral reef sail`, and a campaign under kills, full disks and a jumping clock.

    python benchmarks/soak.py sail --minutes 120 --out soak        # killed after an hour, and resumed
    python benchmarks/soak.py campaign --rounds 20 --out soak      # 200 episodes; full disks need root, for a tmpfs

The sail is a survey of a generated reef through MAVLink, with the simulated autopilot, whose clock jumps every ten
minutes; each leg goes on with the map of the one that was killed. Memory, late ticks and lost rows are printed as a
Markdown table.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import chaos

JUMP_S, LOOK_S, HEAD = 600, 15.0, "| minutes | memory (MB) | ticks | late | rows lost | load of the machine |"
EPISODES = {
    "reef": ["reef", "bench", "--variants", "full,pd", "--worlds", "l1,s1,k1,o1", "--seeds", "0-19",
             "--cfg.time-limit-s", "4"],
    "contact": ["contact", "bench", "--variants", "expert-fsm", "--tasks", "pick-box,flip-box", "--worlds", "hand",
                "--seeds", "0-19", "--samples", "8", "--cfg.planning.threads", "1"],
}  # fmt: skip
"""160 missions and 40 episodes."""
CORAL = [sys.executable, "-m", "coral"]
AUTOPILOT = Path(__file__).parents[1] / "tests" / "autopilot"


def main() -> None:
    """Run one part."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", choices=["sail", "campaign"])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--minutes", type=float, default=120.0)
    parser.add_argument("--leg-minutes", type=float, default=60.0, help="until the sail is killed, and resumed")
    parser.add_argument("--size-m", type=float, default=100.0, help="edge of the reef")
    parser.add_argument("--rounds", type=int, default=20, help="disturbances of each campaign")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    {"sail": sail, "campaign": campaign}[args.part](args)


def sail(args: argparse.Namespace) -> None:
    """Survey for so long; kill the program at the end of each leg, and go on with its map in the next."""
    world = args.out / "vast.yaml"
    if not world.exists():
        words = ["--topology", "patchy", "--size-m", *[str(args.size_m)] * 2, "--clusters", "0", "--obstacles", "150"]
        subprocess.run([*CORAL, "reef", "generate", *words, "--out", str(world)], check=True, stdout=sys.stderr)
    ends_at, earlier, number = time.monotonic() + 60.0 * args.minutes, [], 0
    while time.monotonic() < ends_at:
        number += 1
        folder = args.out / f"leg-{number}"
        leg(world, folder, earlier, min(60.0 * args.leg_minutes, ends_at - time.monotonic()))
        if (folder / "survey.npz").exists():
            earlier = ["--resume", str(folder)]


def leg(world: Path, folder: Path, earlier: Sequence[str], limit_s: float) -> None:
    """Survey until the time is up and kill the program, unless it ends by itself; print what it did."""
    jumps = [word for t in range(JUMP_S, int(limit_s), JUMP_S) for word in ("--fault", f"{t}:clock-jump:3600")]
    autopilot = subprocess.Popen(
        [sys.executable, str(AUTOPILOT), str(world), "--tcp-port", "0", "--ready-s", "1", *jumps],
        stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    try:
        assert autopilot.stderr is not None
        address = autopilot.stderr.readline().split("listens at ")[1].split(";")[0]
        command = [*CORAL, "reef", "sail", str(world), "--vehicle", address, "--truth", address, "--yes", "--quiet"]
        command += ["--no-preflight", "--cfg.time-limit-s", "1000000", *earlier]
        command += ["--safety.on-time", "none", "--safety.battery-min", "0", "--cfg.no-stop-when-covered"]
        process = subprocess.Popen([*command, "--out", str(folder)], stdout=subprocess.DEVNULL)
        print(f"\n{folder.name} {' '.join(earlier)}\n\n{HEAD}\n|---:|---:|---:|---:|---:|---:|", flush=True)
        while process.poll() is None and len(_lines(folder, "trajectory.csv")) < 2:
            time.sleep(1.0)
        begun, next_look = time.monotonic(), 0.0
        while process.poll() is None and (passed := time.monotonic() - begun) < limit_s:
            if passed >= next_look:
                print(state(folder, process.pid, passed), flush=True)
                next_look += max(60.0, limit_s / 12)
            time.sleep(min(LOOK_S, limit_s / 12))
        print(state(folder, process.pid, time.monotonic() - begun), flush=True)
        process.kill()
        print(f"exit code {process.wait()}; torn: {[str(p) for p in chaos.torn(folder)]}; {ends(folder)}", flush=True)
    finally:
        autopilot.kill()


def state(folder: Path, pid: int, passed_s: float) -> str:
    """Return a row: memory, ticks, late ones, and those that left no row."""
    memory = 0
    with suppress(OSError):
        status = Path(f"/proc/{pid}/status").read_text().splitlines()
        memory = next((int(line.split()[1]) // 1024 for line in status if line.startswith("VmRSS")), 0)
    steps = [line.split(",", 1)[0] for line in _lines(folder, "trajectory*.csv")]
    known = {int(step) for step in steps if step.isdigit()}
    lost = max(known) - min(known) + 1 - len(known) if known else 0
    late = sum('"late_tick"' in line for line in _lines(folder, "events*.jsonl"))
    return f"| {passed_s / 60:.1f} | {memory} | {len(known)} | {late} | {lost} | {os.getloadavg()[0]:.1f} |"


def _lines(folder: Path, names: str) -> list[str]:
    return [line for path in sorted(folder.glob(names)) for line in path.read_text(encoding="utf-8").splitlines()]


def ends(folder: Path) -> str:
    """Count the states in which the vehicle was, with their reasons."""
    events = [json.loads(line) for line in _lines(folder, "events*.jsonl")]
    return str(Counter(f"{e['state']}: {e['reason']}" for e in events if e["event"] == "state").most_common(6))


def campaign(args: argparse.Namespace) -> None:
    """Run 200 episodes undisturbed and disturbed, and compare the rows."""
    chaos.CAMPAIGNS.update(EPISODES)
    for name in EPISODES:
        calm, disk = args.out / f"{name}-calm", args.out / f"{name}-disk"
        chaos.LONGEST_S = 36_000.0
        first = chaos.run(name, calm)
        print(f"{name}, undisturbed: exit code {first.returncode}, {len(chaos.rows(calm))} rows", flush=True)
        disk.mkdir(exist_ok=True)
        hook = args.out / "clock"
        hook.mkdir(exist_ok=True)
        (hook / "sitecustomize.py").write_text(chaos.JUMPS.format(first=2.0, second=6.0))
        with chaos.mounted(disk, "100k"):
            told = disturb(name, disk, hook, random.Random(args.seed), args.rounds)
            subprocess.run(["mount", "-o", "remount,size=900m", str(disk)], check=True)
            last = chaos.run(name, disk / "campaign")
            verdict = chaos.compare(calm, disk / "campaign")
            print(f"| {name} | {told}; at last {last.returncode} | {verdict} |", flush=True)


def disturb(name: str, disk: Path, hook: Path, rng: random.Random, rounds: int) -> str:
    """Continue a campaign again and again, each time killed, on a disk that gets full, or with a clock that jumps."""
    done, codes, size_kb = Counter[str](), Counter[int](), 100
    for _ in range(rounds):
        kind = rng.choice(["kill", "disk", "clock"])
        used_kb = int(subprocess.run(["du", "-sk", str(disk)], capture_output=True, text=True).stdout.split()[0])
        size_kb = used_kb + (rng.randrange(50, 400) if kind == "disk" else 200_000)
        subprocess.run(["mount", "-o", f"remount,size={size_kb}k", str(disk)], check=True)
        path = os.pathsep.join([str(hook)] * (kind == "clock") + [os.environ.get("PYTHONPATH", "")])
        process = subprocess.Popen(
            chaos.command(name, disk / "campaign"), env={**os.environ, "PYTHONPATH": path},
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        with suppress(subprocess.TimeoutExpired):
            process.wait(rng.uniform(5.0, 60.0))
        if process.poll() is None:
            workers: Sequence[int] = chaos.children(process.pid)
            whom, which = rng.choice([process.pid, *workers]), rng.choice(chaos.SIGNALS)
            with suppress(ProcessLookupError):
                os.kill(whom, which)
        if not chaos.ends_soon(process):
            process.send_signal(signal.SIGTERM)
        process.wait(600.0)
        done[kind] += 1
        codes[process.returncode] += 1
    return f"{dict(done)}, each ended by a signal; exit codes {dict(codes)}"


if __name__ == "__main__":
    main()
