import mujoco
import numpy as np
import pytest

from coral.contact.perception.solids import from_mujoco
from coral.errors import InputError


def test_a_height_field_is_refused_by_name():
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/></asset><worldbody>'
        '<geom name="hill" type="hfield" hfield="h"/></worldbody></mujoco>'
    )
    with pytest.raises(InputError, match="hill"):
        from_mujoco(model, np.array([0]))
