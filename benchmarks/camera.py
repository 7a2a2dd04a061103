"""CPU time of one depth + class + object picture: this package's renderer beside MuJoCo's mj_multiRay, same rays.

Usage: python benchmarks/camera.py [--poses 100] [--json]
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import time

import mujoco
import numpy as np

from coral.reef.vehicle.camera import Camera, CameraCfg, T_world_camera
from coral.reef.vehicle.collision import clearance
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import BOX, CYLINDER, ELLIPSOID, Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Start

NORMALS = (None,) if "normal" in mujoco.mj_multiRay.__doc__ else ()  # older ones do not give them
GEOM = {
    ELLIPSOID: mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    BOX: mujoco.mjtGeom.mjGEOM_BOX,
    CYLINDER: mujoco.mjtGeom.mjGEOM_CYLINDER,
}


def build_world(rng: np.random.Generator, oysters: int = 600, obstacles: int = 60) -> ReefWorld:
    """Ten clusters and scattered obstacles on 20 x 20 m."""
    middles = rng.uniform(3, 17, (10, 2))
    groups = []
    for i, (x, y) in enumerate(middles):
        spots = np.array([x, y]) + rng.normal(0, 0.6, (oysters // len(middles), 2))
        groups.append(
            Cluster(
                name=f"c{i}",
                oysters=tuple(
                    Oyster(
                        x=a,
                        y=b,
                        z=rng.uniform(0, 0.06),
                        radii=tuple(rng.uniform(0.03, 0.1, 3)),
                        rpy=tuple(rng.uniform(-3, 3, 3)),
                    )
                    for a, b in spots
                ),
            )
        )
    rocks = []
    for i in range(obstacles):
        a, b, c = rng.uniform(0.15, 0.5, 3)
        shape, size = (
            ("sphere", (a, a, a)),
            ("ellipsoid", (a, b, c)),
            ("cylinder", (a, a, 2 * c)),
            ("box", (a, b, c)),
        )[i % 4]
        x, y = rng.uniform(0, 20, 2)
        rocks.append(Obstacle(shape=shape, x=x, y=y, z=rng.uniform(0, 1), size=size, yaw=rng.uniform(-3, 3)))
    return ReefWorld(
        name="benchmark", size_m=(20, 20), start=Start(x=1, y=1), clusters=tuple(groups), obstacles=tuple(rocks)
    )


def build_mujoco(scene: Scene) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """One static body per cluster and one per obstacle, the layout that MuJoCo casts rays fastest with.

    Geoms are named after the solid's index.
    """
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, scene.seabed_z])
    bodies = [spec.worldbody.add_body() for _ in scene.cluster_names]
    for i in range(len(scene)):
        quat, half = np.zeros(4), scene.half[i]
        mujoco.mju_mat2Quat(quat, scene.rotation[i].ravel())
        body = bodies[scene.cluster[i]] if scene.cluster[i] >= 0 else spec.worldbody.add_body()
        size = [half[0], half[2], 0] if scene.kind[i] == CYLINDER else half
        body.add_geom(type=GEOM[int(scene.kind[i])], size=size, pos=scene.center[i], quat=quat, name=str(i))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def main() -> None:
    """Print median and 95th percentile of both, the ratio, and whether the pictures agree."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=100)
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    rng = np.random.default_rng(0)
    scene = Scene.from_world(build_world(rng))
    model, data = build_mujoco(scene)
    solid = np.array([int(model.geom(i).name or -1) for i in range(model.ngeom)])
    outlines, poses = scene.footprints(), []
    while len(poses) < args.poses:
        pose = Pose(*rng.uniform(0, 20, 2), rng.uniform(-math.pi, math.pi))
        if clearance(outlines, pose.x, pose.y) > 0.3:
            poses.append(pose)
    rows = []
    for width, height in ((160, 120), (320, 240), (640, 480)):
        cfg = CameraCfg(width=width, height=height)
        camera = Camera(scene, cfg)
        fx, fy, cx, cy = cfg.intrinsics
        u, v = np.meshgrid(np.arange(width), np.arange(height))
        rays = np.stack([(u - cx) / fx, (v - cy) / fy, np.ones_like(u, dtype=float)], axis=-1).reshape(-1, 3)
        length = np.linalg.norm(rays, axis=1)
        rays /= length[:, None]
        ids, distance = np.zeros(len(rays), np.int32), np.zeros(len(rays))
        camera.render(poses[0])
        own, peer, differ, lost, worst = [], [], 0, 0, 0.0
        few = poses[: max(3, args.poses * 160 * 120 // (2 * width * height))]
        for pose in few:
            transform = T_world_camera(pose, cfg)
            directions = (rays @ transform[:3, :3].T).ravel()
            start = time.process_time()
            # Its cutoff drops the infinite plane when the plane's origin is farther away, so it gets none.
            mujoco.mj_multiRay(
                model, data, transform[:3, 3].copy(), directions, None, 1, -1, ids, distance, *NORMALS, len(rays), 1e6
            )
            peer.append(time.process_time() - start)
            start = time.process_time()
            frame = camera.render(pose)
            own.append(time.process_time() - start)
            seen = (ids >= 0) & (distance < cfg.range_m)
            depth, single = frame.depth.ravel(), np.zeros(1, np.int32)
            for k in np.flatnonzero(np.where(seen, solid[ids], -1) != frame.instances.ravel()):
                # mj_multiRay culls by angle and may lose a grazing geom; mj_ray settles what is right.
                distance[k] = mujoco.mj_ray(
                    model, data, transform[:3, 3].copy(), directions[3 * k : 3 * k + 3], None, 1, -1, single
                )
                seen[k] = single[0] >= 0 and distance[k] < cfg.range_m
                settled = int(solid[single[0]]) if seen[k] else -1
                lost, differ = lost + 1, differ + int(settled != frame.instances.ravel()[k])
            differ += int((seen != np.isfinite(depth)).sum())
            error = np.abs(depth - distance / length)[seen & np.isfinite(depth)]
            worst = max(worst, float(error.max(initial=0.0)))
        for pose in poses:
            start = time.process_time()
            camera.render(pose)
            own.append(time.process_time() - start)
        rows.append(
            {
                "picture": f"{width}x{height}",
                "own_ms": float(np.median(own) * 1e3),
                "own_p95_ms": float(np.percentile(own, 95) * 1e3),
                "mujoco_ms": float(np.median(peer) * 1e3),
                "ratio": float(np.median(peer) / np.median(own)),
                "differing_pixels": differ,
                "lost_by_multiray": lost,
                "worst_depth_difference_m": worst,
                "pictures_compared": len(few),
            }
        )
    if args.json:
        print(
            json.dumps(
                {"mujoco": mujoco.__version__, "machine": platform.machine(), "solids": len(scene), "rows": rows}
            )
        )
        return
    print(f"{len(scene)} solids, one core, MuJoCo {mujoco.__version__}")
    print(
        "picture  coral median / p95 (ms)  mj_multiRay (ms)  ratio  wrong pixels  (mj_multiRay's)  depth difference (m)"
    )
    for r in rows:
        print(
            f"{r['picture']}  {r['own_ms']:12.3f} / {r['own_p95_ms']:5.3f}  {r['mujoco_ms']:16.2f}"
            f"  {r['ratio']:4.0f}x  {r['differing_pixels']:12d}  {r['lost_by_multiray']:16d}"
            f"  {r['worst_depth_difference_m']:20.1e}"
        )


if __name__ == "__main__":
    main()
