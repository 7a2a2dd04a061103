import pytest

from coral.cli import main
from coral.usage import usage_error


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            "reef run s1 --nope 3",
            "coral reef run: found an unknown flag --nope, expected flags as in: coral reef run --help",
        ),
        (
            "reef run s1 --cfg.time-limit 5",
            "coral reef run: found an unknown flag --cfg.time-limit, expected flags as in: coral reef run --help "
            "(did you mean '--cfg.time-limit-s'?)",
        ),
        (
            "reef run s1 s2",
            "coral reef run: found a word too many, 's2', expected flags as in: coral reef run --help",
        ),
        (
            "reef run s1 --seed",
            "coral reef run: --seed: found nothing, expected a value: flags as in: coral reef run --help",
        ),
        (
            "reef run --nope",
            "coral reef run: WORLD: found nothing, expected a value: flags as in: coral reef run --help",
        ),
        (
            "reef run",
            "coral reef run: WORLD: found nothing, "
            "expected A shipped reef (l1 l2 s1 s2 k1 k2 e1 e2 o1 o2), a generated one (gen:0 to gen:39) or a world "
            "file",
        ),
        ("reef run s1 --seed 1.5", "coral reef run: --seed: found '1.5', expected a whole number"),
        ("reef run s1 --robots two", "coral reef run: --robots: found 'two', expected a whole number"),
        ("reef run s1 --live-speed fast", "coral reef run: --live-speed: found 'fast', expected a number"),
        (
            "contact run pick-box --poses x",
            "coral contact run: --poses: found 'x', expected one of ground-truth, tracked",
        ),
    ],
)
@pytest.mark.parametrize("columns", ["40", "200"])
def test_the_parsers_complaints_are_one_plain_line(monkeypatch, capsys, words, said, columns):
    monkeypatch.setenv("COLUMNS", columns)
    assert main(words.split()) == 2
    assert capsys.readouterr().err == f"coral: {said}\n"


def test_the_colours_of_a_terminal_are_left_out():
    complaint = "\x1b[31m│\x1b[0m \x1b[31;1mUnrecognized\x1b[0m options:\x1b[m \x1b[1m--nope\x1b[0m\x1b[1m,\x1b[0m 3"
    assert "an unknown flag --nope, expected" in str(usage_error("reef run", complaint))
