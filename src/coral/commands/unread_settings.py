"""Settings that a command accepts among the keys of its configuration and never reads: it refuses them.

A test runs every command that takes a configuration and watches which keys are read; this list must agree with it.
What a command reads may depend on what was chosen: its action, or the value of another flag.
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
_SCORED = "--perception, --labelled, and either --worlds, --waters, --pictures, --seed or --oysters"
_TRAINED = (
    "--labelled, --oysters, --without, --reefs, --pictures, --steps, --batch, --device, --limit-s, --begin, "
    "--threads, --out, --seed"
)
_OF_TRAINING = ("without", "reefs", "steps", "batch", "device", "limit-s", "begin", "threads", "out")
_PD = {"controller": "nothing: --cfg.controller is DDP-MPPI's, and a PD controller drives"}
_NOBODY_ASKED = dict.fromkeys(
    ("think", "sight", "--fallback", "--model", "--inbox", "--preflight"), "nothing: no advisor is asked"
)
_POLICY = dict.fromkeys(
    ("replan_steps", "planning", "controller.mppi", "poses", "tracked", "--samples", "--poses"),
    "--cfg.policy: a policy plans nothing, and sees pictures alone",
)
UNREAD: dict[str, dict[str, str]] = {
    "reef run": _AT_SEA,
    "reef bench": {"record": "nothing: it keeps no pictures and no report", **_AT_SEA},
    "reef sail": {
        "simulator.stills": "nothing: a camera at sea has its own pictures",
    },
    **dict.fromkeys(("reef run --cfg.driver=pd", "reef bench --cfg.driver=pd", "reef sail --cfg.driver=pd"), _PD),
    **dict.fromkeys(("reef run --variant=pd", "reef bench --variants=pd"), _PD),
    "contact run --variant=expert": _NOBODY_ASKED,
    "contact run --variant=expert-fsm": _NOBODY_ASKED,
    "contact run --cost": _NOBODY_ASKED,
    "contact run --policy": _NOBODY_ASKED | _POLICY,
    "reef eyes train": dict.fromkeys(("--perception", "--worlds", "--waters"), _TRAINED),
    "reef eyes score": dict.fromkeys((f"--{name}" for name in _OF_TRAINING), _SCORED),
    "reef eyes score --labelled": dict.fromkeys(
        ("--worlds", "--waters", "--pictures", "--seed"), "--perception, --labelled and --oysters"
    ),
}
"""By command and what was chosen: key or group of keys of the configuration, or flag, and what is read instead."""


def refuse_unread(command: str, keys: Iterable[str], chosen: Iterable[str] = ()) -> None:
    """Refuse the first of the dotted keys, or flags, that a command, such as "reef sail", never reads.

    `chosen` are its action, flags, and flags with their values, such as "--cfg.driver=pd".

    Raises:
        InputError: The command does not read one of them.
    """
    there = {*command.split(), *chosen}
    holding = [(case, unread) for case, unread in UNREAD.items() if there.issuperset(case.split())]
    for key in keys:
        for case, found in holding:
            for unread, instead in found.items():
                if f"{key}.".startswith(f"{unread}."):
                    flag = key if key.startswith("--") else f"--cfg.{key}".replace("_", "-")
                    raise InputError(f"coral {case}", flag, "a setting that it never reads", instead)


def refused_by(key: str) -> list[str]:
    """Return the commands that refuse a key of their configuration."""
    return [command for command, keys in UNREAD.items() if any(f"{key}.".startswith(f"{one}.") for one in keys)]
