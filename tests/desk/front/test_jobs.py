import pytest

from coral.desk.front.jobs import Job


def test_a_command_says_why_it_ended(tmp_path):
    job = Job(["reef", "run", "s9"], tmp_path)
    job._process.wait(60)
    job.stop(10.0)
    assert (job.running, job.code, job.url) == (False, 2, "")
    assert "s9" in job.told


@pytest.mark.slow
def test_a_run_says_where_it_can_be_watched_and_is_stopped_in_order(tmp_path):
    words = ["reef", "run", "s1", "--live", "--no-wait", "--live-port", "0", "--out", str(tmp_path / "run"), "--quiet"]
    job = Job(words, tmp_path / "run")
    while job.running and not job.url:
        job._reader.join(0.1)
    assert job.url.startswith("http://127.0.0.1:")
    job.stop(60.0)
    assert "stopped by SIGTERM" in (tmp_path / "run/metrics.json").read_text()
