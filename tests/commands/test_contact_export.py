import pytest

from coral.commands import contact_export
from coral.view.run import RunFolder


@pytest.fixture
def written(monkeypatch):
    """Takes the place of the writer; keeps what it was given."""
    given = []

    def write(runs, out, cfg):
        given.append((runs, out, cfg))
        return {"episodes": len(runs), "frames": 12, "successes": 1, "dataset": str(out)}

    monkeypatch.setattr(contact_export, "write_lerobot", write)
    return given


@pytest.fixture
def two_runs(monkeypatch, tmp_path):
    """Two folders, of which the second is a success."""

    def read(path):
        return type("Run", (), {"metrics": {"success": path.name == "b"}})

    monkeypatch.setattr(RunFolder, "read", staticmethod(read))
    return tmp_path / "a", tmp_path / "b"


def test_the_runs_go_into_one_data_set(two_runs, written, tmp_path, told):
    code, out, _ = told("contact", "export", *two_runs, "--out", tmp_path / "set", "--cfg.fps", "5")
    assert (code, [path.name for path in written[0][0]], written[0][2].fps) == (0, ["a", "b"], 5)
    assert out == f"{tmp_path / 'set'}: 2 episodes, 1 success, 12 frames\n"


def test_failures_can_be_left_out(two_runs, written, tmp_path, told):
    told("contact", "export", *two_runs, "--successes", "--out", tmp_path / "set")
    assert [path.name for path in written[0][0]] == ["b"]


def test_no_success_at_all_is_refused(two_runs, tmp_path, refused):
    said = refused("contact", "export", two_runs[0], "--successes", "--out", tmp_path / "set")
    assert "none among 1 run" in said


@pytest.mark.parametrize("words", [["--to", "rlds"], ["--cfg.width", "33"], ["--cfg.fps", "0"]])
def test_bad_flags_are_refused(two_runs, words, tmp_path, refused):
    refused("contact", "export", *two_runs, "--out", tmp_path / "set", *words)
