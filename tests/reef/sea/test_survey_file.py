import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coral.errors import InputError
from coral.reef.sea.survey_file import Origin, SurveyArea, contains_point, is_simple, is_survey, read_survey
from coral.reef.world.world import load_world

GOOD = """
format: coral-survey/1
name: harbour
size_m: [20, 10]
origin: {latitude: 54.0, longitude: 10.0}
start: {x: 2, y: 5, theta: 0}
geofence: {metres: [[1, 1], [19, 1], [19, 9], [1, 9]]}
keep_out:
  - {name: pier, metres: [[10, 0], [12, 0], [12, 6], [10, 6]]}
"""
L_SHAPE = ((0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4))


def read(tmp_path, text):
    path = tmp_path / "harbour.yaml"
    path.write_text(text)
    return read_survey(path)


def test_a_survey_knows_its_fence_and_keep_outs(tmp_path):
    area, _ = read(tmp_path, GOOD)
    assert area.breach(5, 5) == ""
    assert area.breach(0.5, 5) == "outside the geofence"
    assert area.breach(11, 3) == "inside keep-out 'pier'"


def test_forbidden_cells_are_those_whose_centre_breaches(tmp_path):
    area, _ = read(tmp_path, GOOD)
    cell = 0.25
    mask = area.forbidden(cell, (40, 80))
    expected = np.array([[area.breach((i + 0.5) * cell, (j + 0.5) * cell) != "" for i in range(80)] for j in range(40)])
    assert not (expected & ~mask).any()
    assert (mask & ~expected).mean() < 0.1  # the outlines themselves


def test_degrees_are_metres_from_the_origin(tmp_path):
    east, north = Origin(latitude=54.0, longitude=10.0).to_local(54.0001, 10.0001)
    assert north == pytest.approx(11.12, abs=0.01)
    assert east == pytest.approx(11.12 * math.cos(math.radians(54.0)), abs=0.01)
    ring = "[[54.0, 10.0], [54.0, 10.0003], [54.00009, 10.0003], [54.00009, 10.0]]"
    area, _ = read(
        tmp_path,
        GOOD.replace("geofence: {metres: [[1, 1], [19, 1], [19, 9], [1, 9]]}", f"geofence: {{degrees: {ring}}}"),
    )
    assert area.fence[2] == pytest.approx((19.61, 10.01), abs=0.02)


def test_an_area_may_lie_on_the_date_line():
    east, north = Origin(latitude=-17.0, longitude=179.9999).to_local(-17.0, -179.9999)
    assert (east, north) == pytest.approx((0.0002 * 111_195.0 * math.cos(math.radians(17.0)), 0.0), abs=0.01)
    assert Origin(latitude=-17.0, longitude=-179.9999).to_local(-17.0, 179.9999)[0] == pytest.approx(-east)


@pytest.mark.parametrize("longitude", [10.0, 179.9999])
def test_metres_become_degrees_and_metres_again(longitude):
    origin = Origin(latitude=54.0, longitude=longitude)
    latitude, east_of = origin.to_degrees(20.0, -30.0)
    assert -180.0 <= east_of < 180.0
    assert origin.to_local(latitude, east_of) == pytest.approx((20.0, -30.0))


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("[19, 9], [1, 9]", "[1, 9], [19, 9]", "geofence"),
        ("start: {x: 2", "start: {x: 0.5", "start"),
        ("start: {x: 2", "start: {x: 11", "start"),
        ("start: {x: 2", "start: {x: 9.9", "start"),
        ("metres: [[10, 0]", "points: [[10, 0]", "keep_out[0].points"),
        ("name: harbour", "nom: harbour", "nom"),
        ("size_m: [20, 10]", "size_m: [20, 1000]", "size_m[1]"),
        ("origin: {latitude: 54.0, longitude: 10.0}\n", "", "keep_out[0].degrees"),
        ("x: 2, y: 5", "x: .nan, y: 5", "start.x"),
    ],
)
def test_a_bad_file_is_refused_with_its_field(tmp_path, old, new, field):
    text = GOOD
    if field.endswith("degrees"):
        text = text.replace("metres: [[10, 0], [12, 0], [12, 6]", "degrees: [[54, 10], [54, 10.1], [54.1, 10]")
    with pytest.raises(InputError) as error:
        read(tmp_path, text.replace(old, new))
    assert error.value.field == field


def test_an_outline_without_corners_is_refused(tmp_path):
    with pytest.raises(InputError, match="neither metres nor degrees"):
        read(tmp_path, GOOD.replace("geofence: {metres: [[1, 1], [19, 1], [19, 9], [1, 9]]}", "geofence: {name: x}"))


def test_the_border_of_a_world_is_its_fence():
    world = load_world("s1")
    area = SurveyArea.of_world(world)
    assert area.breach(world.start.x, world.start.y) == ""
    assert area.breach(-0.1, 3.0) == "outside the geofence"
    assert not area.forbidden(0.5, (40, 40)).any()


def test_a_world_is_no_survey_file(tmp_path):
    (tmp_path / "a.yaml").write_text(GOOD)
    assert is_survey(tmp_path / "a.yaml")
    assert not is_survey(tmp_path / "missing.yaml")


def test_an_l_contains_its_arms_and_not_its_notch():
    assert contains_point(L_SHAPE, 3.5, 0.5)
    assert contains_point(L_SHAPE, 0.5, 3.5)
    assert not contains_point(L_SHAPE, 2.0, 2.0)
    assert not contains_point(L_SHAPE, -0.1, 0.5)


@given(st.floats(-2, 6), st.floats(-2, 6), st.integers(0, 5))
def test_containment_does_not_depend_on_the_first_corner(x, y, k):
    assert contains_point(L_SHAPE, x, y) == contains_point(L_SHAPE[k:] + L_SHAPE[:k], x, y)


def test_a_bow_tie_crosses_itself():
    assert is_simple(L_SHAPE)
    assert not is_simple(((0, 0), (1, 1), (1, 0), (0, 1)))


def test_corners_on_a_line_enclose_nothing():
    assert not is_simple(((0, 0), (1, 0), (2, 0)))
