"""What the recorded reader's answers are worth, and what the rules would have answered to the same questions.

    python benchmarks/recorded_reader.py

Counts answers and refusals of all recordings that come with the package. In the six reef missions whose reader had seen
nothing but prompt and pictures, accepted answers are scored as `coral advisor bench` scores them: seconds until
everything is inspected by the fastest order on the true map, against the best dot or waypoint. What was left to inspect
is what the mission had not counted when it asked. The rules get the facts of the same question and the refusals so far;
whether the verifiers would have taken their answer is not known, so this compares choices, not missions.
"""

from __future__ import annotations

import argparse
import gzip
import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coral.advisor.question import Rejection
from coral.advisor.recorded_attempts import SHIPPED, Attempted, read_attempts, shipped_recordings
from coral.exam.item import ANSWERS
from coral.exam.reef_regret import THINKING_S, TrueReef
from coral.exam.worth import share_left
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.world.geometry import Pose, to_world
from coral.reef.world.world import load_world

DATA = Path(__file__).parents[1] / "tests" / "data" / "recordings"
TIE_S = 0.05
"""Losses are known to a tenth of a second."""


@dataclass(frozen=True)
class Choice:
    """An accepted answer, and the rules' answer to the same question."""

    kind: str
    """Of question."""
    lost_s: float
    """What the recorded answer loses against the best one; inf where no way leads there."""
    rules_lost_s: float
    """What the rules' answer loses."""


def attempts(name: str) -> list[Attempted]:
    """Lines of a shipped recording."""
    return read_attempts(SHIPPED / f"{name}.jsonl", name)


def verdicts(names: Sequence[str]) -> Counter[tuple[str, str, str]]:
    """How often which kind of question got which verdict and code."""
    return Counter((a["kind"], a["verdict"], a["code"]) for name in names for a in attempts(name))


def choices(run: str) -> Iterator[Choice]:
    """The accepted answers of a reef mission, as long as something was left."""
    covered_s: Mapping[str, float] = json.loads((DATA / "reef-covered.json").read_text(encoding="utf-8"))[run]
    world = load_world(run.removeprefix("reef-"))
    reef = TrueReef(world)
    refusals: list[Rejection] = []
    for entry, facts in zip(attempts(run), _facts(run), strict=True):
        if entry["attempt"] == 0:
            refusals = []
        left = [k for k, c in enumerate(world.clusters) if covered_s.get(c.name, np.inf) > entry["asked_at_s"]]
        if entry["verdict"] == "accepted" and left:
            yield _choice(entry, facts, refusals, reef, left)
        elif entry["verdict"] == "rejected":
            refusals.append(Rejection(code=entry["code"], reason=entry["reason"], details=entry["details"]))


def clean_missions() -> list[str]:
    """Reef missions whose reader had seen nothing but prompt and pictures."""
    return sorted(json.loads((DATA / "reef-covered.json").read_text(encoding="utf-8")))


def worth(lost_s: Sequence[float]) -> float:
    """Mean worth, as the bench has it: 1 for the best answer, 0 for one that loses the time of another question."""
    return float(np.mean([share_left(one, THINKING_S) for one in lost_s]))


def _choice(
    entry: Attempted, facts: Mapping[str, Any], refusals: Sequence[Rejection], reef: TrueReef, left: Sequence[int]
) -> Choice:
    kind = entry["kind"]
    options = facts["centroids"] if kind == "reef-centroid" else facts["options"]
    answers = (ANSWERS[kind].model_validate(entry["answer"]), REEF_RULES[kind](facts, refusals))
    points = {_label(kind, option): (option["forward_m"], option["left_m"]) for option in options}
    labels = [_label(kind, answer.model_dump()) for answer in answers]
    pose = Pose(**facts["robot"])
    costs = reef.seconds(pose, np.array([to_world(pose, *point) for point in points.values()]), left)
    seconds = dict(zip(points, costs, strict=True))
    lost = [float(seconds[label] - min(costs)) for label in labels]
    return Choice(kind, *lost)


def _label(kind: str, answer: Mapping[str, Any]) -> tuple[int, ...]:
    if kind == "reef-waypoint":
        return answer["forward_m"], answer["left_m"]
    return (answer["index"] if "index" in answer else answer["selected_centroid_index"],)


def _facts(run: str) -> list[Mapping[str, Any]]:
    with gzip.open(DATA / "reef-facts.jsonl.gz", "rt", encoding="utf-8") as lines:
        return [_of_today(entry["facts"]) for entry in map(json.loads, lines) if entry["run"] == run]


def _of_today(facts: Mapping[str, Any]) -> Mapping[str, Any]:
    """Add what questions tell today: then, nothing of a cluster had been seen from near until it was visited."""
    return {**facts, "centroids": [{**c, "left_m2": c["area_m2"]} for c in facts["centroids"]]}


def main() -> None:
    """Print both tables."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    for names in (clean_missions(), [name for name in shipped_recordings() if name.startswith("contact-")]):
        print(", ".join(names))
        for (kind, verdict, code), count in sorted(verdicts(names).items()):
            print(f"  {count:3d} {kind}: {verdict} {code}".rstrip())
    made = [choice for run in clean_missions() for choice in choices(run)]
    for kind in REEF_RULES:
        of_kind = [choice for choice in made if choice.kind == kind]
        mine, rules = [c.lost_s for c in of_kind], [c.rules_lost_s for c in of_kind]
        better = sum(a < b - TIE_S for a, b in zip(mine, rules, strict=True))
        worse = sum(a > b + TIE_S for a, b in zip(mine, rules, strict=True))
        print(
            f"{kind}: {len(of_kind)} accepted answers; worth {worth(mine):.2f}, the rules' {worth(rules):.2f}; loses "
            f"{np.median(mine):.1f} s, the rules' {np.median(rules):.1f} s (medians); {better} better, {worse} worse"
        )


if __name__ == "__main__":
    main()
