import json

import pyarrow.parquet as pq
import pytest
from contact_bench import changed

from coral.cli import main
from coral.commands.contact_bench import ContactBench, named_tasks
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.tasks import load_task
from coral.errors import InputError

pytestmark = pytest.mark.wing("coral.contact.experts")

COARSE = ["--samples", "6", "--cfg.controller.horizon", "8", "--cfg.planning.threads", "1", "--quiet"]
SKIP = ["--no-preflight", "--model.max-retries", "0", "--model.format-repairs", "0", "--cfg.think.latency", "0"]


def answer(capsys):
    return json.loads(capsys.readouterr().out)


def test_suites_have_a_name():
    assert "pick-box" in named_tasks("all")
    assert set(named_tasks("unseen")) == {*named_tasks("unseen:development"), *named_tasks("unseen:test")}
    assert named_tasks("pick-box,a.yaml") == ("pick-box", "a.yaml")
    with pytest.raises(InputError, match="one of development, test"):
        named_tasks("unseen:none")


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


@pytest.mark.slow
def test_a_bench_runs_what_is_missing_and_makes_tables(bench, task, tmp_path, capsys, request):
    words, out = bench
    assert main(words) == 0
    result = answer(capsys)
    assert (result["episodes"], result["done"], result["failed"], result["ran"]) == (2, 2, 0, 2)
    request.getfixturevalue("in_process")
    assert main([word if word != "0-1" else "0-2" for word in words]) == 0
    result = answer(capsys)
    assert (result["episodes"], result["done"], result["ran"], result["found"]) == (3, 3, 1, 2)
    rows = pq.read_table(out / "results.parquet").to_pylist()
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
                "--variant",
                "expert-fsm",
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


@pytest.mark.slow
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


def test_what_is_no_memory_is_refused(refused, tmp_path):
    path = tmp_path / "memory.json"
    path.write_text('{"experiences": []}')
    assert "an SQLite file of experiences" in refused("contact", "bench", "--memory", path, "--out", tmp_path / "out")
    assert "no such file" in refused("contact", "bench", "--memory", tmp_path / "absent", "--out", tmp_path / "out")
