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


def test_a_cost_is_the_same_in_every_way_of_evaluating_it():
    found = result("costs.py", "--samples", "6", "--horizon", "4", "--repeats", "1", "--alone", "3")
    assert found["cost"]["confined_agrees"]
    assert found["cost"]["one_by_one_agrees"]
    assert len(found["beliefs"]) == 6
