import math
import xml.etree.ElementTree as ET
from base64 import b64decode
from dataclasses import replace

import cv2
import numpy as np
import pytest

from coral.reef.pictures.mapframe import CELL_COLORS
from coral.reef.world.geometry import Label
from coral.view.decisions import decisions
from coral.view.mapsvg import PAD, SIZE_PX, MapSvg, cluster_fate, cluster_outline, map_uri, outlines, track
from coral.view.run import RunFolder

SIZE = (12.0, 12.0)


@pytest.fixture(scope="module")
def run(finished):
    return RunFolder.read(finished)


def layer(root, name):
    return next(e for e in root.iter("g") if e.get("id") == f"layer-{name}")


def test_the_longer_side_fills_the_picture_and_north_is_up(run):
    view = MapSvg(run, (12.0, 6.0))
    assert (view.width, view.height) == (SIZE_PX, PAD[1] + PAD[3] + 6.0 * view.scale)
    assert view.at(0.0, 6.0) == (PAD[0], PAD[1])
    assert view.at(12.0, 0.0) == pytest.approx((SIZE_PX - PAD[2], view.height - PAD[3]))


def test_what_was_covered_and_what_was_missed_is_told(run):
    root = ET.fromstring(MapSvg(run, SIZE).draw(decisions(run)))
    titles = [e.text for e in layer(root, "truth").iter("title")]
    assert titles == [
        "true cluster north: covered at 0:33",
        "true cluster middle: covered at 0:15",
        "true cluster far: not reached, time limit",
    ]
    layers = [e.get("id") for e in root.iter("g")]
    assert layers.index("layer-truenames") > layers.index("layer-path")  # a path would hide the names
    assert [e.text for e in layer(root, "truenames")] == ["north ✓", "middle ✓", "far not reached"]
    assert [e.find("title").text for e in layer(root, "collisions")] == ["collision at 0:26"]
    assert len([e for e in layer(root, "truth").iter("path") if e.get("class") == "rock"]) == 2


@pytest.mark.parametrize(
    ("place", "reason", "fate"),
    [
        ((2.0, 10.5), "time limit", "unreached"),
        ((4.0, 4.5), "time limit", "missed"),  # beside the path
        ((2.0, 10.5), "nothing left to explore", "missed"),
        ((2.0, 10.5), "all lanes are done", "missed"),
        ((2.0, 10.5), None, "unreached"),  # killed
    ],
)
def test_missed_is_what_was_passed_or_what_a_finished_survey_left(run, place, reason, fate):
    oyster = {"x": place[0], "y": place[1], "radii": [0.1]}
    events = tuple(e for e in run.events if e["event"] != "end")
    events += ({"event": "end", "t": 40.0, "reason": reason},) if reason else ()
    assert cluster_fate(replace(run, events=events), {"name": "one", "oysters": [oyster]})[0] == fate


def test_markers_of_decisions_never_cover_one_another(run):
    made = [replace(one, x=2.0, y=2.0) for one in decisions(run) for _ in range(5)]
    root = ET.fromstring(MapSvg(run, SIZE).draw(made))
    spots = np.array([(float(e.get("cx")), float(e.get("cy"))) for e in layer(root, "decisions").iter("circle")])
    assert len(spots) == 15
    away = np.hypot(*(spots[:, None] - spots[None]).transpose(2, 0, 1)) + 99.0 * np.eye(15)
    assert away.min() > 18.5


def test_names_from_a_world_are_no_markup(run):
    bad = '<script>"&'
    clusters = [{**cluster, "name": bad} for cluster in run.world["clusters"]]
    svg = MapSvg(replace(run, world={**run.world, "clusters": clusters}), SIZE).draw(())
    assert "<script" not in svg
    assert f"{bad} not reached" in [e.text for e in ET.fromstring(svg).iter("text")]


def test_a_run_of_which_nothing_is_left_is_an_empty_sea(run):
    root = ET.fromstring(MapSvg(replace(run, trajectory={}, events=(), world={}, frame_steps=()), SIZE).draw(()))
    assert "sea" in {e.get("class") for e in root.iter("rect")}
    assert not list(root.iter("image"))
    assert "robot" not in {e.get("id") for e in root.iter("g")}


def test_the_picture_of_the_cells_is_the_map_upside_up():
    cells = np.zeros((4, 5), np.uint8)
    cells[0, 0], cells[3, 4] = 2, 9  # an unknown class is drawn as the last one
    data = b64decode(map_uri(cells).partition(",")[2])
    rgb = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
    assert tuple(rgb[-1, 0]) == tuple(CELL_COLORS[2])
    assert tuple(rgb[0, -1]) == tuple(CELL_COLORS[3])


def test_a_long_track_is_thinned_and_keeps_its_ends(run):
    x = np.arange(10_000.0)
    x[5] = math.nan
    xs, ys = track(replace(run, trajectory={"x": x, "y": -x}), points=100)
    assert len(xs) <= 102
    assert (xs[0], xs[-1], ys[-1]) == (0.0, 9_999.0, -9_999.0)


def test_the_outline_of_a_cluster_holds_its_oysters_and_turns_once():
    oysters = [{"x": x, "y": y, "radii": [0.1, 0.1, 0.1]} for x, y in ((0, 0), (2, 0), (1, 1))]
    hull = cluster_outline({"oysters": oysters}).astype(np.float32)
    assert all(cv2.pointPolygonTest(hull, (float(o["x"]), float(o["y"])), True) > 0.1 for o in oysters)
    assert cluster_outline({}).shape == (0, 2)


@pytest.mark.parametrize(("shape", "area"), [("box", 4 * 0.6 * 0.2), ("ellipsoid", math.pi * 0.6 * 0.2)])
def test_an_outline_has_the_area_and_the_heading_of_its_obstacle(run, shape, area):
    rock = {"shape": shape, "x": 3.0, "y": 4.0, "z": 0.5, "size": [0.6, 0.2, 0.5], "yaw": math.pi / 2}
    found = [points for label, points in outlines({**run.world, "obstacles": [rock]}) if label == Label.OBSTACLE]
    assert cv2.contourArea(found[0].astype(np.float32)) == pytest.approx(area, rel=0.02)
    assert np.ptp(found[0], axis=0) == pytest.approx((0.4, 1.2), rel=0.02)
    assert outlines({**run.world, "obstacles": [{**rock, "size": []}]}) == []
