"""`coral` alone in a terminal: reefs, tasks and recorded runs, and what to type next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from coral.contact.scene.task_names import shipped_tasks
from coral.reef.world.world_names import shipped_worlds
from coral.run_list import run_card, run_folders

RUNS = Path("runs")
MOST = 6
"""Runs on the page, the latest first."""
SHOWN = {"reef": ("covered", "inspected", "collisions", "simulated time"), "contact": ("success", "simulated time")}
"""Numbers of a run that the page has room for."""


def front_page(root: Path = RUNS) -> str:
    """Return the page.

    Args:
        root: Folder of the recorded runs.
    """
    cards = [run_card(folder, root) for folder in run_folders(root)[:MOST]]
    return "\n".join(
        [
            "CORAL (reef) surveys an oyster reef with an underwater robot;",
            "CoRAL (hand) moves a robot hand that has to touch things.",
            "",
            f"reefs  {' '.join(shipped_worlds())}",
            f"tasks  {' '.join(shipped_tasks())}",
            "",
            *_told(cards, root),
            "",
            *_next(cards, root),
        ]
    )


def _told(cards: list[dict[str, Any]], root: Path) -> Iterator[str]:
    if not cards:
        yield f"no run is recorded in {root}/ yet"
        return
    yield f"runs in {root}/, the latest first"
    width = max(len(card["name"]) for card in cards)
    for card in cards:
        what = ", ".join(str(card[key]) for key in ("world", "task", "variant", "advisor") if card.get(key))
        yield f"  {card['name']:<{width}}  {_numbers(card)}  ({what})"


def _numbers(card: Mapping[str, Any]) -> str:
    if not card["ended"]:
        return "no end: it is running, or was killed"
    shown = SHOWN["contact" if "task" in card else "reef"]
    return ", ".join(_number(one) for one in card["numbers"] if one["name"] in shown) or card["ended"]


def _number(one: Mapping[str, Any]) -> str:
    name, unit, value = one["name"], one["unit"], one["value"]
    if isinstance(value, bool):
        return name if value else f"no {name}"
    return f"{value:.0f} % {name}" if unit == "%" else f"{value:g} {unit or name}"


def _next(cards: list[dict[str, Any]], root: Path) -> Iterator[str]:
    """Say what to type next."""
    reports = [card["name"] for card in cards if card["report"]]
    rows = [
        ("coral reef run s1 --preset bay --seed 1", "survey a reef; --advisor desk: you decide"),
        ("coral contact run pick-box --world hand", "attempt a task; --cost FILE: with your own cost"),
        *((f"coral replay {root / cards[0]['name']}", "watch the latest run again") for _ in cards[:1]),
        *((f"xdg-open {root / name / 'report.html'}", "read its report") for name in reports[:1]),
        ("coral reef bench --variants full,pd --worlds s1 --out compared", "compare two, with intervals"),
        ("coral gui", "all of this in a browser"),
        ("coral --help", "all commands"),
    ]
    width = max(len(words) for words, _ in rows)
    yield from (f"  {words:<{width}}  {text}" for words, text in rows)
