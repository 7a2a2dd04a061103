"""What a survey leaves undone."""

from beds import belief_with, see

from coral.reef.pilot.leftover import what_is_left


def reasons(belief):
    return {one["index"]: one["why"] for one in what_is_left(belief)}


def test_finished_clusters_are_not_listed_and_the_others_have_a_reason():
    belief = belief_with([(4.0, 4.0), (10.0, 4.0), (16.0, 4.0), (16.0, 16.0)])
    first, second, third, fourth = (track.index for track in belief.tracks)
    see(belief, first)
    see(belief, second, 0.4)
    belief.goal, belief.goal_index = (16.0, 4.0), third
    assert reasons(belief) == {second: "begun", third: "on the way there", fourth: "not reached yet"}
    (begun, *_) = what_is_left(belief)
    assert (begun["x"], begun["y"]) == (10.0, 4.0)
    assert 0.3 < begun["inspected"] < 0.5


def test_a_cluster_given_up_says_after_how_many_goals():
    belief = belief_with([(4.0, 4.0)])
    belief.goal = (4.0, 4.0)
    for _ in range(2):
        belief.goal_failed("stuck")
    assert [*reasons(belief).values()] == ["given up after 2 goals that failed"]
