import json

import cv2
import pytest
import yaml

from coral.campaign.overlay import draw_overlay

WORLD = {
    "size_m": [12.0, 9.0],
    "start": {"x": 1.0, "y": 1.0, "theta": 0.0},
    "clusters": [{"name": "a", "oysters": [{"x": 5.0, "y": 5.0, "z": 0.05, "radii": [0.12, 0.09, 0.06]}]}],
    "obstacles": [{"shape": "cylinder", "x": 3.0, "y": 6.0, "z": 0.5, "size": [0.4, 0.4, 0.5]}],
}


@pytest.fixture
def run(tmp_path):
    """Makes a run folder, whole or as a kill left it."""

    def make(name, killed=False):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "world.yaml").write_text(yaml.safe_dump(WORLD))
        hit = {"step": 2, "t": 0.2, "event": "collision", "x": 3.0, "y": 5.6}
        (folder / "events.jsonl").write_text(json.dumps(hit) + "\n" + ("{" if killed else ""))
        (folder / "trajectory.csv").write_text("step,t,x,y\n" + ("1," if killed else "1,0.1,1,1\n2,0.2,2,3\n"))
        if not killed:
            (folder / "metrics.json").write_text('{"coverage": 0.5}')
        return folder

    return make


def drawn(runs, path):
    draw_overlay(runs, path, seed=3, advisor="heuristic")
    return cv2.imread(str(path)).shape[:2]


def test_each_world_has_a_panel_and_the_figure_grows_with_them(run, tmp_path):
    folders = {"full": run("full"), "pd": run("pd")}
    one, three = (drawn({f"l{k}": folders for k in range(n)}, tmp_path / f"{n}.png") for n in (1, 3))
    assert one[1] < three[1]


def test_a_killed_run_and_a_variant_without_a_colour_of_its_own_are_drawn(run, tmp_path):
    folders = {"a-variant-of-mine": run("own"), "full": run("killed", killed=True)}
    assert drawn({"l1": folders}, tmp_path / "o.png")


@pytest.mark.parametrize("world", ["$x_$", "a\udcff\x1b"])
def test_the_name_of_a_world_is_no_formula_and_no_control(run, tmp_path, world):
    assert drawn({world: {"full": run("full")}}, tmp_path / "o.png")
