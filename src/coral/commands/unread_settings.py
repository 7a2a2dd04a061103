"""Settings that a command accepts among the keys of its configuration and never reads: it refuses them.

A test runs every command that takes a configuration and watches which keys are read; this list must agree with it.
"""

from __future__ import annotations

from collections.abc import Iterable

from coral.errors import InputError

_AT_SEA = {
    **dict.fromkeys(
        ("localization.use_covariance", "pilot.guard.max_sigma_m"),
        "nothing: only a vehicle at sea says how sure it is of its pose",
    ),
    "localization.start_m": "nothing: only a survey at sea is resumed",
}
UNREAD: dict[str, dict[str, str]] = {
    "reef run": _AT_SEA,
    "reef bench": {"record": "nothing: it keeps no pictures and no report", **_AT_SEA},
    "reef sail": {
        "lane_m": "nothing: no blind sweep is driven in real time",
        "simulator.stills": "nothing: a camera at sea has its own pictures",
    },
}
"""By command: key or group of keys, and what the command does instead."""


def refuse_unread(command: str, keys: Iterable[str], prefix: str = "--cfg") -> None:
    """Refuse the first of the dotted keys that a command, such as "reef sail", never reads.

    Raises:
        InputError: The command does not read one of them.
    """
    for key in keys:
        for unread, instead in UNREAD.get(command, {}).items():
            if f"{key}.".startswith(f"{unread}."):
                flag = f"{prefix}.{key}".replace("_", "-")
                raise InputError(f"coral {command}", flag, "a setting that it never reads", instead)


def refused_by(key: str) -> list[str]:
    """Return the commands that refuse a key of their configuration."""
    return [command for command, keys in UNREAD.items() if any(f"{key}.".startswith(f"{one}.") for one in keys)]
