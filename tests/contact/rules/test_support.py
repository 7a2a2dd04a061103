import numpy as np
import pytest
from written_facts import brick, fixture, written

from coral.contact.rules.scene_reading import Thing
from coral.contact.rules.support import blocks, origin_height, other_things, rests_on, top_height

ON_ITS_SIDE = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)


def scene(**item):
    """A brick, and a shelf of 0.2 by 0.1 m whose top is 0.08 m high, turned by 90 degrees."""
    return written({"brick": brick(**item)}, {"shelf": fixture([0.2, 0.1, 0.08], [0.1, 0.2, 0.04], 90.0)})


def top(facts, name, x, y, within_m=0.0):
    return top_height(facts, name, np.array([x, y]), within_m)


def test_a_turned_fixture_holds_up_what_is_over_it():
    assert top(scene(), "shelf", 0.1, 0.29) == pytest.approx(0.08)
    assert top(scene(), "shelf", 0.19, 0.2) is None


def test_a_fixture_is_turned_to_the_left():
    beam = written({"brick": brick()}, {"beam": fixture([0.4, 0.02, 0.1], [0.0, 0.0, 0.05], 45.0)})
    assert top(beam, "beam", 0.1, 0.1) == pytest.approx(0.1)
    assert top(beam, "beam", 0.1, -0.1) is None


def test_near_is_measured_from_the_rim():
    assert top(scene(), "shelf", 0.18, 0.2, within_m=0.031) == pytest.approx(0.08)
    assert top(scene(), "shelf", 0.18, 0.2, within_m=0.029) is None
    # 3 cm and 4 cm beyond a corner
    assert top(scene(), "shelf", 0.18, 0.34, within_m=0.051) == pytest.approx(0.08)
    assert top(scene(), "shelf", 0.18, 0.34, within_m=0.049) is None


def test_the_table_holds_up_only_what_is_over_it():
    assert top(scene(), "table", 0.39, -0.39) == 0.0
    assert top(scene(), "table", 0.41, 0.0) is None


def test_of_an_object_of_several_parts_the_highest_one_there_counts():
    parts = [
        {"size_m": [0.1, 0.1, 0.02], "position": [0.0, 0.0, 0.0]},
        {"size_m": [0.02, 0.02, 0.1], "position": [0.04, 0.0, 0.06]},
    ]
    facts = scene(size=(0.1, 0.1, 0.12), parts=parts)
    assert top(facts, "brick", 0.0, 0.0) == pytest.approx(0.02)
    assert top(facts, "brick", 0.04, 0.0) == pytest.approx(0.12)
    assert top(facts, "brick", 0.0, 0.0, within_m=0.05) == pytest.approx(0.12)


def test_an_object_on_its_side_is_a_box_of_its_lying_extents():
    ((middle, ways, half, height),) = blocks(scene(at=(0.05, 0.0, 0.02), quat=ON_ITS_SIDE), "brick")
    assert list(middle) == [0.05, 0.0]
    np.testing.assert_allclose(np.abs(ways), np.eye(2), atol=1e-12)
    assert list(half) == [0.03, 0.01]
    assert height == pytest.approx(0.04)


def test_an_object_rests_on_what_its_underside_touches_to_a_centimetre():
    def on_shelf(z):
        facts = scene(at=(0.1, 0.2, z))
        return rests_on(Thing("brick", facts), facts, "shelf")

    assert [on_shelf(z) for z in (0.078, 0.09, 0.099, 0.102)] == [False, True, True, False]
    beside = scene(at=(-0.1, 0.2, 0.09))
    assert not rests_on(Thing("brick", beside), beside, "shelf")


def test_the_origin_may_be_high_over_the_underside():
    facts = scene(at=(0.0, 0.0, 0.05), middle_m=[0.0, 0.0, -0.03])
    assert origin_height(Thing("brick", facts)) == pytest.approx(0.04)


def test_other_things_are_the_table_the_fixtures_and_the_other_objects():
    facts = written({"brick": brick(), "cup": brick()}, {"shelf": fixture([0.1, 0.1, 0.1], [0.0, 0.0, 0.05])})
    assert other_things(facts, Thing("brick", facts)) == ["table", "shelf", "cup"]
