"""`coral contact track`."""

import json

import pytest

from coral.cli import main


def test_the_tables(capsys):
    assert main(["contact", "track", "flip-box", "--width", "160", "--rate-hz", "2"]) == 0
    text = capsys.readouterr().out
    assert text.count("flip-box") == 3  # one motion, two losses
    assert "never" not in text
    [head, row] = [line for line in text.splitlines() if line.startswith(("task", "flip-box"))][:2]
    named = dict(zip(head.replace("95 %", "95%").split(), row.split(), strict=False))
    assert 0.0 < float(named["mm"]) < 5.0


def test_the_numbers_are_the_seed_s(capsys):
    words = ["contact", "track", "flip-box", "--width", "160", "--rate-hz", "2", "--no-losses", "--seed", "1", "--json"]
    rows = []
    for _ in range(2):
        assert main(words) == 0
        result = json.loads(capsys.readouterr().out)
        assert result["lost"] == []
        rows.append({k: v for k, v in result["tracked"][0].items() if not k.endswith(("_s", "_ms", "_ms_95"))})
    assert rows[0] == rows[1]
    assert rows[0]["mm"] < 5
    assert rows[0]["deg"] < 3


@pytest.mark.parametrize(
    ("flags", "named"),
    [
        (["--tracker", "magic"], "magic"),
        (["--width", "8"], "--width"),
        (["--rate-hz", "0"], "--rate-hz"),
        (["--seed", "-1"], "--seed"),
        (["no-such-task"], "no-such-task"),
        (["--export", "folder"], "--export"),
        (["flip-box", "--export", "{full}"], "new or empty"),
    ],
)
def test_bad_flags_are_named(flags, named, tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["contact", "track", *(flag.format(full=tmp_path) for flag in flags)]) == 2
    assert named in capsys.readouterr().err
