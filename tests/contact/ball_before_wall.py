"""A red ball of radius 0.1 m at 0.8 m before a wall at 1 m, and a camera that looks straight at both."""

import mujoco

from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, look_at

WALL = """<mujoco><worldbody><geom type="box" size="2 .1 2" pos="0 1.1 0"/>
<body name="ball" pos="0 .8 0"><geom type="sphere" size=".1" rgba="1 0 0 1"/></body></worldbody></mujoco>"""


def scene(**more):
    model = mujoco.MjModel.from_xml_string(WALL)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return RayCamera(
        model, RgbdCameraCfg(width=160, height=120), look_at((0, 0, 0), (0, 1, 0)), {1: "ball"}, **more
    ), data
