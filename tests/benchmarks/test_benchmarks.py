"""The benchmarks run and report what they say they do; how long anything takes is not looked at."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow
FOLDER = Path(__file__).parents[2] / "benchmarks"


def run(script, *words):
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.run(
        [sys.executable, str(FOLDER / script), *words],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        env=environment,
    )


def result(script, *words):
    done = run(script, *words, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_rollouts_end_where_the_plain_loop_ends_and_plans_take_time(tmp_path):
    out = result(
        "planner.py",
        "--samples",
        "8",
        "--horizon",
        "4",
        "--repeats",
        "1",
        "--out",
        str(tmp_path),
        "--peer-python",
        "no-such-python",
    )
    assert list(out["rows"]) == ["ours, 1 thread", "ours, 2 threads", "plain Python loop"]
    assert out["peer"] is None
    assert len(out["tasks"]) == 6
    assert all(row["plan_ms_1"] > 0 and row["plan_ms_2"] > 0 for row in out["tasks"])
    assert [row["samples"] for row in out["curves"]["samples"]] == [1, 2, 4, 8, 16]
    assert [row["horizon"] for row in out["curves"]["horizon"]] == [2, 2, 4, 6, 8]
    assert (tmp_path / "contact-planner.png").stat().st_size > 5000
    assert len((tmp_path / "contact-planner.csv").read_text().splitlines()) == 11


def test_a_cost_is_the_same_in_every_way_of_evaluating_it():
    found = result("costs.py", "--samples", "6", "--horizon", "4", "--repeats", "1", "--alone", "3")
    assert found["cost"]["confined_agrees"]
    assert found["cost"]["one_by_one_agrees"]
    assert len(found["beliefs"]) == 6
