# ruff: noqa: E501 - a case is a line
"""Hostile files given to the commands that read them: what each says, and what it costs. A Markdown table.

Usage: python benchmarks/refusals.py [--only WORDS] [--out FOLDER]

Each row is a process of its own. A file that is refused must cost one line, exit code 2, less than 500 MB of memory and
less than 5 s of processor time, imports included; exit code 1 if one costs more. A file may also be read: that may take longer.
"""

from __future__ import annotations

import argparse
import gzip
import io
import json
import multiprocessing
import os
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

MOST_MB, MOST_S = 500.0, 5.0
Make = Callable[[Path], object]


@dataclass(frozen=True)
class Case:
    """A hostile file."""

    name: str
    words: str
    """The command; {f} is the folder of the case, {run}, {bag} and {pictures} are copies of a whole one in it."""
    make: Make
    """Makes it in the folder."""
    read: bool = False
    """Whether it is read, and not refused."""


def png(width: int, height: int) -> bytes:
    """Make a PNG file that is far smaller than its picture."""
    row, packer = bytes(3 * width + 1), zlib.compressobj(9)
    data = b"".join([*(packer.compress(row) for _ in range(height)), packer.flush()])

    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def text(name: str, content: str | bytes) -> Make:
    """Write a file."""
    return lambda f: (f / name).write_bytes(content.encode() if isinstance(content, str) else content)


def line(name: str, content: str) -> Make:
    """Append a line to a file."""

    def make(f: Path) -> None:
        with (f / name).open("a", encoding="utf-8") as out:
            out.write(content + "\n")

    return make


def changed(name: str, old: str, new: str) -> Make:
    """Change the first occurrence of a text in a file."""

    def make(f: Path) -> None:
        content = (f / name).read_text(encoding="utf-8")
        assert old in content, (name, old)
        (f / name).write_text(content.replace(old, new, 1), encoding="utf-8")

    return make


def pipe(name: str) -> Make:
    """Put a named pipe without a writer in place of a file."""

    def make(f: Path) -> None:
        (f / name).unlink(missing_ok=True)
        os.mkfifo(f / name)

    return make


def device(name: str) -> Make:
    """Put a link to an endless device in place of a file."""

    def make(f: Path) -> None:
        (f / name).unlink(missing_ok=True)
        (f / name).symlink_to("/dev/zero")

    return make


def packed(name: str, megabytes: int) -> Make:
    """Write a gzip file of one long line."""

    def make(f: Path) -> None:
        with gzip.open(f / name, "wb", compresslevel=1) as out:
            for _ in range(megabytes):
                out.write(b" " * 1_000_000)

    return make


def arrays(name: str) -> Make:
    """Write an .npz file of a gigabyte in a megabyte."""

    def make(f: Path) -> None:
        head = io.BytesIO()
        np.lib.format.write_array_header_1_0(head, {"descr": "|u1", "fortran_order": False, "shape": (10**9,)})
        with zipfile.ZipFile(f / name, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("head.npy", "w") as out:
            out.write(head.getvalue())
            for _ in range(1000):
                out.write(bytes(1_000_000))

    return make


def sparse(name: str) -> Make:
    """Write a file of 50 GB that takes no room."""

    def make(f: Path) -> None:
        with (f / name).open("wb") as out:
            out.truncate(50_000_000_000)

    return make


def sqlite(name: str, *statements: str) -> Make:
    """Write an SQLite file."""

    def make(f: Path) -> None:
        (f / name).unlink(missing_ok=True)
        with sqlite3.connect(f / name) as base:
            for statement in statements:
                base.execute(statement)
        base.close()

    return make


def chunk_of_zeros(f: Path) -> None:
    """Write an MCAP file with a chunk of 2 GB in 60 kB."""
    import zstandard

    data = zstandard.ZstdCompressor().compress(bytes(50_000_000)) * 40
    chunk = struct.pack("<QQQII4sQ", 0, 0, 2_000_000_000, 0, 4, b"zstd", len(data)) + data
    header = struct.pack("<BQI4sI", 1, 12, 4, b"ros2", 0)
    end = struct.pack("<BQI", 0x0F, 4, 0) + struct.pack("<BQQQI", 2, 20, 0, 0, 0)
    magic = b"\x89MCAP0\r\n"
    (f / "x.mcap").write_bytes(magic + header + struct.pack("<BQ", 6, len(chunk)) + chunk + end + magic)


def ros1_chunk(f: Path) -> None:
    """Write a ROS 1 bag with a chunk of 101 MB in some kilobytes."""
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    bag = Writer(f / "x.bag")
    bag.set_compression(Writer.CompressionFormat.BZ2)
    with bag as writer:
        topic = writer.add_connection("/odometry", "std_msgs/msg/String", typestore=store)
        message = store.types["std_msgs/msg/String"](data="a" * 101_000_000)
        writer.write(topic, 1, store.serialize_ros1(message, "std_msgs/msg/String"))


MERGES = "a0: &a0 {k: 1}\n" + "".join(f"a{n}: &a{n} {{<<: [{', '.join([f'*a{n - 1}'] * 9)}]}}\n" for n in range(1, 12))
EVENT = '{"step": 1, "t": 0.1, "event": "note", "x": %s}'
FACES = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 99999999999999999999\n"
TASK = """format: coral-contact/1
name: mesh
title: Mesh
instruction: Slide it.
time_limit_s: 1
table: {size: [0.8, 0.8, 0.05], center: [0, 0]}
objects:
  - {name: thing, label: thing, parts: [{shape: mesh, file: x.obj, size: [1, 1, 1]}], mass_kg: [0.2, 0.3],
     friction: [0.3, 0.6], x: [-0.1, 0.0], y: [-0.08, 0.08], color: [0.2, 0.35, 0.7]}
places: {goal: [0.15, 0, 0.045]}
success: {hold_s: 0.3, conditions: [{kind: at, object: thing, place: goal, tolerance_m: 0.02}]}
"""
MAP = "reef map {pictures} --perception rgb --out {f}/out"
BAG = "reef map {bag} --out {f}/out"
REPORT = "report {run}"
CASES = [
    Case("YAML, 434 bytes of merge keys: a world", "reef run {f}/x.yaml --out {f}/out", text("x.yaml", MERGES)),
    Case("YAML, merge keys: a task", "contact tasks {f}/x.yaml", text("x.yaml", MERGES)),
    Case("YAML, merge keys: a camera", "reef map {pictures} --camera {f}/x.yaml --out {f}/out", text("x.yaml", MERGES)),
    Case("YAML, merge keys: a configuration", "reef run s1 --config {f}/x.yaml --out {f}/out", text("x.yaml", MERGES)),
    Case("YAML, 15 000 levels", "reef run {f}/x.yaml --out {f}/out", text("x.yaml", "[" * 15_000)),
    Case("a part of a log that is a pipe", REPORT, pipe("run/events.0001.jsonl"), read=True),
    Case("a part of a log that is a device", REPORT, device("run/events.0001.jsonl"), read=True),
    Case("a part of a log, 1 GB in a line of 1 MB", REPORT, packed("run/events.0001.jsonl.gz", 1000), read=True),
    Case("a log that is a pipe", REPORT, pipe("run/events.jsonl"), read=True),
    Case("an MCAP chunk of 2 GB in 60 kB", "reef map {f}/x.mcap --out {f}/out", chunk_of_zeros),
    Case("an MCAP file of 8 bytes", "reef map {f}/x.mcap --out {f}/out", text("x.mcap", b"\x89MCAP0\r\n")),
    Case("a ROS 1 bag with a chunk of 101 MB", "reef map {f}/x.bag --out {f}/out", ros1_chunk),
    Case("survey.npz, 1 GB in 1 MB", "reef sail s1 --resume {run} --yes --no-preflight --out {f}/out", arrays("run/survey.npz")),
    Case("a picture of 600 megapixels", MAP, lambda f: (f / "pictures/000002.jpg").write_bytes(png(30_000, 20_000))),
    Case("an SQLite memory with a generated column", "memory list --file {f}/m.sqlite",
         sqlite("m.sqlite", "CREATE TABLE experience (id TEXT PRIMARY KEY, record TEXT GENERATED ALWAYS AS (hex(zeroblob(400000000))))",
                "INSERT INTO experience (id) VALUES ('a')")),
    Case("an SQLite memory that is a view", "memory list --file {f}/m.sqlite",
         sqlite("m.sqlite", "CREATE VIEW experience AS SELECT 'a' AS id, hex(zeroblob(400000000)) AS record")),
    Case("a memory to import of 50 GB, sparse", "memory import {f}/m.json --file {f}/m.sqlite", sparse("m.json")),
    Case("a table of poses with 1e300", MAP, changed("pictures/poses.csv", "\n0.5", "\n1e300")),
    Case("a table of poses with nan", MAP, lambda f: poses(f, lambda rows: [rows[0], rows[1], [rows[2][0], "nan", *rows[2][2:]], *rows[3:]])),
    Case("a table of poses with a far place", MAP, lambda f: poses(f, lambda rows: [*rows[:2], [rows[2][0], "1e8", *rows[2][2:]], *rows[3:]])),
    Case("a trajectory with 1e300: the report", REPORT, lambda f: last_row(f, "1e300"), read=True),
    Case("a trajectory with nan: the report", REPORT, lambda f: last_row(f, "nan"), read=True),
    Case("an event with 1e300: the report", REPORT, line("run/events.jsonl", EVENT % "1e300"), read=True),
    Case("an event with a list for its time", REPORT, line("run/events.jsonl", '{"step": [], "t": {}, "event": "question"}'), read=True),
    Case("an event of 100 000 levels", REPORT, line("run/events.jsonl", EVENT % ("[" * 100_000 + "]" * 100_000)), read=True),
    Case("metrics of other types", REPORT, text("run/metrics.json", '{"coverage": [], "sim_time_s": "x", "collisions": 1e300}'), read=True),
    Case("metrics of 1 000 000 levels", REPORT, text("run/metrics.json", "[" * 1_000_000), read=True),
    Case("a broken gzip part", REPORT, text("run/events.0001.jsonl.gz", b"\x1f\x8b\x08\0broken"), read=True),
    Case("maps and classes of a run in colours", REPORT, lambda f: colours(f), read=True),
    Case("a world of a run with a huge area", REPORT, changed("run/world.yaml", "size_m:", "size_m: [1.0e+300, 1.0e+300]\nold:"), read=True),
    Case("a bag's table of contents of 30 000 levels", BAG, text("bag/metadata.yaml", "[" * 30_000)),
    Case("a bag whose file is no MCAP", BAG, lambda f: [p.write_bytes(b"no") for p in (f / "bag").glob("*.mcap")]),
    Case("a mesh with an index of 20 digits", "contact tasks {f}/t.yaml", lambda f: (text("t.yaml", TASK)(f), text("x.obj", FACES)(f))),
    Case("a mesh of 50 GB, sparse", "contact tasks {f}/t.yaml", lambda f: (text("t.yaml", TASK)(f), sparse("x.obj")(f))),
    Case("a mesh that is a device", "contact tasks {f}/t.yaml", lambda f: (text("t.yaml", TASK)(f), device("x.obj")(f))),
    Case("a network that is no ONNX file", "reef map {pictures} --perception {f}/x.onnx --out {f}/out", text("x.onnx", b"\x08\xff" * 100)),
    Case("a survey file with a ring of text", "reef sail {f}/s.yaml --check", text("s.yaml", "format: coral-survey/1\nname: x\nsize_m: [20, 20]\nstart: {x: 2, y: 2}\ngeofence: {metres: abc}\n")),
    Case("a last row without an end of line", MAP, lambda f: cut(f, 1), read=True),
    Case("a table with a BOM", MAP, lambda f: recode(f, lambda b: b"\xef\xbb\xbf" + b), read=True),
    Case("a table with semicolons", MAP, lambda f: recode(f, lambda b: b.replace(b",", b";")), read=True),
]  # fmt: skip


def poses(f: Path, change: Callable[[list[list[str]]], list[list[str]]]) -> None:
    """Change the rows of the table of poses."""
    path = f / "pictures/poses.csv"
    rows = change([row.split(",") for row in path.read_text(encoding="utf-8").splitlines()])
    path.write_text("".join(",".join(row) + "\n" for row in rows), encoding="utf-8")


def colours(f: Path) -> None:
    """Put colour pictures in place of those that hold a class for every pixel."""
    for path in (f / "run/frames").glob("*.png"):
        path.write_bytes(png(240, 240))


def recode(f: Path, change: Callable[[bytes], bytes]) -> None:
    """Change the bytes of the table of poses."""
    path = f / "pictures/poses.csv"
    path.write_bytes(change(path.read_bytes()))


def cut(f: Path, count: int) -> None:
    """Cut off the last bytes of the table of poses."""
    recode(f, lambda content: content[:-count])


def last_row(f: Path, value: str) -> None:
    """Append a row of one value to the trajectory."""
    path = f / "run/trajectory.csv"
    columns = path.read_text(encoding="utf-8").splitlines()[0].count(",")
    line("run/trajectory.csv", ",".join(["9999"] + [value] * columns))(f)


def examples(folder: Path) -> None:
    """Make a run, a bag and a folder of pictures."""
    coral = [sys.executable, "-m", "coral"]
    limits = ["--cfg.time-limit-s", "4", "--perception", "rgb", "--no-preflight", "--quiet"]
    for words in (
        ["reef", "run", "s1", *limits, "--out", str(folder / "run")],
        ["export", str(folder / "run"), "--to", "bag", "--out", str(folder / "bag")],
        ["export", str(folder / "run"), "--to", "pictures", "--out", str(folder / "pictures")],
    ):
        subprocess.run([*coral, *words], check=True, stdout=subprocess.DEVNULL)


def measure(case: Case, examples_in: Path, folder: Path) -> tuple[int, float, float, list[str]]:
    """Run a case; return exit code, memory (MB), processor time (s) and the lines of standard error."""
    folder.mkdir()
    for name in ("run", "bag", "pictures"):
        if f"{{{name}}}" in case.words:
            shutil.copytree(examples_in / name, folder / name)
    # What a process has taken before it becomes another one counts as the other's.
    making = multiprocessing.get_context("fork").Process(target=case.make, args=(folder,))
    making.start()
    making.join()
    assert not making.exitcode, case.name
    places = {"f": folder, **{name: folder / name for name in ("run", "bag", "pictures")}}
    words = case.words.format(**places).split()
    with (folder / "told").open("wb") as told:
        process = subprocess.Popen([sys.executable, "-m", "coral", *words], stdout=subprocess.DEVNULL, stderr=told)
        _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    lines = (folder / "told").read_text(encoding="utf-8", errors="replace").replace(f"{folder}/", "").splitlines()
    return process.returncode, used.ru_maxrss / 1024, used.ru_utime + used.ru_stime, lines


def main() -> int:
    """Run the cases and print the table."""
    flags = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    flags.add_argument("--only", default="")
    flags.add_argument("--examples", type=Path, help="folder with a run, a bag and pictures of an earlier call")
    chosen = flags.parse_args()
    failed = 0
    print("| file | code | memory (MB) | time (s) | it says |\n|---|---:|---:|---:|---|", flush=True)
    with tempfile.TemporaryDirectory() as made:
        home = chosen.examples or Path(made) / "examples"
        if not home.exists():
            home.mkdir(parents=True)
            examples(home)
        for number, case in enumerate(c for c in CASES if chosen.only in c.name):
            code, memory, seconds, lines = measure(case, home, Path(made) / f"case-{number}")
            told = next((each for each in lines if each.startswith("coral: ")), "read" if not code else str(lines[-1:]))
            right = code == (0 if case.read else 2) and (case.read or len(lines) == 1)
            good = right and memory < MOST_MB and (case.read or seconds < MOST_S)
            failed += not good
            told = json.dumps(told, ensure_ascii=False)[1:-1].replace("|", "\\|")[:160]
            print(
                f"| {case.name} | {code} | {memory:.0f} | {seconds:.1f} | {'' if good else '**!** '}{told} |",
                flush=True,
            )
            shutil.rmtree(Path(made) / f"case-{number}", ignore_errors=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
