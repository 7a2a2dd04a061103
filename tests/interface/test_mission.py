import asyncio
import json
import subprocess
import sys

import pytest
import yaml

import coral
from coral.advisor.rules import RuleAdvisor
from coral.cli import main
from coral.errors import InputError
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.drive.pd import PdController

BRIEF = {"time_limit_s": 2.0}


class Mine(RuleAdvisor):
    """Rules under a name of their own."""

    def __init__(self):
        super().__init__(REEF_RULES, name="mine")


def test_it_is_the_same_mission_as_on_the_command_line(tmp_path, capsys):
    result = coral.run_mission("s1", seed=3, cfg=BRIEF)
    words = ["--seed", "3", "--cfg.time-limit-s", "2", "--cfg.record.no-report", "--quiet", "--json"]
    assert main(["reef", "run", "s1", "--out", str(tmp_path / "run"), *words]) == 0
    capsys.readouterr()
    stored = json.loads((tmp_path / "run" / "metrics.json").read_text())
    assert {key: result.metrics[key] for key in stored} == stored
    assert "path" not in result.plot().axes[0].get_title()  # it has the map, though no snapshots
    assert (result.folder / "trajectory.csv").read_text() == (tmp_path / "run" / "trajectory.csv").read_text()


def test_a_folder_is_kept_with_its_report_only_if_it_is_given(tmp_path):
    result = coral.run_mission("s1", cfg=BRIEF, out=tmp_path / "run")
    assert (tmp_path / "run" / "report.html").is_file()
    assert (result.end_reason, result.trajectory.num_rows) == ("time limit", 20)
    assert result.coverage == result.metrics["coverage"]
    assert [attempt["kind"] for attempt in result.attempts] == ["reef-centroid"]


def test_it_runs_where_an_event_loop_is_running():
    async def cell():
        return coral.run_mission("s1", advisor=Mine(), cfg={"time_limit_s": 2, "latency": "fixed:0.5"})

    assert asyncio.run(cell()).metrics["decided_by"]["advisor"] >= 1


def test_parts_of_ones_own_are_used_and_named_in_the_record(tmp_path):
    made, moments, answers = [], [], []

    def controller(setup):
        made.append(setup)
        return PdController(vehicle=setup.vehicle)

    def trigger(now):
        moments.append(now.t)
        return False

    def verifier(question, answer):
        answers.append(answer)
        return "not today"

    result = coral.run_mission(
        "s1",
        controller=controller,
        trigger=trigger,
        verifier=verifier,
        cfg={"time_limit_s": 3, "latency": "fixed:0.2"},
        out=tmp_path / "run",
        report=False,
    )
    assert (len(made), len(moments)) == (1, 30 - sum(t < 1 for t in [k / 10 for k in range(30)]))
    verdicts = [(event["verdict"], event["code"]) for event in result.events if event["event"] == "verdict"]
    assert set(verdicts) - {("withdrawn", "")} == {("rejected", "own")}  # the end may withdraw an open question
    own = yaml.safe_load((tmp_path / "run" / "config.yaml").read_text())["own_parts"]
    assert {name: text.rpartition(".")[2] for name, text in own.items()} == {
        "controller": "controller",
        "trigger": "trigger",
        "verifier": "verifier",
    }


@pytest.mark.parametrize(
    ("world", "wrong", "said"),
    [
        ("s11", {}, "s1"),
        ("s1", {"seed": 0.5}, "--seed: found 0.5"),
        ("s1", {"advisor": object()}, "a string, or an object with a name"),
        ("s1", {"controller": "mppi"}, "did you mean 'ddp-mppi'"),
        ("s1", {"verifier": "x"}, "--verifier"),
        ("s1", {"cfg": {"time_limit": 3}}, "did you mean 'time_limit_s'"),
    ],
)
def test_it_refuses_what_the_command_line_refuses(world, wrong, said, tmp_path):
    with pytest.raises(InputError, match=said):
        coral.run_mission(world, out=tmp_path / "run", **wrong)
    assert not (tmp_path / "run").exists()


def test_an_advisor_cannot_pass_for_one_of_ours():
    class Disguised:
        name = "openai:gpt"

        async def answer(self, question, rejections):
            raise AssertionError

    with pytest.raises(InputError, match="a name that no built-in advisor has"):
        coral.run_mission("s1", advisor=Disguised())


def test_the_package_itself_imports_nothing_heavy():
    code = "import sys, coral; dir(coral); print([m for m in ('numpy', 'numba', 'mujoco', 'cv2') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_package_shows_its_public_names_alone():
    assert dir(coral) == sorted(coral.__all__)
    assert all(hasattr(coral, name) for name in coral.__all__)


def test_an_unknown_name_of_the_package_is_an_attribute_error():
    with pytest.raises(AttributeError, match="run_misson"):
        coral.run_misson  # noqa: B018
