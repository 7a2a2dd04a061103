import mujoco
import numpy as np
import pytest

from coral.contact.worlds.merged_contacts import merged_contacts

SCENE = """
<mujoco>
  <worldbody>
    <geom name="slab" type="box" size="1 1 0.1" pos="0 0 -0.1"/>
    <body name="first" pos="0.3 0 0.049"><freejoint/>
      <geom name="{first}" type="box" size="0.05 0.05 0.05" mass="2"/>
    </body>
    <body name="second" pos="0.3 0 0.148"><freejoint/>
      <geom name="{second}" type="box" size="0.05 0.05 0.05" mass="1"/>
    </body>
  </worldbody>
</mujoco>
"""
"""Two boxes on top of each other on a slab, 2 kg below and 1 kg above."""


def part_of(model, geom):
    return model.geom(geom).name.split("_")[0]


def contacts(first="lower", second="upper"):
    model = mujoco.MjModel.from_xml_string(SCENE.format(first=first, second=second))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 500)
    return {(one.first, one.second): one for one in merged_contacts(model, data, part_of)}


def test_the_points_of_a_contact_are_merged_into_its_net_force():
    found = contacts()
    assert set(found) == {("lower", "slab"), ("lower", "upper")}
    np.testing.assert_allclose(found["lower", "slab"].force, [0.0, 0.0, -3 * 9.81], atol=0.02)
    np.testing.assert_allclose(found["lower", "upper"].force, [0.0, 0.0, 9.81], atol=0.02)


def test_the_force_is_that_of_the_first_on_the_second_in_the_order_of_the_alphabet():
    found = contacts(first="wood")
    assert set(found) == {("slab", "wood"), ("upper", "wood")}
    assert found["slab", "wood"].force[2] == pytest.approx(3 * 9.81, abs=0.02)
    assert found["upper", "wood"].force[2] == pytest.approx(-9.81, abs=0.02)


def test_the_point_is_the_middle_of_where_it_presses():
    found = contacts()
    np.testing.assert_allclose(found["lower", "slab"].point, [0.3, 0.0, 0.0], atol=2e-3)
    np.testing.assert_allclose(found["lower", "upper"].point, [0.3, 0.0, 0.1], atol=4e-3)


def test_parts_of_one_name_do_not_touch_each_other():
    assert set(contacts(first="box_1", second="box_2")) == {("box", "slab")}
