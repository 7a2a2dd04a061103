import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import Field

from coral.cli import main
from coral.errors import InputError
from coral.flag_parser import build, scan
from coral.flags import Argument, Option, describe


@dataclass(frozen=True)
class Motor:
    fast: bool = False
    gains: tuple[float, float] = (1.0, 2.0)
    limit_n: Annotated[float, Field(gt=0)] = 3.0

    def __post_init__(self):
        if self.limit_n > 100.0:
            raise InputError("motor", "limit_n", self.limit_n, "at most 100 N")


@dataclass(frozen=True)
class Drive:
    boat: Annotated[str, Argument(metavar="BOAT")]
    """Name of the boat."""
    ports: Annotated[tuple[Path, ...], Argument(metavar="[PORT ...]")] = ()
    speed: float | None = 1.5
    count: int = 1
    start: tuple[float, float] | None = None
    tags: tuple[str, ...] = ()
    fault: Annotated[tuple[str, ...], Option(repeated=True)] = ()
    mode: Literal["slow", "steady"] = "slow"
    quiet: bool = False
    preset: Annotated[str, Option(hidden=True)] = "calm"
    motor: Motor = field(default_factory=Motor)


def parse(words, default=None):
    about = describe(Drive)
    return build(Drive, scan(words.split(), about, "drive"), about, "drive", default)


@pytest.mark.parametrize(
    ("words", "changed"),
    [
        ("b", {}),
        ("b p q --quiet", {"ports": (Path("p"), Path("q")), "quiet": True}),
        ("b --count=-3", {"count": -3}),
        ("b --speed -0.5", {"speed": -0.5}),
        ("b --speed None --start None", {"speed": None}),
        ("b --start 1 -2", {"start": (1.0, -2.0)}),
        ("b --tags x y --mode steady", {"tags": ("x", "y"), "mode": "steady"}),
        ("b --fault x --fault y", {"fault": ("x", "y")}),
        ("b --motor.fast --motor.limit_n 5", {"motor": Motor(fast=True, limit_n=5.0)}),
        ("b --motor.fast --motor.no-fast --motor.gains 3 4", {"motor": Motor(gains=(3.0, 4.0))}),
    ],
)
def test_words_become_the_values_of_the_fields(words, changed):
    assert parse(words) == dataclasses.replace(Drive("b"), **changed)


def test_what_is_not_given_comes_from_the_default():
    default = Drive("", count=7, preset="storm", motor=Motor(fast=True))
    assert parse("b --motor.limit-n 9", default) == Drive(
        "b", count=7, preset="storm", motor=Motor(fast=True, limit_n=9.0)
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("", "coral drive: BOAT: found nothing, expected Name of the boat"),
        ("b --quiet=yes", "coral drive: --quiet: found 'yes', expected no value: --quiet or --no-quiet"),
        ("b --start 1", "coral drive: --start: found 1, expected 2 values: flags as in: coral drive --help"),
        ("b --preset calm", "coral drive: found an unknown flag --preset, .*"),
        ("b --motor.limit 3", "coral drive: found an unknown flag --motor.limit, .*'--motor.limit-n'.*"),
        ("b --motor.limit-n x", "coral drive: --motor.limit-n: found 'x', expected a number"),
        ("b --motor.limit-n 200", "coral drive: --motor.limit-n: found 200.0, expected at most 100 N"),
        ("b --mode stedy", "coral drive: --mode: found 'stedy', expected one of slow, steady .*'steady'.*"),
    ],
)
def test_a_mistake_names_the_flag(words, said):
    with pytest.raises(InputError, match=said):
        parse(words)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            "reef run s1 --cfg.time-limit 5",
            "coral reef run: found an unknown flag --cfg.time-limit, expected flags as in: coral reef run --help "
            "(did you mean '--cfg.time-limit-s'?)",
        ),
        (
            "reef run",
            "coral reef run: WORLD: found nothing, "
            "expected A shipped reef (l1 l2 s1 s2 k1 k2 e1 e2 o1 o2), a generated one (gen:0 to gen:39) or a world "
            "file",
        ),
    ],
)
def test_the_command_line_says_it_in_one_line(capsys, words, said):
    assert main(words.split()) == 2
    assert capsys.readouterr().err == f"coral: {said}\n"
