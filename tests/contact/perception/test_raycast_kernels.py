"""The ray caster draws what mj_multiRay hits."""

import mujoco
import numpy as np
import pytest

from coral.contact.perception.camera import RayCamera, RgbdCameraCfg, look_at

SCENE = """<mujoco><asset><mesh name="m" vertex="0 0 0 .1 0 0 0 .1 0 0 0 .1"/></asset><worldbody>
<geom type="box" size=".5 .6 .02" pos="0 0 -.02"/><geom type="plane" size="0 0 1" pos="0 0 -.7"/>
<geom type="plane" size=".1 .2 1" pos="0 -.3 .1" euler="20 10 0"/>
<geom type="cylinder" size=".033 .06" pos=".1 .1 .06" euler="20 0 0"/>
<geom type="box" size=".05 .03 .04" pos="-.1 .05 .04" euler="0 10 30"/>
<geom type="capsule" size=".03 .06" pos=".1 -.1 .06" euler="70 20 0"/><geom type="sphere" size=".04" pos="-.1 -.1 .04"/>
<geom type="ellipsoid" size=".04 .06 .03" pos="-.2 -.1 .04" euler="0 40 0"/>
<geom type="mesh" mesh="m" pos="0 .2 .03" euler="30 0 0"/></worldbody></mujoco>"""


def cast(model, data, camera):
    """Depth, geom and normal of every pixel by MuJoCo."""
    cfg, lens, T = camera.cfg, camera.cfg.lens, camera.T_world_camera
    p, q = (np.arange(cfg.width) - lens[2]) / lens[0], (np.arange(cfg.height) - lens[3]) / lens[1]
    local = np.stack([*np.meshgrid(p, q), np.ones((cfg.height, cfg.width))], -1).reshape(-1, 3)
    length = np.linalg.norm(local, axis=1)
    rays, n = (local / length[:, None]) @ T[:3, :3].T, len(local)
    geom, distance, normal = np.zeros(n, np.int32), np.zeros(n), np.zeros(3 * n)
    mujoco.mj_multiRay(model, data, T[:3, 3].copy(), rays.ravel(), None, 1, -1, geom, distance, normal, n, 1e9)
    shape = (cfg.height, cfg.width)
    depth = np.where(geom >= 0, distance / length, 0.0).reshape(shape)
    return depth, geom.reshape(shape), normal.reshape(*shape, 3) @ T[:3, :3]


@pytest.mark.skipif("normal" not in mujoco.mj_multiRay.__doc__, reason="this MuJoCo gives no normals")
@pytest.mark.parametrize("eye", [(-0.7, 0.05, 0.7), (0.3, -0.8, 0.4), (0.25, 0.1, 0.06)])
def test_every_shape_as_mujoco_hits_it(eye):
    model = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera = RayCamera(
        model,
        RgbdCameraCfg(width=120, height=90, near_m=0.001, far_m=1e6),
        look_at(eye, (0, 0, 0.05)),
        {i: f"g{i}" for i in range(model.ngeom)},
        colours=True,
    )
    frame = camera.take(data)
    depth, geom, normal = cast(model, data, camera)

    same = frame.instance == geom + 1
    assert same.mean() > 0.9995  # at an edge, rounding decides
    np.testing.assert_allclose(frame.depth[same], depth[same], rtol=1e-5)
    from coral.contact.perception.normal_kernels import normals
    from coral.contact.perception.raycast_kernels import render

    T = camera.T_world_camera
    solids = camera._solids._replace(center=data.geom_xpos, rotation=data.geom_xmat.reshape(-1, 3, 3))
    turn, eye, lens = np.ascontiguousarray(T[:3, :3]), T[:3, 3].copy(), camera.cfg.lens
    trial = normals(turn, eye, lens, solids, render(turn, eye, lens, 0.001, 1e6, solids, *depth.shape))
    seen = same & (depth > 0)
    assert np.quantile(np.abs((trial[seen] * normal[seen]).sum(1)), 0.01) > 0.999
