import numpy as np
import pytest
import yaml

from coral.errors import InputError
from coral.view.contact.replay import DIRECTIONS, ReplayedScene, trial_of_run
from coral.view.run import RunFolder


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


def test_a_wall_before_the_camera_makes_it_look_from_elsewhere(copy):
    task = yaml.safe_load((copy / "task.yaml").read_text())
    assert (ReplayedScene(RunFolder.read(copy), (96, 72)).direction == DIRECTIONS[0]).all()
    x, y = (float(np.nanmean(RunFolder.read(copy).column(f"box_{axis}"))) for axis in "xy")
    task["fixtures"] = [{"name": "wall", "size": [0.02, 0.6, 0.4], "position": [x + 0.12, y, 0.2]}]
    (copy / "task.yaml").write_text(yaml.safe_dump(task))
    assert ReplayedScene(RunFolder.read(copy), (96, 72)).direction[0] <= 0.0


def test_states_of_another_world_are_refused(copy):
    rows = (copy / "states.csv").read_text().splitlines()
    (copy / "states.csv").write_text("\n".join(row.rsplit(",", 1)[0] for row in rows) + "\n")
    with pytest.raises(InputError, match="joint positions"):
        ReplayedScene(RunFolder.read(copy), (96, 72))


@pytest.mark.parametrize(
    ("name", "said"), [("states.csv", "expected a run that kept them"), ("task.yaml", "no task.yaml and seed")]
)
def test_what_a_run_lacks_is_named(copy, name, said):
    (copy / name).unlink()
    with pytest.raises(InputError, match=said):
        ReplayedScene(RunFolder.read(copy), (96, 72))
