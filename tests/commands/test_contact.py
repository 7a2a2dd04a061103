import json
from pathlib import Path

import pytest
import yaml
from contact_bench import changed
from stub import Stub, completion

from coral.campaign.dataset import read_parquet
from coral.cli import main
from coral.commands.contact_bench import ContactBench
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.end_reasons import END_REASONS
from coral.contact.episode.variants import VARIANTS
from coral.contact.scene.task_file import TASKS_DIR, shipped_tasks
from coral.contact.tasks import load_task

COARSE = ["--samples", "6", "--cfg.controller.horizon", "8", "--cfg.planning.threads", "1", "--quiet"]


@pytest.fixture(scope="module")
def task(tmp_path_factory):
    """pick-box with a time limit of 0.2 s, as a file."""
    path = tmp_path_factory.mktemp("task") / "short.yaml"
    content = load_task("pick-box").model_copy(update={"time_limit_s": 0.2}).model_dump(mode="json")
    content["success"]["hold_s"] = 0.1
    path.write_text(yaml.safe_dump(content))
    return str(path)


def answer(capsys):
    return json.loads(capsys.readouterr().out)


def test_run_prints_one_object_with_the_promised_keys_and_leaves_a_run(task, tmp_path, capsys):
    assert main(["contact", "run", task, "--world", "hand", "--out", str(tmp_path / "run"), "--json", *COARSE]) == 0
    result = answer(capsys)
    assert {
        "success",
        "sim_time_s",
        "steps",
        "advisor_calls",
        "repairs",
        "memory_hit",
        "path_length_m",
        "end_reason",
        "poses",
        "wall_time_s",
        "plan_ms_median",
    } <= set(result)
    assert (result["success"], result["end_reason"], result["poses"]) == (False, "timeout", "tracked")
    assert {path.name for path in (tmp_path / "run").iterdir()} == {
        "config.yaml",
        "task.yaml",
        "events.jsonl",
        "trajectory.csv",
        "states.csv",
        "metrics.json",
        "timing.json",
        "report.html",
        "keyframes.png",
    }


def test_run_says_in_words_how_it_ended(task, tmp_path, capsys):
    assert main(["contact", "run", task, "--world", "hand", "--out", str(tmp_path / "run"), *COARSE]) == 0
    assert "timeout (the task's time limit was reached) after 0.2 s simulated" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["pick-bx"], "did you mean 'pick-box'?"),
        (["pick-box", "--world", "pand"], "did you mean 'panda'?"),
        (["pick-box", "--variant", "expertt"], "did you mean 'expert'?"),
        (["pick-box", "--advisor", "heuristics"], "did you mean 'heuristic'?"),
        (["pick-box", "--seed", "-1"], "--seed"),
        (["pick-box", "--samples", "0"], "--samples"),
        (["pick-box", "--samples", "100000000"], "samples"),
        (["pick-box", "--cfg.controller.horizon", "100000000"], "controller.horizon"),
        (["pick-box", "--cfg.controller.mppi.knots", "1"], "controller.mppi.knots"),
        (["pick-box", "--cfg.planning.threads", "100000"], "planning.threads"),
        (
            ["pick-box", "--cfg.controller.workspace-low-m", "1", "1", "1"],
            "found [1.0, 1.0, 1.0], expected numbers below",
        ),
        (["pick-box", "--cfg.reactive.memory-s", "0"], "reactive.memory_s"),
        (["push-pick-board", "--variant", "full", "--believe", "bord=2,0.9"], "did you mean 'board'?"),
        (["push-pick-board", "--believe", "board=2,0.9"], "also --variant expert-fsm"),
        (["pick-box", "--memory", "m.sqlite"], "--memory: found also --variant expert-fsm"),
        (["pick-box", "--memory", "m.sqlite", "--variant", "no-memory"], "also --variant no-memory"),
        (["pick-box", "--advisor", "desk"], "desk with --variant expert-fsm"),
        (["pick-box", "--variant", "full", "--model.attempt-timeout-s", "nan"], "attempt_timeout_s"),
        (["absent.yaml"], "no such file"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(words, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["contact", "run", *words, "--quiet"]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_tasks_are_listed_and_one_is_shown_with_its_ranges(capsys):
    assert main(["contact", "tasks"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in shipped_tasks())
    assert main(["contact", "tasks", "pick-box"]) == 0
    shown = capsys.readouterr().out
    assert "mass      0.1 to 0.4 kg" in shown
    assert main(["contact", "tasks", "--json"]) == 0
    assert [task["name"] for task in answer(capsys)["tasks"]] == list(shipped_tasks())


@pytest.fixture(scope="module")
def bench(task, tmp_path_factory):
    """The words of a bench of two trials, and where it goes."""
    out = tmp_path_factory.mktemp("bench") / "out"
    return [
        "contact",
        "bench",
        "--tasks",
        task,
        "--worlds",
        "hand",
        "--variants",
        "expert-fsm",
        "--seeds",
        "0-1",
        "--out",
        str(out),
        "--mix",
        "--json",
        *COARSE,
    ], out


def test_a_bench_runs_what_is_missing_and_makes_tables(bench, task, tmp_path, capsys):
    words, out = bench
    assert main(words) == 0
    result = answer(capsys)
    assert (result["episodes"], result["done"], result["failed"], result["ran"]) == (2, 2, 0, 2)
    assert main([word if word != "0-1" else "0-2" for word in words]) == 0
    result = answer(capsys)
    assert (result["episodes"], result["done"], result["ran"], result["found"]) == (3, 3, 1, 2)
    rows = read_parquet(out / "results.parquet")
    assert [(row["seed"], row["evaluation_world"], row["success"]) for row in rows] == [
        (0, "hand", False),
        (1, "hand", False),
        (2, "hand", False),
    ]
    assert "0/3" in (out / "tables.md").read_text()

    # A trial of a bench is the trial of coral contact run.
    assert (
        main(
            [
                "contact",
                "run",
                task,
                "--world",
                "hand",
                "--seed",
                "1",
                "--out",
                str(tmp_path / "run"),
                "--json",
                "--cfg.record.no-report",
                *COARSE,
            ]
        )
        == 0
    )
    (folder,) = [path for path in (out / "runs").iterdir() if "_s1_" in path.name]
    for name in ("metrics.json", "trajectory.csv", "events.jsonl"):
        assert (folder / name).read_bytes() == (tmp_path / "run" / name).read_bytes()


@pytest.mark.parametrize(
    ("flag", "value"),
    [
        ("--variants", "expert,nobody"),
        ("--worlds", "hand,moon"),
        ("--tasks", "pick-bx"),
        ("--seeds", "x"),
        ("--advisors", "desk"),
        ("--jobs", "0"),
    ],
)
def test_a_bad_bench_is_refused_before_anything_runs(flag, value, tmp_path, capsys):
    words = ["contact", "bench", "--tasks", "pick-box", "--out", str(tmp_path / "out"), flag, value]
    assert main(words) == 2
    assert value.split(",")[-1] in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", [["tasks"], ["run", "--world", "hand"], ["bench", "--worlds", "hand", "--tasks"]])
def test_what_cannot_be_drawn_is_told_with_its_file_before_anything_runs(command, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    content = changed("objects.0.z", 0.0)
    Path("low.yaml").write_text(json.dumps(content), encoding="utf-8")
    assert main(["contact", *command, "low.yaml"]) == 2
    assert "low.yaml: objects[0].z: found 0, which is 0.03 m deep in the table" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["low.yaml"]


@pytest.mark.parametrize(
    ("name", "changes", "variant", "said"),
    [
        (
            "push-pick-board",
            {"name: board": "name: slab", "object: board": "object: slab"},
            "expert-fsm",
            "board_rear_pos",
        ),
        ("push-force", {"push_force": "force"}, "expert", "push_force"),
        ("flip-wall", {"name: wall": "name: fence", "thing: wall": "thing: fence"}, "expert", "wall_pos"),
    ],
)
def test_a_copy_that_lacks_what_the_experts_read_is_told_so(name, changes, variant, said, tmp_path, capsys):
    text = (TASKS_DIR / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes.items():
        text = text.replace(old, new)
    (tmp_path / "copy.yaml").write_text(text, encoding="utf-8")
    out = tmp_path / "run"
    words = ["--world", "hand", "--variant", variant, "--out", str(out)]
    assert main(["contact", "run", str(tmp_path / "copy.yaml"), *words]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()


def test_another_mesh_under_the_same_name_is_another_campaign(tmp_path):
    def digest(height):
        (tmp_path / "m.obj").write_text(
            f"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {height}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", encoding="utf-8"
        )
        (tmp_path / "mesh.yaml").write_text(
            json.dumps(changed("objects.0.parts.0", {"shape": "mesh", "file": "m.obj", "size": [0.1, 0.1, 0.1]})),
            encoding="utf-8",
        )
        return ContactBench()._conditions(EpisodeCfg(), {"mesh": load_task(tmp_path / "mesh.yaml")}, None)["task mesh"]

    assert digest(1) == digest(1)
    assert digest(1) != digest(2)


def test_every_variant_and_end_is_explained():
    page = (Path(__file__).parents[2] / "docs" / "contact-run.md").read_text()
    assert [variant for variant in VARIANTS if f"| `{variant}` |" not in page] == []
    assert [reason for reason in END_REASONS if f"| `{reason}" not in page] == []


@pytest.fixture
def refusing(monkeypatch):
    """The address of a model that refuses everything."""
    monkeypatch.delenv("CORAL_LOCAL_API_KEY", raising=False)
    server = Stub(completion("I am sorry, I cannot help with that."))
    yield f"local:{server.url}#m"
    server.close()


REFUSED = ["--world", "hand", "--variant", "full", *COARSE, "--advisor"]
SKIP = ["--no-preflight", "--model.max-retries", "0", "--model.format-repairs", "0", "--cfg.think.latency", "0"]


def test_a_model_that_refuses_is_refused_before_anything_is_written(task, refusing, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["contact", "run", task, *REFUSED, refusing]) == 2
    assert "its reply is no answer, refusal" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_where_the_rules_stand_in_for_a_model_everything_says_so(task, refusing, tmp_path, capsys):
    memory, out = tmp_path / "memory.sqlite", tmp_path / "run"
    assert main(["contact", "run", task, *REFUSED, refusing, *SKIP, "--memory", str(memory), "--out", str(out)]) == 0
    said, err = capsys.readouterr()
    metrics = json.loads((out / "metrics.json").read_text())
    assert metrics["decided_by"] == {"advisor": 0, "memory": 0, "recording": 0, "fallback": 3}
    assert metrics["answers"]["malformed"] == 12
    last = "he advisor decided 0 of 3 decisions, the fallback's rules 3"
    assert said.rstrip().splitlines()[-1] == f"t{last}"
    assert f"T{last}".replace("'", "&#39;") in (out / "report.html").read_text()
    assert "the advisor did not decide on the parameters (requeries-used-up): continuing with heuristic" in err


@pytest.mark.parametrize(
    ("policy", "reason"), [("hold", "no-decision: parameters"), ("fail", "advisor failed: requeries-used-up")]
)
def test_an_episode_ends_where_nobody_may_stand_in(task, refusing, tmp_path, capsys, policy, reason):
    words = [*REFUSED, refusing, *SKIP, "--fallback", policy, "--out", str(tmp_path / "run"), "--json"]
    assert main(["contact", "run", task, *words]) == 0
    result = answer(capsys)
    assert (result["success"], result["end_reason"], result["steps"]) == (False, reason, 0)
    assert result["end_reason"].partition(":")[0] in END_REASONS
    assert result["decided"] == f"the advisor decided 0 of 1 decisions, nobody 1 ({policy})"


def test_a_bench_counts_nothing_for_a_model_that_refuses_and_remembers_nothing(task, refusing, tmp_path, capsys):
    words = ["contact", "bench", "--tasks", task, "--worlds", "hand", "--variants", "full", "--seeds", "0", *COARSE]
    assert main([*words, "--advisors", refusing, *SKIP, "--out", str(tmp_path / "out"), "--json"]) == 0
    result = answer(capsys)
    assert result["memory"] == ""
    tables = {table["name"]: table["rows"] for table in result["results"]}
    (row,) = tables["Every task"]
    assert (row["success"], row["otherwise ended by"]) == ("0/1", "no-decision: parameters 1")
    (decided,) = tables["Who decided"]
    assert (decided["variant"], decided["by advisor"]) == ("CoRAL (full) §", "0 (0 %)")
