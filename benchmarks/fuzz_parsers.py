"""Damaged files and messages into every parser of foreign input: read, or refused as documented.

Usage: python benchmarks/fuzz_parsers.py [--minutes 5] [--examples N] [--only WORDS] [--seed N] [--out FOLDER]

Hypothesis damages valid examples: bytes removed, repeated, replaced by others or by words that have broken parsers. A
finding is an undocumented exception, an example that takes over 10 s or 500 MB, or a process that dies; each place is
told once, with the smallest example that Hypothesis finds, which is kept in the folder. Exit code 1 if there are any.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import random
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from fuzz_binary import binary_parsers
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

import coral
from coral.errors import InputError
from coral.reef.sea.recorded_camera import RecordedCamera
from coral.reef.vehicle.sensing import Stamped

HOME = Path(coral.__file__).parent
LONGEST_S = 10
"""Longest time for one example (s)."""
MOST_MB = 500
"""Most memory besides what the parsers have already taken."""
ROUND_S = 15.0
"""Time for a parser until it is the next one's turn (s)."""
WORDS = [
    b"null", b"nan", b".nan", b"-.inf", b"1e400", b"-1", b"0", b"true", b"[]", b"{}", b"[[[[[[[[", b"9" * 400, b"\x00",
    b"\xff\xfe", b"\xed\xa0\x80", b"\\ud800", b"&a [*a]", b"*a", b"!!python/object:os.system", b"<<: {a: 1}", b"---",
    b'"', b"'", b"\n", b": ", b", ", b"- ", b"\x1b[2J", "\u202e".encode(), b"..", b"/dev/zero", b"2026-01-01", b"0x7f",
    b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff", b"\x80\x00\x00\x00",
]  # fmt: skip
SURVEY = b"""format: coral-survey/1
name: harbour
size_m: [22, 22]
origin: {latitude: 54.33, longitude: 10.18}
start: {x: 4, y: 5, theta: 0.0}
depth_m: 1.5
geofence: {metres: [[1, 1], [21, 1], [21, 21], [1, 21]]}
keep_out:
  - {name: pier, degrees: [[54.33, 10.1802], [54.33, 10.1803], [54.33003, 10.1803], [54.33003, 10.1802]]}
"""
PROBLEM = b"""(define (problem P) (:domain robosuite) (:language Pick the soup)
 (:regions (a (:target floor) (:ranges ((-0.1 -0.2 0.1 0.2)))))
 (:fixtures floor - floor) (:objects soup_1 - soup basket_1 - basket) (:obj_of_interest soup_1 basket_1)
 (:init (On soup_1 floor_a)) (:goal (And (In soup_1 basket_1_contain_region))))
"""


@dataclass(frozen=True)
class Parser:
    """A parser and what it may be given."""

    read: Callable[[Path], object]
    """Reads a file, or the message in it."""
    examples: tuple[bytes, ...]
    refusals: tuple[type[Exception], ...] = (InputError,)
    """Documented exceptions."""
    suffix: str = ""


def parsers() -> dict[str, Parser]:
    """Return all parsers by name."""
    import numpy as np

    from coral.advisor.parse import parse_answer
    from coral.advisor.question import BadAnswer
    from coral.advisor.replay import ReplayAdvisor
    from coral.config import read_config
    from coral.contact.cost_program import CostError
    from coral.contact.cost_program.parse import parse as parse_cost
    from coral.contact.episode.own_cost import read_cost_file
    from coral.contact.libero.problem import read_problem
    from coral.contact.plan.cost_plan import PlanAnswer
    from coral.contact.policy.wire import WireError, decode, encode
    from coral.contact.scene.task_file import load_task_file
    from coral.desk.inbox import Inbox
    from coral.reef.decide.answers import CentroidChoice
    from coral.reef.mission.mission_cfg import MissionCfg
    from coral.reef.pilot.checks import UnfitMeasurement
    from coral.reef.recordings.picture_folder import read_folder
    from coral.reef.sea.recorded_camera import read_camera
    from coral.reef.sea.survey_file import read_survey
    from coral.reef.world.world import load_world
    from coral.view.run import RunFolder

    def of(*paths: str, most: int = 20_000) -> tuple[bytes, ...]:
        return tuple((HOME / path).read_bytes()[:most] for path in paths)

    camera = example_camera()
    recording = b"\n".join((HOME / "advisor/recordings/reef-e1.jsonl").read_bytes().splitlines()[:2]) + b"\n"
    cost = b"""def state_cost(self):
    d = np.linalg.norm(self.ee_pos - self.box_pos)
    return {'reach': d, 'lift': 2 * self.time}
"""
    tasks = of("contact/scene/tasks/pick-box.yaml", "contact/scene/tasks/push-force.yaml")
    tables = b"t,x,y,yaw,rgb\n0.0,1.0,2.0,0.1,1.png\n", b"t,lat,lon,heading\n0,54.3,10.1,90\n"
    event = b'{"t": 1.0, "kind": "decision", "goal": [1.0, 2.0], "source": "advisor"}\n'
    chosen = b'```json\n{"selected_centroid_index": 3, "then": [1, 2], "reason": "near"}\n```'
    focal = b"width: 640\nheight: 480\nfx: 400.0\nfy: 400.0\ncx: 320.0\ncy: 240.0\n"
    question = {"id": "1-pick", "kind": "pick", "prompt": "Which?", "images": [], "rejections": [], "facts": {}}
    question["answer_schema"] = CentroidChoice.model_json_schema()

    def read_question(path: Path) -> None:
        folder = path.parent / "inbox" / "1-pick"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "question.json").write_bytes(path.read_bytes())
        (folder / "answer.json").write_bytes(path.read_bytes())
        Inbox(folder.parent).entries()
        json.dumps(Inbox(folder.parent).missions())

    def read_poses(path: Path) -> object:
        (path.parent / "poses.csv").write_bytes(path.read_bytes())
        return read_folder(path.parent, camera)

    def read_events(path: Path) -> object:
        for name in ("events.jsonl", "attempts.jsonl", "trajectory.csv", "metrics.json", "config.yaml"):
            (path.parent / name).write_bytes(path.read_bytes())
        return RunFolder.read(path.parent)

    return {
        "world": Parser(load_world, of("reef/world/worlds/l1.yaml", most=6000), suffix=".yaml"),
        "task": Parser(load_task_file, tasks, suffix=".yaml"),
        "configuration": Parser(
            lambda path: read_config(path, MissionCfg()), (b"time_limit_s: 30\npilot: {budget: {deadline_s: 5}}\n",)
        ),
        "survey": Parser(read_survey, (SURVEY,)),
        "camera": Parser(read_camera, (focal,)),
        "poses": Parser(read_poses, tables),
        "run": Parser(read_events, (event, b"t,x,y\n0,1,2\n0.1,1,2\n")),
        "recording": Parser(ReplayAdvisor, (recording,)),
        "question": Parser(read_question, (json.dumps(question).encode(),)),
        "answer": Parser(
            lambda path: parse_answer(path.read_bytes().decode("utf-8", "surrogateescape"), CentroidChoice),
            (chosen, b"{'then': []}"),
            (BadAnswer,),
        ),
        "plan": Parser(
            lambda path: parse_answer(path.read_bytes().decode("utf-8", "replace"), PlanAnswer),
            (b"```python\n" + cost + b"```", json.dumps({"code": cost.decode()}).encode()),
            (BadAnswer,),
        ),
        "cost file": Parser(read_cost_file, (b"code: |\n  " + cost.replace(b"\n", b"\n  "),), suffix=".yaml"),
        "cost program": Parser(
            lambda path: parse_cost(path.read_bytes().decode("utf-8", "replace")), (cost,), (CostError,)
        ),
        "problem": Parser(read_problem, (PROBLEM,), suffix=".bddl"),
        "policy message": Parser(
            lambda path: decode(path.read_bytes()),
            (encode({"actions": np.zeros((2, 7), np.float32), "state": [1.0, "a"]}),),
            (WireError,),
        ),
        **sonar_parsers(UnfitMeasurement),
        **{name: Parser(*given) for name, given in binary_parsers(HOME).items()},
    }  # fmt: skip


def example_camera() -> RecordedCamera:
    """Return a camera for the tables of poses."""
    from coral.reef.sea.recorded_camera import read_camera

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "camera.yaml"
        path.write_text("width: 64\nheight: 48\n")
        return read_camera(path)


def sonar_parsers(refused: type[Exception]) -> dict[str, Parser]:
    """Return the parsers of a Sonar 3D-15's packets, if its decoder is installed."""
    import numpy as np

    from coral.reef.sea.sonar_packets import decode_packet, encode_packet, load_protocol
    from coral.reef.vehicle.range_image import RangeImage

    with suppress(InputError):
        load_protocol()
        ping = Stamped(1.0, RangeImage(np.full((4, 8), 2.0), 90.0, 40.0))
        packets = (encode_packet(ping),)
        return {"sonar packet": Parser(lambda path: decode_packet(path.read_bytes()), packets, (refused,))}
    return {}


@st.composite
def damaged(draw: st.DrawFn, examples: tuple[bytes, ...]) -> bytes:
    """Draw an example with up to six faults."""
    data = bytearray(draw(st.sampled_from(examples)))
    for _ in range(draw(st.integers(1, 6))):
        start = draw(st.integers(0, len(data)))
        end = min(len(data), start + draw(st.sampled_from([0, 1, 1, 2, 4, 12, 200])))
        new = draw(
            st.one_of(st.just(b""), st.sampled_from(WORDS), st.binary(max_size=6), st.just(bytes(data[start:end]) * 3))
        )
        data[start:end] = new
    return bytes(data)


class TooLong(Exception):
    """An example took too long."""


def _alarm(number: int, frame: FrameType | None) -> None:
    raise TooLong


def try_parser(parser: Parser, name: str, seconds: float, folder: Path, number: int, examples: int = 0) -> None:
    """Try one parser in this process; write a JSON line for each finding, and one at the end, into the folder."""
    random.seed(number)
    sizes = Path("/proc/self/statm")
    if sizes.exists():
        taken = int(sizes.read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (taken + MOST_MB * 1_000_000,) * 2)
    signal.signal(signal.SIGALRM, _alarm)
    place = folder / f"last{parser.suffix}"
    end, tried, known = time.monotonic() + seconds, 0, set()
    failing: list[tuple[str, str, bytes]] = []

    def check(data: bytes) -> None:
        nonlocal tried
        tried += 1
        place.write_bytes(data)
        signal.alarm(LONGEST_S)
        try:
            parser.read(place)
        except parser.refusals:
            pass
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)
            ours = [line for line in where if str(HOME) in line.filename] or where
            found = f"{type(error).__name__} at {Path(ours[-1].filename).name}:{ours[-1].lineno}"
            if found not in known:
                failing.append((found, str(error)[:200], data))
                raise
        finally:
            signal.alarm(0)

    bounded = settings(
        max_examples=examples or 200,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.generate, Phase.shrink],
        report_multiple_bugs=False,
    )
    with (folder / "told.jsonl").open("w") as told:
        while time.monotonic() < end and not (examples and tried):
            failing.clear()
            try:
                seed(random.randrange(2**32))(bounded(given(data=damaged(parser.examples))(check)))()
            except BaseException:
                if not failing:
                    raise
                found, text, data = failing[-1]
                known.add(found)
                kept = folder / f"{name.replace(' ', '-')}-{len(known)}{parser.suffix}"
                kept.write_bytes(data)
                print(json.dumps({"found": found, "text": text, "example": str(kept)}), file=told, flush=True)
        print(json.dumps({"tried": tried}), file=told)


def warm(parser: Parser) -> None:
    """Read the examples once, so that nothing is imported or compiled later."""
    with tempfile.TemporaryDirectory() as folder, suppress(*parser.refusals):
        for example in parser.examples:
            path = Path(folder) / f"last{parser.suffix}"
            path.write_bytes(example)
            parser.read(path)


def main() -> int:
    """Give every parser its turn until the time is up."""
    flags = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    flags.add_argument("--minutes", type=float, default=5.0)
    flags.add_argument("--examples", type=int, default=0, help="so many of each parser, whatever the time")
    flags.add_argument("--only", default="")
    flags.add_argument("--seed", type=int, default=None, help="by default another one each time")
    flags.add_argument("--out", type=Path, default=Path("fuzz"))
    chosen = flags.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    known = {name: parser for name, parser in parsers().items() if not chosen.only or name in chosen.only.split(",")}
    names = list(known)
    first = random.randrange(2**32) if chosen.seed is None else chosen.seed
    for parser in known.values():
        warm(parser)
    end, tried, findings = time.monotonic() + 60.0 * chosen.minutes, dict.fromkeys(names, 0), {}
    turns = 0
    while time.monotonic() < end and names:
        name = names[turns % len(names)]
        turns += 1
        if chosen.examples and turns > len(names):
            break
        seconds = min(ROUND_S, end - time.monotonic(), 60.0 * chosen.minutes / len(names))
        with tempfile.TemporaryDirectory() as made:
            folder = Path(made)
            # A fork shares what has been imported; it may die.
            child = multiprocessing.get_context("fork").Process(
                target=try_parser, args=(known[name], name, seconds, folder, first + turns, chosen.examples)
            )
            child.start()
            child.join()
            for line in (folder / "told.jsonl").read_text().splitlines():
                told = json.loads(line)
                if "tried" in told:
                    tried[name] += told["tried"]
                elif (name, told["found"]) not in findings:
                    kept = chosen.out / Path(told["example"]).name
                    kept.write_bytes(Path(told["example"]).read_bytes())
                    findings[name, told["found"]] = told["text"]
                    print(f"{name}: {told['found']}: {told['text']!r} ({kept})", flush=True)
            if child.exitcode:
                kept = chosen.out / f"{name.replace(' ', '-')}-death"
                for last in folder.glob("last*"):
                    kept.write_bytes(last.read_bytes())
                findings[name, "death"] = f"exit code {child.exitcode}"
                print(f"{name}: the process ended with {child.exitcode} ({kept})", flush=True)
    print("\n| parser | examples | findings |\n|---|---|---|")
    for name in names:
        print(f"| {name} | {tried[name]} | {sum(key[0] == name for key in findings)} |")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
