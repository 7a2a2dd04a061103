"""The table of missions in words: who fulfilled them, at what price."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from coral.campaign.measures import Row
from coral.campaign.presets import by_preset
from coral.campaign.spec import NO_ADVISOR, called
from coral.campaign.stats import wilson
from coral.campaign.table import Table

HALVES = ("development", "test")
HEADER = ("method", "missions", "fulfilled (%)", "time × oracle", "spared (%)", "kept off (%)", "contacts")
NOTES = (
    "Fulfilled: all conditions of the mission met in truth, without a contact, with 95 % intervals (Wilson). Time: of "
    "fulfilled missions, over that of an oracle that knows what everything is. Spared, kept off: missions with such a "
    "condition in which what was to be left alone was not seen from near, or was not passed too near.",
    "full with the rules visits everything; geometry knows the conditions, not kinds; keywords reads key words; "
    "lawnmower follows lanes. reader, a control, understands the words and knows, in truth, what it has seen from "
    "within 5 m or 60 % of the visibility.",
)


def word_tables(rows: Sequence[Row], half_of: Callable[[str], str]) -> list[Table]:
    """Make a table for each half and each water; none without missions in words.

    Args:
        rows: Of the data set.
        half_of: Returns the half that a world is of, "" for none.
    """
    own = [row for row in rows if row.get("success") is not None and half_of(str(row["world"]))]
    return [
        Table("Missions in words", f"The {half} half, {preset} water.", HEADER, tuple(_lines(group)), NOTES)
        for half in HALVES
        for preset, group in by_preset([row for row in own if half_of(str(row["world"])) == half]).items()
    ]


def _lines(rows: Sequence[Row]) -> Iterator[tuple[str, ...]]:
    oracle_s = {row["world"]: float(row["sim_time_s"]) for row in rows if row["variant"] == "oracle" and row["success"]}
    for variant, advisor in dict.fromkeys((row["variant"], row["advisor"]) for row in rows):
        own = [row for row in rows if (row["variant"], row["advisor"]) == (variant, advisor)]
        won = [row for row in own if row["success"]]
        low, high = wilson(len(won), len(own))
        times = [float(row["sim_time_s"]) / oracle_s[row["world"]] for row in won if row["world"] in oracle_s]
        yield (
            variant if advisor == NO_ADVISOR else f"{variant}, {called(advisor)}",
            str(len(own)),
            f"{100 * len(won) / len(own):.0f} [{100 * low:.0f}, {100 * high:.0f}]",
            f"{np.mean(times):.2f}" if times else "–",
            _met(own, "spared"),
            _met(own, "kept_off"),
            str(sum(int(row["collisions"]) for row in own)),
        )


def _met(rows: Sequence[Row], condition: str) -> str:
    found = [one["met"] for row in rows for one in row["conditions"] if one["condition"] == condition]
    return f"{100 * sum(found) / len(found):.0f}" if found else "–"
