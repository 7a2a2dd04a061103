import contextlib
import dataclasses
import io
import json
import pickle
import re
import threading

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml

from coral.campaign.store import CampaignFiles
from coral.cli import _parse, main
from coral.commands.reef_bench import ReefBench, mission_alone
from coral.errors import InputError
from coral.file_writer import write_whole
from coral.reef.world.world import Cluster, Oyster, ReefWorld, Start, save_world

pytestmark = pytest.mark.wing("coral.erring")


@pytest.fixture(scope="module")
def puddle(tmp_path_factory):
    """One bed of oysters in plain view: a mission of a few seconds."""
    rng = np.random.default_rng(1)
    bed = Cluster(
        name="bed",
        oysters=tuple(
            Oyster(x=float(x), y=float(y), z=0.05, radii=(0.12, 0.09, 0.06))
            for x, y in rng.normal((5.5, 3.0), 0.4, (40, 2))
        ),
    )
    path = tmp_path_factory.mktemp("world") / "puddle.yaml"
    save_world(ReefWorld(name="puddle", size_m=(8.0, 6.0), start=Start(x=1.5, y=3.0, theta=0.0), clusters=(bed,)), path)
    return path


def bench(puddle, out, **fields):
    return ReefBench(
        worlds=str(puddle),
        out=out,
        quiet=True,
        mix=True,
        **{"variants": "full,lawnmower", "advisors": "heuristic,sloppy:malformed=0.3:heuristic", **fields},
    )


@pytest.fixture(scope="module")
def finished(puddle, tmp_path_factory):
    out = tmp_path_factory.mktemp("bench") / "out"
    return bench(puddle, out)(), out


def test_a_bench_leaves_data_tables_figure_and_runs(finished):
    result, out = finished
    assert (result["episodes"], result["done"], result["failed"], result["ran"]) == (3, 3, 0, 3)
    rows = pq.read_table(out / "results.parquet").to_pylist()
    assert {(row["variant"], row["advisor"]) for row in rows} == {
        ("full", "heuristic"),
        ("full", "sloppy:malformed=0.3:heuristic"),
        ("lawnmower", "none"),
    }
    for row in rows:
        assert row["topology"] == "custom"
        assert len(row["covered_at_s"]) == row["clusters_covered"]
        assert row["commit"]
    for form in ("md", "html"):
        assert "Made by: coral reef bench" in (out / f"tables.{form}").read_text()
    named = {value.rstrip("/") for name, value in vars(CampaignFiles).items() if name.isupper()}
    assert {path.name for path in out.iterdir() if not path.name.startswith(".")} <= named
    assert {path.name for path in next((out / "runs").glob("*full_heuristic*")).iterdir()} == {
        "attempts.jsonl",
        "config.yaml",
        "events.jsonl",
        "frames",
        "judge.csv",
        "metrics.json",
        "timing.json",
        "trajectory.csv",
        "world.yaml",
    }
    assert json.loads(json.dumps(result, allow_nan=False)) == result


def test_a_mission_of_a_bench_is_the_mission_of_coral_reef_run_that_stops_when_covered(
    finished, puddle, tmp_path, capsys
):
    _, out = finished
    assert (
        main(
            [
                "reef",
                "run",
                str(puddle),
                "--out",
                str(tmp_path / "run"),
                "--quiet",
                "--json",
                "--cfg.stop-when-covered",
                "--cfg.record.no-frames",
                "--cfg.record.no-pictures",
                "--cfg.record.no-report",
            ]
        )
        == 0
    )
    capsys.readouterr()
    theirs = next((out / "runs").glob("*full_heuristic*")) / "trajectory.csv"
    assert (tmp_path / "run" / "trajectory.csv").read_bytes() == theirs.read_bytes()


def test_again_runs_nothing_and_collect_needs_no_grid(finished, puddle):
    _, out = finished
    again = bench(puddle, out)()
    assert (again["ran"], again["found"]) == (0, 3)
    (out / "tables.md").unlink()
    command = ReefBench(out=out, collect=True)
    told = command.describe(command())
    assert told.count("**") == 6  # the effects, and all variants with each of two advisors
    assert "**All variants.**" in told
    assert told.count("Made by: coral reef bench") == 1


def test_the_advisor_stands_alone_unless_a_fallback_is_asked_for(finished, puddle):
    result, out = finished
    assert {row["fallback"] for row in pq.read_table(out / "results.parquet").to_pylist()} == {"hold"}
    with pytest.raises(InputError, match="configuration: found results made with"):
        dataclasses.replace(bench(puddle, out, fallback="rules"), mix=False)()
    tables = {(table["name"], table["caption"]): table for table in result["results"]}
    (row, _) = tables[
        "Who decided", "Who decided, and what it cost. Advisor: heuristic (embedded rules, no foundation model)."
    ]["rows"]
    assert row["variant"] == "CORAL (full)"
    assert (row["decisions"], row["by fallback"]) == ("0", "—")  # covered before anything was decided


@pytest.mark.parametrize(
    ("fields", "complaint"),
    [
        ({"variants": "full,fulll"}, "--variant.*did you mean 'full'"),
        ({"worlds": "l9"}, "world: found"),
        ({"seeds": "2-1"}, "--seeds"),
        ({"advisors": "heuristix"}, "--advisors.*heuristic"),
        ({"jobs": 0}, "--jobs"),
        ({"advisors": "desk"}, "answer by themselves"),
        ({"sweep": ("time=1",)}, "--sweep: time:.*'time_limit_s'"),
        ({"sweep": ("curent=0.1",)}, "--sweep: curent:.*'current'"),
        ({"sweep": ("current=2",)}, "between 0 and 1 m/s"),
        ({"sweep": ("time_limit_s=-1",)}, "time_limit_s"),
        ({"sweep": ("time_limit_s",)}, "KEY=V1"),
        ({"presets": "clear,hart"}, "--preset.*did you mean 'hard'"),
        ({"worlds": "gen:0-40"}, "within gen:0-39"),
        ({"executor": "ray", "address": "here"}, "--address|not installed"),
    ],
)
def test_bad_input_is_told_before_anything_runs(puddle, tmp_path, fields, complaint):
    with pytest.raises(InputError, match=complaint):
        ReefBench(**{"worlds": str(puddle), "out": tmp_path / "out", "quiet": True, **fields})()
    assert not list(tmp_path.rglob("episodes"))


def test_another_configuration_in_the_same_folder_is_refused(finished, puddle, capsys):
    words = ["reef", "bench", "--worlds", str(puddle), "--variants", "full", "--out", str(finished[1]), "--quiet"]
    assert main([*words, "--cfg.time-limit-s", "2"]) == 2
    assert "configuration" in (told := capsys.readouterr().err)
    assert told.count("\n") == 1


def desk_bench(folder, **fields):
    cfg = dataclasses.replace(mission_alone(), latency="fixed:2", time_limit_s=6.0)
    told = {"variants": "full", "advisors": "desk", "inbox": folder / "inbox", "cfg": cfg, "study": ("words",)}
    return ReefBench(worlds="words:living:100", out=folder / "out", quiet=True, mix=True, **{**told, **fields})


def test_a_reader_outside_is_asked_in_an_inbox_and_scored(tmp_path, in_process, small_stills):
    ended, kinds = threading.Event(), set()

    def read():
        while not ended.wait(0.02):
            for file in (tmp_path / "inbox").glob("*/question.json"):
                question = json.loads(file.read_text())
                if question["id"] not in kinds:
                    kinds.add(question["id"])
                    write_whole(file.parent / "answer.json", '{"done": true, "reason": "nothing to see"}')

    reader = threading.Thread(target=read)
    reader.start()
    try:
        result = desk_bench(tmp_path)()
    finally:
        ended.set()
        reader.join()
    assert (result["done"], result["failed"]) == (1, 0)
    assert all(name.endswith("-reef-mission") for name in kinds)
    (row,) = pq.read_table(tmp_path / "out" / "results.parquet").to_pylist()
    assert row["success"] is False
    (tmp_path / "out" / "tables.md").unlink()
    ReefBench(out=tmp_path / "out", collect=True, quiet=True)()
    assert re.search(r"full, desk \|\s+0/1 \|\s+0–79 ", (tmp_path / "out" / "tables.md").read_text())


@pytest.mark.parametrize(
    ("fields", "where"),
    [
        ({"inbox": None}, "--inbox DIR"),
        ({"cfg": mission_alone()}, "--cfg.latency"),
        ({"jobs": 2}, "--jobs"),
    ],
)
def test_a_desk_without_an_inbox_or_with_a_clock_is_refused(tmp_path, fields, where):
    with pytest.raises(InputError, match=where):
        desk_bench(tmp_path, **fields)()


def test_a_folder_without_a_campaign_cannot_be_collected(tmp_path):
    with pytest.raises(InputError, match="no campaign"):
        ReefBench(out=tmp_path / "nothing", collect=True)()
    assert not (tmp_path / "nothing").exists()


@pytest.fixture(scope="module")
def swept(puddle, tmp_path_factory):
    out = tmp_path_factory.mktemp("sweep") / "out"
    words = [
        "reef",
        "bench",
        "--worlds",
        str(puddle),
        "--variants",
        "full",
        "--quiet",
        "--json",
        "--mix",
        "--cfg.time-limit-s",
        "2",
        "--sweep",
        "current=0.2",
        "--sweep",
        "simulator.noise.visibility_m=3,2",
        "--out",
        str(out),
    ]
    with contextlib.redirect_stdout(io.StringIO()) as told:
        assert main(words) == 0
    return words, out, json.loads(told.getvalue())


@pytest.mark.slow
def test_a_sweep_changes_one_key_at_a_time_and_runs_the_nominal_setting_too(swept):
    _, out, result = swept
    assert (result["done"], result["failed"]) == (4, 0)
    assert [row["setting"] for row in pq.read_table(out / "results.parquet").to_pylist()] == [
        "nominal",
        "current=0.2",
        "simulator.noise.visibility_m=3",
        "simulator.noise.visibility_m=2",
    ]
    assert [table["name"] for table in result["results"]][-2:] == ["Sweep", "Sweep, differences"]
    for form in ("md", "html"):
        assert "--sweep current=0.2 --sweep simulator.noise.visibility_m=3,2" in (out / f"tables.{form}").read_text()


@pytest.mark.slow
def test_a_run_folder_holds_its_settings_resolved(swept):
    _, out, _ = swept
    found = set()
    for folder in (out / "runs").iterdir():
        world, cfg = (yaml.safe_load((folder / name).read_text()) for name in ("world.yaml", "config.yaml"))
        noise = cfg["mission"]["simulator"]["noise"]
        found.add((world["current"]["x_m_s"], noise["visibility_m"]))
    assert found == {(0.0, None), (0.2, None), (0.0, 3.0), (0.0, 2.0)}


@pytest.mark.slow
def test_a_sweep_is_taken_up_and_extended(swept, capsys):
    words, _, _ = swept
    assert main([*words, "--sweep", "simulator.noise.visibility_m=1"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert (again["found"], again["ran"]) == (4, 1)


def test_a_bench_without_a_sweep_has_no_table_of_one(finished):
    _, out = finished
    assert "Sweep" not in (out / "tables.md").read_text()


def test_what_workers_get_can_be_sent(puddle):
    from coral.commands.reef_bench import ReefEpisode
    from coral.reef.world.world import load_world

    command = ReefBench()
    episode = ReefEpisode(command.cfg, command.model, {"p": load_world(puddle)})
    assert pickle.loads(pickle.dumps(episode)) == episode


@pytest.fixture(scope="module")
def study(puddle, tmp_path_factory):
    """The study on one small world, with two of its variants and of its advisors, cut short."""
    out = tmp_path_factory.mktemp("study") / "out"
    words = ["reef", "bench", "--study", "--worlds", str(puddle), "--variants", "full,blind-sweep", "--out", str(out)]
    words += ["--advisors", "heuristic,sloppy:0.6:heuristic", "--cfg.time-limit-s", "2", "--quiet", "--json", "--mix"]
    words += ["--seeds", "0", "--presets", "clear,hard", "--cfg.simulator.noise.depth-sigma", "0"]
    with contextlib.redirect_stdout(io.StringIO()) as told:
        assert main(words) == 0
    return words, out, json.loads(told.getvalue())


@pytest.mark.slow
def test_a_study_runs_in_two_waters_and_tells_the_effects_in_all_conditions(study):
    _, out, result = study
    assert (result["done"], result["failed"]) == (6, 0)
    assert "**Effects.**" in (out / "tables.md").read_text()
    rows = pq.read_table(out / "results.parquet").to_pylist()
    assert [(row["variant"], row["preset"], row["setting"]) for row in rows if row["advisor"] == "none"] == [
        ("blind-sweep", "clear", "nominal"),
        ("blind-sweep", "hard", "preset=hard"),
    ]


@pytest.mark.slow
def test_a_study_lets_missions_end_by_themselves_and_flags_win_over_its_waters(study):
    _, out, _ = study
    configs = [yaml.safe_load((folder / "config.yaml").read_text()) for folder in (out / "runs").iterdir()]
    assert {config["preset"] for config in configs} == {"clear", "hard"}
    for config in configs:
        noise = config["mission"]["simulator"]["noise"]
        assert config["mission"]["stop_when_covered"] is False
        assert noise["depth_sigma"] == 0.0
        assert noise["visibility_m"] == (3.0 if config["preset"] == "hard" else None)
    (command,) = json.loads((out / "manifest.json").read_text())["commands"]
    assert command.startswith("coral reef bench --")
    assert "--study" in command
    assert "--mix" not in command
    assert "--cfg.simulator.noise.depth-sigma 0" in command


@pytest.mark.slow
def test_a_study_goes_on_where_it_stopped(study):
    words, out, _ = study
    victim = next((out / "episodes").glob("*full*"))
    victim.unlink()
    with contextlib.redirect_stdout(io.StringIO()) as told:
        assert main(words) == 0
    again = json.loads(told.getvalue())
    assert (again["ran"], again["found"], again["done"]) == (1, 5, 6)


def test_a_study_of_missions_in_words_has_both_halves_in_three_waters():
    made = ReefBench.from_file(["--study", "words"])
    assert made.presets == "clear,coast,bay"
    assert made.worlds == "words:all:0-3,words:all:100-103"
    with pytest.raises(InputError, match="--study"):
        dataclasses.replace(made, study=("word",))()


def test_a_study_has_its_own_defaults_and_flags_change_them():
    made = ReefBench.from_file(["--study"])
    assert (made.presets, made.seeds) == ("clear,bay,hard", "0-2")
    assert made.cfg.time_limit_s == 757.0
    assert made.advisors == "heuristic,sloppy:0.3:heuristic,sloppy:0.6:heuristic"
    assert {"dream", "pd", "full", "no-verification", "random", "constant", "clairvoyant-unchecked"} <= set(
        made.variants.split(",")
    )
    assert {"lawnmower", "blind-sweep", "oracle"} <= set(made.variants.split(","))
    assert made.cfg.stop_when_covered is False
    assert ReefBench.from_file(["--study", "--cfg.stop-when-covered"]).cfg.stop_when_covered is True


def test_the_study_may_stand_alone_or_name_the_missions_in_words():
    assert _parse("reef bench", ["--study", "--worlds", "s1"]).study == ()
    assert _parse("reef bench", ["--study", "words"]).study == ("words",)
