"""How often the outer loop's diagnosis names the mistake that a sloppy advisor made, in the runs of a campaign.

    python benchmarks/contact_diagnoses.py FOLDER        # of coral contact bench --advisors sloppy:...

A mistake is logged with the answer that has it, a diagnosis when an episode is stuck. A diagnosis names a mistake where
its text says what is wrong; BLAMES has the pairs.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

PART = {
    "physical-parameters": "parameters",
    "parameter-repair": "parameters",
    "cost-function": "plan",
    "cost-repair": "plan",
    "contact-regions": "regions",
}
BLAMES = {
    "settled": ("sign", "weight", "missing-term", "wrong-object", "goal-off"),
    "stage-never-ends": ("never-done",),
    "not-gripped": ("sign", "missing-term", "early-lift"),
    "blocked": ("sign", "wrong-side", "wrong-face", "goal-off"),
    "moved-otherwise": ("parameters",),
    "not-reached": ("wrong-side", "wrong-face", "goal-off"),
    "no-progress": ("wrong-side", "wrong-face"),
    "slipped": ("early-lift",),
}
"""Diagnosis to the mistakes that its text names: "slipped" tells of a grasp that was none, "not-moved" of nothing."""


def stuck_with(events: Iterable[Mapping[str, Any]]) -> list[tuple[str, tuple[str, ...]]]:
    """Each diagnosis of an episode, with the mistakes in force then."""
    held: dict[str, str] = {}
    found = []
    for event in events:
        if event["event"] == "verdict" and event["verdict"] == "accepted":
            made = [fault.removeprefix("sloppy-") for fault in event.get("faults", ()) if fault.startswith("sloppy-")]
            held[PART.get(event["kind"], event["kind"])] = made[0] if made else ""
        elif event["event"] == "stuck":
            found.append((str(event["diagnosis"]), tuple(filter(None, held.values()))))
    return found


def named(stuck: tuple[str, tuple[str, ...]]) -> bool:
    """Whether a diagnosis names a mistake in force."""
    diagnosis, mistakes = stuck
    return bool(set(mistakes) & set(BLAMES.get(diagnosis, ())))


def main() -> None:
    """Print a line for each episode that got stuck, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="of a campaign")
    total = first = ever = mended = mended_first = 0
    for path in sorted(parser.parse_args().folder.glob("runs/*/events.jsonl")):
        with open(path, encoding="utf-8") as lines:
            events = [json.loads(line) for line in lines]
        found = stuck_with(events)
        if not found:
            continue
        wrong = any(mistakes for _, mistakes in found)
        mended += wrong and events[-1].get("reason") == "success"
        mended_first += wrong and events[-1].get("reason") == "success" and named(found[0])
        total += wrong
        first += wrong and named(found[0])
        ever += wrong and any(map(named, found))
        said = "; ".join(f"{diagnosis} ({', '.join(mistakes) or 'no mistake'})" for diagnosis, mistakes in found)
        print(f"{path.parent.name}: {events[-1].get('reason', '?')}: {said}")
    print(f"stuck episodes with a mistake: {total}; first diagnosis names it: {first}; one of them does: {ever}")
    print(f"of them repaired to success: {mended}; first diagnosis names it: {mended_first}")


if __name__ == "__main__":
    main()
