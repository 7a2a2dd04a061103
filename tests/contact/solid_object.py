"""Models of objects of primitive parts."""

import mujoco

from coral.contact.perception.object_model import from_body


def solid(*parts):
    """Model an object of parts: MuJoCo's kind, its size, and where it is."""
    geoms = "".join(
        f'<geom type="{kind}" size="{" ".join(map(str, size))}" pos="{" ".join(map(str, *at or [(0, 0, 0)]))}"/>'
        for kind, size, *at in parts
    )
    return from_body(
        mujoco.MjModel.from_xml_string(f'<mujoco><worldbody><body name="thing">{geoms}</body></worldbody></mujoco>'),
        "thing",
    )
