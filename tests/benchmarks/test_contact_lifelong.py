import importlib.util
from pathlib import Path

spec = importlib.util.spec_from_file_location(
    "contact_lifelong", Path(__file__).parents[2] / "benchmarks" / "contact_lifelong.py"
)
lifelong = importlib.util.module_from_spec(spec)
spec.loader.exec_module(lifelong)


def test_the_stream_takes_turns_between_its_families_and_is_the_same_each_time():
    tasks = lifelong.stream(8)
    assert [task.name.partition("-")[0] for task in tasks[:2]] == ["pick", "flip"]
    assert [task.instruction for task in tasks] == [task.instruction for task in lifelong.stream(8)]
    assert len({task.instruction for task in tasks}) > 2


def test_the_summary_counts_each_arm_and_tests_the_pairs():
    rows = [
        {"trial": k, "arm": arm, "success": k >= first, "advisor_calls": calls, "memory_hit": hit and k > 1}
        for arm, first, calls, hit in (("with memory", 2, 1, True), ("without", 8, 3, False))
        for k in range(12)
    ]
    lines = lifelong.summary(rows)
    assert lines[0] == "all, with memory: 10 of 12 succeeded, 12 advisor calls, 10 began with a remembered plan"
    assert lines[3] == "the first ten, without: 2 of 10 succeeded, 30 advisor calls, 0 began with a remembered plan"
    assert lines[4].startswith("the second half, with memory: 6 of 6")
    assert lines[-1] == "only with memory 6, only without 0: p = 0.031"
