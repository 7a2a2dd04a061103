import re
from dataclasses import dataclass, field, make_dataclass

import pytest

from coral.cli import COMMANDS, main
from coral.errors import InputError
from coral.flags import describe
from coral.help_page import first_sentence, flag_page, help_page
from coral.surface import CONFIGURATIONS, described

Many = make_dataclass("Many", [(f"key_{n}", int, n) for n in range(60)])


@dataclass(frozen=True)
class Swim:
    """Swim."""

    far_m: float = 5.0
    """How far (m). It is asked for twice."""
    warm: bool = True
    """Whether the water is warm."""


@dataclass(frozen=True)
class SwimMuch(Swim):
    cfg: Many = field(default_factory=Many)
    """The stroke."""
    lamp: Swim = field(default_factory=Swim)


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_every_command_fits_a_screen_and_says_where_the_keys_are_listed(name):
    about = described(COMMANDS[name][0])
    lines = help_page(name, about, width=120).splitlines()
    assert len(lines) <= 60
    assert max(map(len, lines)) <= 120
    for group in re.findall(r"^  --(\S+)\.KEY VALUE.*$", "\n".join(lines), re.MULTILINE):
        row = next(line for line in lines if line.startswith(f"  --{group}.KEY"))
        assert re.search(r" coral config (\w+) lists them: ", row)[1] in CONFIGURATIONS


def test_a_command_with_few_flags_shows_all_of_them():
    page = help_page("swim", describe(Swim), width=80).splitlines()
    assert page == [
        "usage: coral swim [flags]",
        "",
        "Swim.",
        "",
        "  --far-m FLOAT  How far (m) (5)",
        "  --[no-]warm    Whether the water is warm",
        "",
        "One flag in full: coral swim --help FLAG",
    ]


def test_many_keys_are_one_line(monkeypatch):
    monkeypatch.setitem(CONFIGURATIONS, "stroke", (f"{Many.__module__}:Many", "--cfg", "a stroke"))
    page = help_page("swim", describe(SwimMuch), width=80)
    assert "  --cfg.KEY VALUE     coral config stroke lists them: The stroke." in page
    assert "--cfg.key" not in page
    assert "--lamp.far-m" in page  # `coral config` does not list it


@pytest.mark.parametrize("word", ["--far-m", "far-m", "far_m", "--far-m=3"])
def test_one_flag_is_told_in_full(word):
    assert flag_page("swim", describe(Swim), word).splitlines() == [
        "--far-m FLOAT",
        "  How far (m). It is asked for twice.",
        "  accepted: a number >= 0",
        "  default: 5",
    ]


def test_an_unknown_flag_is_answered_with_the_nearest():
    with pytest.raises(InputError, match="did you mean '--far-m'"):
        flag_page("swim", describe(Swim), "--fra-m")


def test_the_command_line_prints_both(capsys):
    assert main(["version", "--help"]) == 0
    assert capsys.readouterr().out.startswith("usage: coral version [flags]\n")
    assert main(["reef", "run", "--help", "--cfg.time-limit-s"]) == 0
    assert "accepted: a number > 0" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("One. Two.", "One."),
        ("See Eq. 12 of it. Two.", "See Eq. 12 of it."),
        ("Paper Sec. IV, all.", "Paper Sec. IV, all."),
        ("0.5 m", "0.5 m"),
    ],
)
def test_a_sentence_does_not_end_at_an_abbreviation(text, first):
    assert first_sentence(text) == first
