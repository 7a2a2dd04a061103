import gzip

from coral.rotating_log import RotatingLog, earlier_parts, read_lines
from coral.runs import RunWriter, read_events, read_rows


def written(path, count, header="", most_bytes=50):
    log = RotatingLog(path, header, most_bytes)
    for k in range(count):
        log.append(f"line {k:02d}")
    log.close()
    return path


def test_a_full_part_is_packed_and_all_is_read_as_one(tmp_path):
    path = written(tmp_path / "events.jsonl", 30)
    assert [part.name for part in earlier_parts(path)] == [f"events.000{k}.jsonl.gz" for k in (1, 2, 3, 4)]
    assert path.stat().st_size <= 50 + 8
    assert list(read_lines(path)) == [f"line {k:02d}\n" for k in range(30)]


def test_every_part_has_the_header_and_it_is_read_once(tmp_path):
    path = written(tmp_path / "trajectory.csv", 20, header="step")
    for part in earlier_parts(path):
        with gzip.open(part, "rt") as lines:
            assert next(lines) == "step\n"
    assert list(read_lines(path, headed=True)) == ["step\n"] + [f"line {k:02d}\n" for k in range(20)]


def test_a_part_that_a_kill_left_both_plain_and_packed_counts_once(tmp_path):
    path = written(tmp_path / "events.jsonl", 10)
    packed = earlier_parts(path)[0]
    plain = packed.with_suffix("")
    plain.write_bytes(gzip.decompress(packed.read_bytes()))
    packed.write_bytes(b"half a pack")
    assert list(read_lines(path)) == [f"line {k:02d}\n" for k in range(10)]


def test_other_logs_of_the_folder_are_not_parts(tmp_path):
    path = written(tmp_path / "trajectory.csv", 2)
    for name in ("trajectory_1.csv", "trajectory_1.0001.csv", "events.0001.jsonl"):
        (tmp_path / name).write_text("other\n")
    assert earlier_parts(path) == []


def test_a_part_that_cannot_be_packed_stays_as_it_is(tmp_path, monkeypatch):
    def no_room(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("coral.rotating_log.shutil.copyfileobj", no_room)
    path = written(tmp_path / "events.jsonl", 10)
    assert {part.name for part in tmp_path.iterdir()} == {"events.jsonl", "events.0001.jsonl"}
    assert len(list(read_lines(path))) == 10


def test_a_run_is_read_whole_however_often_its_logs_were_cut(tmp_path, monkeypatch):
    monkeypatch.setattr(RotatingLog.__init__, "__defaults__", ("", 150))
    writer = RunWriter(tmp_path / "run", ("step", "x"))
    for k in range(60):
        writer.event(k, 0.1 * k, "goal")
        writer.row(k, 0.5 * k)
    writer.close()
    name = "trajectory.csv"
    assert len(earlier_parts(tmp_path / "run" / name)) >= 2
    assert [event["step"] for event in read_events(tmp_path / "run" / "events.jsonl")] == list(range(60))
    assert [float(row["x"]) for row in read_rows(tmp_path / "run" / name)] == [0.5 * k for k in range(60)]
