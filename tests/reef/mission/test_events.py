from coral.reef.mission.events import place_told


def test_the_place_on_a_saved_map_is_told_in_words():
    place = {"landmarks": 9, "recognised": 4, "x": 0.3, "y": 0.4, "theta": 0.1}
    assert place_told(place) == "4 of 9 landmarks recognised, odometry off by 0.50 m and 6 degrees"
    assert place_told({**place, "recognised": 0}).startswith("none of 9 landmarks recognised")
