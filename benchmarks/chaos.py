"""Campaigns and missions while processes are killed, disks are full and the clock jumps: does anything get lost?

    python benchmarks/chaos.py kills --rounds 20 --out chaos      # SIGKILL, SIGTERM, SIGHUP at random moments
    python benchmarks/chaos.py clock --out chaos                  # the wall clock jumps by an hour, forth and back
    python benchmarks/chaos.py disk --out chaos                   # a disk of a few megabytes (needs root, for a tmpfs)

Each part runs a campaign undisturbed first. A disturbed one must end with the same rows, apart from times of the
machine; every line of every log must be whole; no trial may be missing or there twice.
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
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

CAMPAIGNS = {
    "reef": ["reef", "bench", "--variants", "full,pd", "--worlds", "l1,s1", "--seeds", "0", "--cfg.time-limit-s", "12"],
    "contact": [
        "contact", "bench", "--variants", "expert-fsm,full", "--tasks", "pick-box,flip-box", "--worlds", "hand",
        "--seeds", "0-1", "--samples", "8", "--cfg.planning.threads", "1",
    ],
}  # fmt: skip
OF_THE_MACHINE = (
    "wall",
    "ms",
    "realtime",
    "factor",
    "date",
    "cpu",
    "rss",
    "late",
    "hz",
    "duration",
    "latency",
    "pid",
    "attempts",
)
"""Columns with one of these words tell of the machine and not of what was done."""
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP)
LONGEST_S = 900.0
JUMPS = """
import time
_time, _ns, _begun = time.time, time.time_ns, time.monotonic()
def _jump():
    passed = time.monotonic() - _begun
    return 0.0 if passed < {first} else 3600.0 if passed < {second} else -3600.0
time.time = lambda: _time() + _jump()
time.time_ns = lambda: _ns() + int(_jump() * 1e9)
"""


def main() -> None:
    """Run one part and print its findings."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("part", choices=["kills", "clock", "disk"])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--rounds", type=int, default=20, help="kills of each campaign")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    parser.add_argument("--disk", default="200k", help="size of the disk that gets full")
    parser.add_argument("--only", default="reef,contact")
    args = parser.parse_args()
    for name in args.only.split(","):
        calm = args.out / f"{name}-calm"
        run(name, calm)
        found = {"kills": kill, "clock": turn_clock, "disk": fill_disk}[args.part](name, args)
        folder, story = found
        print(f"| {name} | {args.part} | {story} | {compare(calm, folder)} |", flush=True)


def command(name: str, out: Path) -> list[str]:
    """Return the command of a campaign."""
    return [sys.executable, "-m", "coral", *CAMPAIGNS[name], "--jobs", "2", "--quiet", "--out", str(out)]


def run(name: str, out: Path, extra: Mapping[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """Run or continue a campaign to its end."""
    return subprocess.run(
        command(name, out), capture_output=True, text=True, env={**os.environ, **(extra or {})}, timeout=LONGEST_S
    )


def kill(name: str, args: argparse.Namespace) -> tuple[Path, str]:
    """Send signals to the campaign and to its workers at random moments; continue it by the same command."""
    rng, out, sent = random.Random(args.seed), args.out / f"{name}-kills", Counter[str]()
    codes = Counter[int]()
    for _ in range(args.rounds):
        process = subprocess.Popen(command(name, out), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        with suppress(subprocess.TimeoutExpired):
            process.wait(rng.uniform(1.0, 20.0))
        if process.poll() is None:
            workers = children(process.pid)
            whom = rng.choice([process.pid, *workers])
            which = rng.choice(SIGNALS)
            with suppress(ProcessLookupError):
                os.kill(whom, which)
            sent[f"{which.name} to {'it' if whom == process.pid else 'a worker'}"] += 1
        if not ends_soon(process):  # only a worker was hit, and the campaign goes on
            process.send_signal(signal.SIGINT)
        process.communicate(timeout=60.0)
        codes[process.returncode] += 1
    last = run(name, out)
    told = ", ".join(f"{count} {what}" for what, count in sorted(sent.items()))
    ends = ", ".join(f"{code}: {count}" for code, count in sorted(codes.items()))
    return out, f"{told}; exit codes {ends}; at last {last.returncode}"


def ends_soon(process: subprocess.Popen[Any]) -> bool:
    """Return whether the process ends by itself within seconds."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(10.0)
    return process.poll() is not None


def children(pid: int) -> list[int]:
    """Return the processes that a process has started, and those that these have started."""
    found: list[int] = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with suppress(OSError):
            for child in map(int, task.read_text().split()):
                found += [child, *children(child)]
    return found


def turn_clock(name: str, args: argparse.Namespace) -> tuple[Path, str]:
    """Let the wall clock of all processes jump by an hour forwards, and later two hours backwards."""
    out, hook = args.out / f"{name}-clock", args.out / "clock"
    hook.mkdir(parents=True, exist_ok=True)
    (hook / "sitecustomize.py").write_text(JUMPS.format(first=2.0, second=6.0))
    path = os.pathsep.join([str(hook), os.environ.get("PYTHONPATH", "")])
    ended = run(name, out, {"PYTHONPATH": path})
    return out, f"+1 h after 2 s, -1 h after 6 s of each process; exit code {ended.returncode}"


def fill_disk(name: str, args: argparse.Namespace) -> tuple[Path, str]:
    """Run the campaign on a disk that is full after some kilobytes, then make room and continue."""
    disk = args.out / f"{name}-disk"
    disk.mkdir(parents=True, exist_ok=True)
    with mounted(disk, args.disk):
        full = run(name, disk / "campaign")
        told = [line for line in full.stderr.splitlines() if line.strip()]
        subprocess.run(["mount", "-o", "remount,size=200m", str(disk)], check=True)
        ended = run(name, disk / "campaign")
        subprocess.run(["cp", "-a", str(disk / "campaign"), str(args.out / f"{name}-disk-saved")], check=True)
    story = f"full: exit code {full.returncode}, {len(told)} lines, the last: {told[-1] if told else '-'}"
    return args.out / f"{name}-disk-saved", f"{story}; with room again: {ended.returncode}"


@contextmanager
def mounted(folder: Path, size: str) -> Iterator[None]:
    """Mount a small disk."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", str(folder)], check=False)


def compare(calm: Path, disturbed: Path) -> str:
    """Say in what a disturbed campaign differs from the undisturbed one."""
    wanted, found = rows(calm), rows(disturbed)
    keys = Counter(key(row) for row in found)
    faults = [f"missing {k}" for k in (key(row) for row in wanted) if k not in keys]
    faults += [f"{count} times {k}" for k, count in keys.items() if count > 1]
    faults += [f"torn line in {path}" for path in torn(disturbed)]
    by_key = {key(row): row for row in found}
    for row in wanted:
        other = by_key.get(key(row), row)
        faults += [f"{key(row)}: {name} {row[name]} != {other.get(name)}" for name in differing(row, other)]
    return "; ".join(faults[:5]) if faults else f"{len(found)} rows, all the same"


def key(row: Mapping[str, Any]) -> str:
    """Name a row."""
    return " ".join(str(row[name]) for name in ("variant", "world", "seed", "advisor", "preset") if name in row)


def rows(folder: Path) -> list[dict[str, Any]]:
    """Read the results; none if there are none."""
    path = folder / "results.parquet"
    return pq.read_table(path).to_pylist() if path.exists() else []


def differing(row: Mapping[str, Any], other: Mapping[str, Any]) -> Sequence[str]:
    """Return the columns in which two rows differ, apart from those of the machine."""
    return [
        name
        for name in row
        if not any(word in name for word in OF_THE_MACHINE)
        and not (row[name] == other.get(name) or str(row[name]) == str(other.get(name)))
    ]


def torn(folder: Path) -> Iterator[Path]:
    """Yield the logs with a line that is no JSON, and the records that are not whole."""
    for path in sorted(folder.rglob("*.json*")):
        try:
            text = path.read_text(encoding="utf-8")
            for part in text.splitlines() if path.suffix == ".jsonl" else [text]:
                json.loads(part)
        except ValueError:
            yield path


if __name__ == "__main__":
    begun = time.monotonic()
    main()
    print(f"{time.monotonic() - begun:.0f} s")
