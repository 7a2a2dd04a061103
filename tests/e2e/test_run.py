"""A mission from the shell: what it prints, what it leaves, whether it can be repeated, and what a kill leaves."""

import csv
import json
import re
import resource
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow
KEYS = {
    "coverage",
    "clusters_covered",
    "clusters_total",
    "collisions",
    "advisor_calls",
    "requeries",
    "deviations",
    "steps",
    "sim_time_s",
    "coverage_time_s",
    "distance_m",
    "end_reason",
    "inspected",
    "time_to_50_s",
    "time_to_90_s",
    "oracle_ratio_90",
    "idle_fraction",
    "phantom_clusters",
    "position_error_m",
    "odometry_error_m",
    "wall_time_s",
    "control_ms_median",
    "control_ms_p99",
}
FILES = {
    "config.yaml",
    "world.yaml",
    "events.jsonl",
    "trajectory.csv",
    "judge.csv",
    "attempts.jsonl",
    "metrics.json",
    "timing.json",
    "map.png",
    "report.html",
}
WORDS = ("reef", "run", "pond.yaml", "--cfg.time-limit-s", "40", "--json")


@pytest.fixture(scope="module")
def runs(world, coral, tmp_path_factory):
    """Three missions on noisy sensors in one folder: seed 0 twice, seed 1 once."""
    import yaml

    place = tmp_path_factory.mktemp("runs")
    (place / "pond.yaml").write_text(yaml.safe_dump(world()))
    noise = ("--cfg.simulator.noise.dropout", "0.05", "--cfg.simulator.noise.drift-xy", "0.01")
    return {
        name: (coral(place, *WORDS, *noise, "--seed", seed, "--out", name), place / name)
        for name, seed in (("first", 0), ("again", 0), ("other", 1))
    }


def test_standard_output_is_one_json_object(runs):
    done, folder = runs["first"]
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") == 1
    result = json.loads(done.stdout)
    assert result.keys() >= KEYS
    counts = {"decided_by", "answers"}
    nested = {*counts, "seconds_in_state"}
    assert all(not isinstance(value, dict | list) for name, value in result.items() if name not in nested)
    assert all(isinstance(number, int) for name in counts for number in result[name].values())
    assert "simulated" in done.stderr
    metrics, timing = (json.loads((folder / name).read_text()) for name in ("metrics.json", "timing.json"))
    assert {key: result[key] for key in metrics} == metrics
    assert result["wall_time_s"] == timing["wall_time_s"]
    assert result["clusters_covered"] >= 1
    assert result["collisions"] == 0


def test_the_folder_holds_what_was_promised(runs):
    _, folder = runs["first"]
    assert {path.name for path in folder.iterdir()} >= FILES
    assert (folder / "map.png").read_bytes().startswith(b"\x89PNG")
    rows = list(csv.DictReader((folder / "trajectory.csv").open()))
    assert [int(row["step"]) for row in rows] == list(range(1, len(rows) + 1))
    events = [json.loads(line) for line in (folder / "events.jsonl").open()]
    assert (events[0]["event"], events[-1]["event"]) == ("start", "end")
    digests = {d for line in (folder / "attempts.jsonl").open() for d in json.loads(line)["pictures"]}
    assert digests
    assert all((folder / "pictures" / f"{digest}.png").is_file() for digest in digests)


def test_the_same_seed_repeats_the_mission_byte_for_byte(runs):
    first, again, other = (runs[name][1] for name in ("first", "again", "other"))
    for name in ("metrics.json", "trajectory.csv", "events.jsonl", "world.yaml", "map.png"):
        assert (first / name).read_bytes() == (again / name).read_bytes(), name
    assert (first / "trajectory.csv").read_bytes() != (other / "trajectory.csv").read_bytes()


def test_a_recording_repeats_the_mission_without_its_advisor(runs, coral):
    _, first = runs["first"]
    done = coral(
        first.parent,
        "reef",
        "run",
        first / "world.yaml",
        "--advisor",
        f"replay:{first / 'attempts.jsonl'}",
        "--cfg.time-limit-s",
        "40",
        "--cfg.simulator.noise.dropout",
        "0.05",
        "--cfg.simulator.noise.drift-xy",
        "0.01",
        "--out",
        "replayed",
    )
    assert done.returncode == 0, done.stderr
    again, once = (json.loads((folder / "metrics.json").read_text()) for folder in (first.parent / "replayed", first))
    deciders = again.pop("decided_by"), once.pop("decided_by")
    assert again == once
    assert [who["recording"] for who in deciders] == [deciders[1]["advisor"], 0]
    assert deciders[1]["advisor"] > 0


def test_people_get_a_summary_and_the_next_free_folder(place, coral):
    for number in ("001", "002"):
        done = coral(place, *WORDS[:4], "1", "--quiet")
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        assert "oyster clusters covered" in done.stdout
        assert f"runs/pond-{number}" in done.stdout


def heed_ctrl_c():
    """A suite that runs in the background of a shell hands down that Ctrl-C is ignored, and under nohup SIGHUP."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def interrupted(place, environment, how, rows, *more):
    """A run without end, sent a signal once its trajectory has so many rows: exit code, folder, output, error."""
    command = [
        Path(sys.executable).with_name("coral"),
        "reef",
        "run",
        "pond.yaml",
        "--cfg.no-stop-when-covered",
        "--cfg.time-limit-s",
        "100000",
        "--cfg.latency",
        "1",
        "--out",
        "stopped",
        "--json",
        *(more or ("--quiet",)),
    ]
    return stopped(command, place, environment, how, rows)


def stopped(command, place, environment, how, rows):
    process = subprocess.Popen(
        command, cwd=place, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=heed_ctrl_c
    )
    path = place / "stopped" / "trajectory.csv"
    try:
        while process.poll() is None and not (path.is_file() and path.read_bytes().count(b"\n") > rows):
            with suppress(subprocess.TimeoutExpired):
                process.wait(0.02)
        process.send_signal(how)
        out, error = process.communicate(timeout=120)
    finally:
        process.kill()
    return process.returncode, place / "stopped", out, error


def test_a_killed_run_keeps_what_it_wrote_and_gets_a_report(place, coral, environment):
    code, folder, _, _ = interrupted(place, environment, signal.SIGKILL, 50)
    assert code == -signal.SIGKILL
    events = [json.loads(line) for line in (folder / "events.jsonl").open()]
    attempts = [json.loads(line) for line in (folder / "attempts.jsonl").open()]
    rows = list(csv.DictReader((folder / "trajectory.csv").open()))
    assert events[0]["event"] == "start"
    assert events[-1]["event"] != "end"
    assert len(rows) >= 50
    assert all(row["clusters_covered"] for row in rows)
    assert attempts[0]["verdict"]
    assert not (folder / "metrics.json").exists()
    done = coral(place, "report", "stopped", "--json")
    assert done.returncode == 0, done.stderr
    assert "interrupted" in Path(place / json.loads(done.stdout)["report"]).read_text()


def test_ctrl_c_ends_a_run_in_order(place, environment):
    code, folder, out, error = interrupted(place, environment, signal.SIGINT, 20)
    assert (code, error) == (0, b"")
    assert json.loads(out)["end_reason"] == "stopped by the operator"
    assert (folder / "metrics.json").is_file()


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGHUP])
def test_a_run_that_is_told_to_end_ends_like_ctrl_c(place, environment, how):
    code, folder, out, error = interrupted(place, environment, how, 20)
    reason = f"stopped by {how.name}"
    assert (code, error) == (128 + how, b"")
    assert json.loads(out)["end_reason"] == reason
    assert json.loads((folder / "metrics.json").read_text())["end_reason"] == reason
    events = [json.loads(line) for line in (folder / "events.jsonl").open()]
    assert (events[-1]["event"], events[-1]["reason"]) == ("end", reason)
    assert reason in (folder / "report.html").read_text()


def test_a_contact_run_that_is_told_to_end_ends_like_ctrl_c(place, environment):
    coral = Path(sys.executable).with_name("coral")
    command = [coral, "contact", "run", "pick-box", "--world", "hand", "--out", "stopped", "--json", "--quiet"]
    code, folder, out, error = stopped(command, place, environment, signal.SIGTERM, 5)
    assert (code, error) == (128 + signal.SIGTERM, b"")
    reason = json.loads(out)["end_reason"]
    assert reason.startswith("stopped by")
    events = [json.loads(line) for line in (folder / "events.jsonl").open()]
    assert (events[-1]["event"], events[-1]["reason"]) == ("end", reason)
    assert json.loads((folder / "metrics.json").read_text())["end_reason"] == reason
    assert (folder / "report.html").is_file()


def test_the_cursor_is_shown_again(place, environment):
    bare = {name: value for name, value in environment.items() if name not in ("NO_COLOR", "TERM")}
    shown = {**bare, "TERM": "xterm", "FORCE_COLOR": "1"}
    _, _, _, error = interrupted(place, shown, signal.SIGTERM, 20, "--cfg.record.no-report")
    assert b"\x1b[?25l" in error
    assert error.rfind(b"\x1b[?25h") > error.rfind(b"\x1b[?25l")


def test_a_full_disk_is_one_line(place, environment):
    """As full as a file may get under `ulimit -f`; the trajectory is what meets the limit."""
    command = [Path(sys.executable).with_name("coral"), "reef", "run", "pond.yaml", "--cfg.no-stop-when-covered"]
    command += ["--cfg.time-limit-s", "100000", "--cfg.record.no-frames", "--out", "full", "--quiet"]
    done = subprocess.run(
        command,
        cwd=place,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000)),
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(r"coral: full/\S+: file too large; [^\n]+\n", done.stderr), done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--help",), "coral reef run"),
        ((), "usage: coral"),
        (("reef",), "coral reef envs"),
        (("reef", "run", "--help"), "coral config reef"),
        (("version",), "coral 0"),
        (("doctor",), "ready"),
    ],
)
def test_help_is_on_standard_output(place, coral, words, said):
    done = coral(place, *words)
    assert (done.returncode, done.stderr) == (0, "")
    assert said in done.stdout


@pytest.mark.parametrize(
    "words",
    [("version",), ("doctor",), ("reef", "envs"), ("advisor", "show", "list"), ("advisor", "show", "cost-function")],
)
def test_every_command_speaks_json(place, coral, words):
    done = coral(place, *words, "--json")
    assert done.returncode == 0, done.stderr
    assert isinstance(json.loads(done.stdout), dict)
    assert done.stdout.count("\n") == 1
