from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import Field

from coral.flags import MANY, Argument, FlagGroup, Option, class_doc, describe, field_docs, shown


@dataclass(frozen=True)
class Lamp:
    """A lamp."""

    power_w: Annotated[float, Field(gt=0, le=50)] = 20.0
    """Electrical power (W)."""
    tilt: float = 0.0
    colour: Literal["red", "white"] = "white"
    blinks: tuple[int, ...] = ()
    spots: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Dive:
    """Dive somewhere."""

    where: Annotated[str, Argument(metavar="PLACE", names=lambda: ("bay", "reef"))]
    """The place."""
    out: Path | None = None
    lit: bool = True
    words: Annotated[tuple[str, ...], Option(repeated=True, help="Said.")] = ()
    lamp: Lamp = field(default_factory=Lamp)
    more: Annotated[Lamp, Option(name="")] = field(default_factory=lambda: Lamp(power_w=9.0))
    secret: Annotated[int, Option(hidden=True)] = 3

    def __call__(self):
        """Dive."""


@pytest.fixture(scope="module")
def flags():
    return {flag.name: flag for flag in describe(Dive).flags}


def test_fields_become_flags_and_those_of_a_group_have_its_name(flags):
    lamp = ["power-w", "tilt", "colour", "blinks"]
    own = ["PLACE", "--out", "--lit", "--words"]
    assert list(flags) == [*own, *(f"--lamp.{name}" for name in lamp), *(f"--{name}" for name in lamp)]
    assert flags["--lamp.power-w"].field == ("lamp", "power_w")
    assert flags["--power-w"].field == ("more", "power_w")


def test_the_groups_are_told_with_the_place_of_their_class():
    assert describe(Dive).groups == (FlagGroup(prefix="--lamp", place=f"{Lamp.__module__}:Lamp", text="A lamp."),)


def test_what_is_accepted_is_told_in_words(flags):
    told = {name: flags[name].type for name in flags}
    assert told["--lamp.power-w"] == "a number > 0, <= 50"
    assert told["--lamp.tilt"] == "a number >= 0"  # as coral.config.checked
    assert told["--lamp.colour"] == "one of red, white"
    assert told["--lamp.blinks"] == "any number of values, each a whole number"
    assert (told["--out"], told["--lit"], told["PLACE"]) == ("a path", "yes or no", "a text")


def test_defaults_names_and_words(flags):
    assert flags["--power-w"].default == "9"
    assert flags["PLACE"].names == ("bay", "reef")
    assert flags["PLACE"].required
    assert not flags["--out"].required
    assert [flags[name].words for name in ("--lit", "--words", "--lamp.blinks")] == [0, 1, MANY]
    assert flags["--words"].text == "Said."
    assert flags["--lit"].spellings == ("--lit", "--no-lit")
    assert flags["--lamp.tilt"].spellings == ("--lamp.tilt",)


@pytest.mark.parametrize(
    ("value", "text"), [(None, ""), (0.1 + 0.2, "0.3"), (1e6, "1e+06"), (1 / 3, str(1 / 3)), ((1.0, 2.5), "1 2.5")]
)
def test_values_are_shown_as_they_would_be_typed(value, text):
    assert shown(value) == text


@dataclass
class Reef:
    """A reef
    of coral.

    It is long.
    """

    depth_m: float
    """Depth of the
    water (m)."""
    wide: bool = True
    length_m: float = 3.0
    """Along the spine."""


@dataclass
class Atoll(Reef):
    length_m: float = 5.0
    """Around."""


def test_the_text_below_a_field_is_found_in_one_line():
    assert field_docs(Reef) == {"depth_m": "Depth of the water (m).", "length_m": "Along the spine."}


def test_a_class_has_the_texts_of_the_one_it_extends():
    assert field_docs(Atoll) == {"depth_m": "Depth of the water (m).", "length_m": "Around."}


def test_a_class_is_described_by_its_first_paragraph():
    assert class_doc(Reef) == "A reef of coral."
