import dataclasses
import re
import shutil

import numpy as np
import pytest

from coral.cli import main
from coral.contact.control.mppi_controller import ControllerCfg
from coral.contact.control.planning_world import PlanningCfg
from coral.contact.cost.stages import Guide, Stage, Strategy
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.episode import Episode
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.strategist import FixedStrategist
from coral.errors import InputError
from coral.mppi.knots import KnotMppiCfg
from coral.view.contact.figures import curves_chart, stage_spans, touching
from coral.view.contact.keyframes import MOST, keyframes, moments
from coral.view.contact.replay import ReplayedScene, trial_of_run
from coral.view.contact.report import write_contact_report
from coral.view.contact.video import moments as film_moments
from coral.view.contact.video import pictures
from coral.view.run import RunFolder

COARSE = EpisodeCfg(
    poses="ground-truth",
    planning=PlanningCfg(threads=1),
    controller=ControllerCfg(horizon=10, mppi=KnotMppiCfg(samples=10, knots=3), guided=0.5),
)


def poke():
    """Down upon the box, then stay: two stages, a contact."""
    above = Guide(lambda state: state.box_pos[0, :1])
    return Strategy(
        "poke",
        (
            Stage(
                "down",
                lambda state: {
                    "reach": 10 * np.linalg.norm(state.ee_pos - state.box_pos, axis=-1),
                    "calm": 0.01 * np.square(state.ee_vel).sum(axis=-1),
                },
                (above,),
                until=lambda now: bool(now.box_hand_contact[0, 0]),
            ),
            Stage("rest", lambda state: {"calm": np.square(state.ee_vel).sum(axis=-1)}),
        ),
    )


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A run of 1.2 s in the hand's world."""
    folder = tmp_path_factory.mktemp("contact") / "run"
    task = load_task("pick-box").model_copy(update={"time_limit_s": 1.2})
    Episode(sample_trial(task, 3), "hand", FixedStrategist(poke()), COARSE, folder, variant="expert").run()
    return folder


@pytest.fixture
def copy(recorded, tmp_path):
    return shutil.copytree(recorded, tmp_path / "run")


def cut(folder, at_s):
    """What a run leaves that is killed at a time."""
    for name in ("metrics.json", "timing.json"):
        (folder / name).unlink()
    lines = (folder / "events.jsonl").read_text().splitlines()
    kept = [line for line in lines if float(re.search(r'"t": ([\d.]+)', line)[1]) <= at_s]
    (folder / "events.jsonl").write_text("\n".join(kept) + '\n{"step": 9')
    for name in ("trajectory.csv", "states.csv"):
        rows = (folder / name).read_text().splitlines()
        kept = [row for row in rows[1:] if float(row.split(",")[1]) <= at_s]
        (folder / name).write_text("\n".join([rows[0], *kept]) + "\n1,2")
    return folder


def test_a_report_shows_outcome_pictures_charts_and_where_it_comes_from(copy):
    page = write_contact_report(copy).read_text()
    assert "Not done within 1 s of simulated time" in page
    assert page.count("data:image/webp") == len(moments(RunFolder.read(copy)))
    for said in ("Cost, term by term", "Force", "Contact points", "final belief", "pick-box", "Paths"):
        assert said in page
    assert (copy / "keyframes.png").read_bytes().startswith(b"\x89PNG")


def test_a_report_loads_nothing(copy):
    page = write_contact_report(copy).read_text()
    assert not re.search(r"""(?:src|href)=["'](?!data:|#|episode\.mp4)""", page)
    assert "http" not in page


def test_a_killed_run_is_reported_with_what_there_is(copy):
    page = write_contact_report(cut(copy, 0.3)).read_text()
    assert "This run was interrupted" in page
    assert "Cut off after 0.3 s" in page
    assert "was cut off while it was written" in page


def test_a_run_of_which_next_to_nothing_is_left_is_reported_too(copy):
    cut(copy, -1.0)
    (copy / "states.csv").unlink()
    assert "Nothing was recorded" in write_contact_report(copy).read_text()


def test_a_run_without_states_has_a_report_without_pictures(copy):
    (copy / "states.csv").unlink()
    page = write_contact_report(copy).read_text()
    assert "data:image/webp" not in page
    assert "Cost, term by term" in page


def test_names_from_a_task_file_are_escaped(copy):
    task = (copy / "task.yaml").read_text().replace("title: Pick box", "title: <script>alert(1)</script>")
    (copy / "task.yaml").write_text(task)
    assert "<script>" not in write_contact_report(copy).read_text()


def test_the_trial_is_drawn_again_from_the_folder(recorded):
    trial = trial_of_run(RunFolder.read(recorded))
    run = RunFolder.read(recorded)
    np.testing.assert_allclose(
        trial.objects["box"].pose.position, [run.column(f"box_{axis}")[0] for axis in "xyz"], atol=1e-5
    )


def test_pictures_show_what_moved(recorded):
    run = RunFolder.read(recorded)
    scene = ReplayedScene(run, (96, 72))
    first, last = scene.at(0.0), scene.at(0.8)
    assert first.shape == (72, 96, 3)
    assert (first != last).any(axis=-1).mean() > 0.01
    np.testing.assert_array_equal(scene.at(0.0), first)


def test_states_of_another_world_are_refused(copy):
    rows = (copy / "states.csv").read_text().splitlines()
    (copy / "states.csv").write_text("\n".join(row.rsplit(",", 1)[0] for row in rows) + "\n")
    with pytest.raises(InputError, match="joint positions"):
        ReplayedScene(RunFolder.read(copy), (96, 72))


def test_moments_are_in_order_and_hold_beginning_stages_and_end(recorded):
    run = RunFolder.read(recorded)
    chosen = moments(run)
    times = [t for t, _ in chosen]
    assert times == sorted(times)
    assert (times[0], times[-1]) == (0.0, run.duration_s)
    assert len(chosen) <= MOST
    assert chosen[-1][1] == "timeout"
    assert {f"begin to {name}" for start, _, name in stage_spans(run) if start > 0} <= {why for _, why in chosen}
    assert len(keyframes(run)) == len(chosen)


def test_contacts_of_the_whole_run_have_ended(recorded):
    run = RunFolder.read(recorded)
    touches = touching(run)
    assert {(touch["first"], touch["second"]) for touch in touches} >= {("box", "table")}
    assert all(touch["begun_s"] <= touch["ended_s"] <= run.duration_s + 1e-6 for touch in touches)


def test_a_legend_of_many_names_takes_more_rows(recorded):
    run = RunFolder.read(recorded)
    t = run.column("t")
    few, many = (curves_chart(run, t, {f"a rather long name {k}": t for k in range(n)}, "x") for n in (2, 12))
    heights = [float(re.search(r'viewBox="0 0 1100 (\d+)', svg)[1]) for svg in (few, many)]
    assert heights[1] > heights[0]


def test_a_film_runs_in_real_time_unless_that_would_take_too_long():
    assert len(film_moments(0.8)) == 11
    assert len(film_moments(400.0)) == len(film_moments(40.0)) == 501


def test_a_film_has_a_picture_for_each_moment(recorded, monkeypatch):
    run = RunFolder.read(recorded)
    monkeypatch.setattr("coral.view.contact.video.WIDTH", 160)
    monkeypatch.setattr("coral.view.contact.video.HEIGHT", 120)
    film = list(pictures(run, ReplayedScene(run, (160, 120))))
    assert len(film) == len(film_moments(1.2))
    assert all(picture.shape == film[0].shape for picture in film)


def test_coral_report_makes_page_keyframes_and_film(copy, capsys):
    assert main(["report", str(copy), "--video", "--json"]) == 0
    assert (copy / "episode.mp4").stat().st_size > 1000
    assert "episode.mp4" in (copy / "report.html").read_text()


def test_coral_replay_refuses_a_contact_run(copy, capsys):
    assert main(["replay", str(copy)]) == 2
    assert "coral report --video" in capsys.readouterr().err


def test_a_world_that_cannot_be_built_costs_the_pictures_only(copy):
    config = (copy / "config.yaml").read_text().replace("world: hand", "world: elsewhere")
    (copy / "config.yaml").write_text(config)
    page = write_contact_report(copy).read_text()
    assert "No pictures" in page
    assert dataclasses.is_dataclass(RunFolder.read(copy))
