import pyarrow.parquet as pq

from coral.campaign.dataset import write_dataset


def record(seed, status="done", **more):
    spec = {"system": "toy", "variant": "a", "world": "w", "seed": seed, "advisor": "x", "overrides": {"k": 1}}
    return {"spec": spec, "status": status, "about": {"host": "h", "seed": 99}, **more}


def test_every_record_is_a_row_whatever_it_lacks(tmp_path):
    records = [
        record(0, result={"score": 1, "eff": None, "times": [1.0, 2.5], "world": "other"}),
        record(1, result={"score": 2.5, "times": []}),
        record(2, result={"score": 1, "nested": {"b": 1, "a": 2}, "seen": True}),
        record(3, status="failed", message="ValueError: no", detail="Traceback"),
    ]
    rows = write_dataset(records, {"commit": "abc"}, tmp_path / "r.parquet")
    assert pq.read_table(tmp_path / "r.parquet").to_pylist() == rows
    assert [row["seed"] for row in rows] == [0, 1, 2, 3]
    assert [row["score"] for row in rows] == [1.0, 2.5, 1.0, None]
    assert [row["times"] for row in rows] == [[1.0, 2.5], [], None, None]
    assert rows[2]["nested"] == '{"a": 2, "b": 1}'
    assert rows[0]["world"] == "w", "a result cannot pass itself off as another episode"
    assert {row["overrides"] for row in rows} == {'{"k": 1}'}
    assert {row["setting"] for row in rows} == {"k=1"}
    assert [(row["status"], row["failure"]) for row in rows[2:]] == [("done", ""), ("failed", "ValueError: no")]
    assert {row["commit"] for row in rows} == {"abc"}


def test_a_column_of_mixed_kinds_becomes_text(tmp_path):
    rows = write_dataset([record(0, result={"x": 1}), record(1, result={"x": "one"})], {}, tmp_path / "r.parquet")
    assert [row["x"] for row in rows] == ["1", "one"]
