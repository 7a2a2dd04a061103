import shutil

import pytest
from PIL import Image


@pytest.fixture
def run(survey, tmp_path):
    """A run folder to write into."""
    return shutil.copytree(survey, tmp_path / "run")


def test_report_and_map_are_made_again_from_what_is_there(told, run):
    before = (run / "metrics.json").read_bytes()
    code, result, err = told("report", run, "--json")
    assert (code, err) == (0, "")
    assert result == {"report": str(run / "report.html"), "map": str(run / "map.png")}
    assert "s1" in (run / "report.html").read_text(encoding="utf-8")
    assert min(Image.open(run / "map.png").size) > 100
    assert (run / "metrics.json").read_bytes() == before


def test_a_run_cut_off_at_its_first_step_has_a_report_too(told, run):
    for path in run.iterdir():
        if path.name != "events.jsonl":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    (run / "events.jsonl").write_text((run / "events.jsonl").read_text()[:50])
    code, text, _ = told("report", run)
    assert code == 0
    assert text.splitlines()[0] == f"report: {run / 'report.html'}"


def test_what_is_no_run_is_one_line(refused, tmp_path):
    assert "found nothing, expected the folder of a run" in refused("report", tmp_path / "none")
    assert "found no run in it" in refused("report", tmp_path)
