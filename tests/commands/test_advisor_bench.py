import json

from coral.cli import main


def bench(capsys, *flags):
    code = main(["advisor", "bench", "--quiet", "--json", *flags])
    return code, capsys.readouterr()


def test_a_row_for_each_advisor(capsys, tmp_path):
    flags = ("--only", "reef-centroid", "--limit", "6", "--advisors", "random,heuristic")
    code, said = bench(capsys, *flags, "--out", str(tmp_path / "b"))
    rows = json.loads(said.out)["rows"]
    assert code == 0
    assert [row["name"] for row in rows] == ["random", "heuristic"]
    assert all(0.0 <= row["low"] <= row["score"] <= row["high"] <= 1.0 for row in rows)
    assert set(rows[0]["by_kind"]) == {"reef-centroid"}
    assert "Is this model good enough?" in (tmp_path / "b" / "report.html").read_text(encoding="utf-8")
    assert len((tmp_path / "b" / "answers.jsonl").read_text(encoding="utf-8").splitlines()) == 12


def test_export_and_score(capsys, tmp_path):
    flags = ("--only", "object-poses", "--limit", "2")
    assert bench(capsys, *flags, "--export", str(tmp_path / "in"))[0] == 0
    code, said = bench(capsys, *flags, "--answers", str(tmp_path / "in"), "--name", "nobody")
    row = json.loads(said.out)["rows"][0]
    assert (code, row["name"], row["answered"], row["score"]) == (0, "nobody", 0, 0.0)


def test_bad_flags_are_refused(capsys, tmp_path):
    assert bench(capsys, "--advisors", "heuristik")[0] == 2
    assert bench(capsys, "--sets", "private")[0] == 2
    assert bench(capsys, "--limit", "0")[0] == 2
