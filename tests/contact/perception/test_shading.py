import numpy as np

from coral.contact.perception.shading import shade

LENS = np.array([1.0, 1.0, 0.0, 0.0])
"""Of a picture whose pixel (0, 0) looks straight ahead and (0, 1) 45 degrees to the right."""
WHITE = np.ones((1, 3))
AHEAD, UP = [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]


def light(*normals, colour=WHITE, solid=0):
    """Red, green and blue of a row of pixels with these normals."""
    return shade(np.array([normals]), np.full((1, len(normals)), solid, np.int64), colour, LENS)[0].tolist()


def test_a_surface_that_faces_the_camera_has_the_headlight_on_it():
    assert light(AHEAD) == [[179] * 3]  # (0.3 + 0.4) of 255


def test_the_headlight_falls_with_the_angle_to_the_ray():
    assert light(AHEAD, AHEAD)[1] == [149] * 3  # (0.3 + 0.4 cos 45) of 255


def test_a_surface_that_faces_up_has_the_lamp_on_it():
    assert light(UP) == [[153] * 3]  # (0.3 + 0.3) of 255


def test_what_is_turned_away_from_both_has_the_ambient_light_alone():
    assert light([0.0, 1.0, 0.0]) == [[77] * 3]  # 0.3 of 255


def test_colours_are_those_of_the_solids():
    assert light(AHEAD, colour=np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]]), solid=1) == [[179, 89, 0]]


def test_where_nothing_is_seen_is_sky():
    assert light([0.0, 0.0, 0.0], solid=-1) == [[191, 209, 230]]
