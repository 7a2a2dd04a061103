import math

import mujoco
import numpy as np
import pytest

from coral.errors import InputError
from coral.reef.vehicle.camera import Camera, CameraCfg, T_world_camera, pixel_rays, ray_lengths
from coral.reef.world.geometry import Label, Pose
from coral.reef.world.scene import BOX, CYLINDER, ELLIPSOID, Scene
from coral.reef.world.world import Cluster, Obstacle, Oyster, ReefWorld, Seabed, Start

GEOM = {
    ELLIPSOID: mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    BOX: mujoco.mjtGeom.mjGEOM_BOX,
    CYLINDER: mujoco.mjtGeom.mjGEOM_CYLINDER,
}
ORACLE = pytest.mark.skipif(
    "normal" not in mujoco.mj_multiRay.__doc__, reason="this MuJoCo loses pixels, and takes other arguments"
)


def random_world(seed, oysters=120, obstacles=40, z_m=-2.0):
    rng = np.random.default_rng(seed)
    middles = rng.uniform(2, 10, (4, 2))

    def oyster(i):
        x, y = middles[i % 4] + rng.normal(0, 0.6, 2)
        return Oyster(
            x=x,
            y=y,
            z=z_m + rng.uniform(0, 0.1),
            radii=tuple(rng.uniform(0.03, 0.15, 3)),
            rpy=tuple(rng.uniform(-3, 3, 3)),
        )

    def obstacle(i):
        a, b, c = rng.uniform(0.1, 0.7, 3)
        shape, size = (("sphere", (a, a, a)), ("ellipsoid", (a, b, c)), ("cylinder", (a, a, c)), ("box", (a, b, c)))[
            i % 4
        ]
        x, y = rng.uniform(0, 12, 2)
        return Obstacle(shape=shape, x=x, y=y, z=z_m + rng.uniform(0, 1.8), size=size, yaw=rng.uniform(-3, 3))

    clusters = tuple(Cluster(name=f"c{k}", oysters=tuple(oyster(k) for _ in range(oysters // 4))) for k in range(4))
    return ReefWorld(
        name="random",
        size_m=(12, 12),
        seabed=Seabed(z_m=z_m),
        start=Start(x=1, y=1),
        clusters=clusters,
        obstacles=tuple(obstacle(i) for i in range(obstacles)),
    )


def lone(obstacle=None, z_m=0.0):
    """A scene with one far oyster and perhaps an obstacle."""
    oyster = Oyster(x=-500, y=0, z=z_m, radii=(0.1, 0.1, 0.1))
    return Scene.from_world(
        ReefWorld(
            name="lone",
            size_m=(20, 20),
            seabed=Seabed(z_m=z_m),
            start=Start(x=1, y=1),
            clusters=(Cluster(name="far", oysters=(oyster,)),),
            obstacles=(obstacle,) if obstacle else (),
        )
    )


class MujocoCamera:
    """Oracle: MuJoCo's own ray caster, one ray per pixel."""

    def __init__(self, scene, cfg):
        spec = mujoco.MjSpec()
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, scene.seabed_z])
        for kind, center, half, turn in zip(scene.kind, scene.center, scene.half, scene.rotation, strict=True):
            quat = np.zeros(4)
            mujoco.mju_mat2Quat(quat, turn.ravel())
            size = [half[0], half[2], 0] if kind == CYLINDER else half
            spec.worldbody.add_geom(type=GEOM[int(kind)], size=size, pos=center, quat=quat)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.cfg = cfg
        fx, fy, cx, cy = cfg.intrinsics
        u, v = np.meshgrid(np.arange(cfg.width), np.arange(cfg.height))
        rays = np.stack([(u - cx) / fx, (v - cy) / fy, np.ones_like(u, dtype=float)], axis=-1).reshape(-1, 3)
        self.length = np.linalg.norm(rays, axis=1)
        self.rays = rays / self.length[:, None]

    def render(self, transform):
        """Depth and solid of every pixel."""
        n = len(self.rays)
        ids, distance = np.zeros(n, np.int32), np.zeros(n)
        directions = (self.rays @ transform[:3, :3].T).ravel()
        mujoco.mj_multiRay(
            self.model, self.data, transform[:3, 3].copy(), directions, None, 1, -1, ids, distance, None, n, 1e6
        )
        shape = (self.cfg.height, self.cfg.width)
        return self.cut(ids.reshape(shape), distance.reshape(shape), self.length.reshape(shape))

    def pixel(self, transform, k):
        """Depth and solid of one pixel (flat index) by a single ray, which nothing is culled from."""
        ids = np.zeros(1, np.int32)
        distance = mujoco.mj_ray(
            self.model, self.data, transform[:3, 3].copy(), transform[:3, :3] @ self.rays[k], None, 1, -1, ids
        )
        return self.cut(ids[0], distance, self.length[k])

    def cut(self, ids, distance, length):
        seen = (ids >= 0) & (distance < self.cfg.range_m)
        return np.where(seen, distance / length, np.inf), np.where(seen, ids - 1, -1)


def assert_same(scene, frame, oracle, transform):
    """Equal on every pixel. Returns the solids seen."""
    depth, ids = oracle.render(transform)
    # mj_multiRay culls geoms by angle and now and then loses a grazing one: about one pixel in three million, in
    # which mj_ray settles what is right.
    doubtful = np.flatnonzero(frame.instances != ids)
    assert len(doubtful) <= 2
    for k in doubtful:
        depth.flat[k], ids.flat[k] = oracle.pixel(transform, k)
    np.testing.assert_array_equal(frame.instances, ids)
    np.testing.assert_array_equal(np.isfinite(frame.depth), np.isfinite(depth))
    seen = np.isfinite(depth)
    np.testing.assert_allclose(frame.depth[seen], depth[seen], rtol=0, atol=1e-5)
    solids = np.where(ids >= 0, scene.label[ids], Label.SEABED)
    np.testing.assert_array_equal(frame.labels, np.where(seen, solids, Label.WATER))
    return ids


@ORACLE
@pytest.mark.parametrize("seed", range(4))
def test_picture_equals_mujocos_ray_casting(seed):
    scene, cfg = Scene.from_world(random_world(seed)), CameraCfg()
    camera, oracle = Camera(scene, cfg), MujocoCamera(scene, cfg)
    rng = np.random.default_rng(100 + seed)
    shown = set()
    for k in range(5):
        pose = Pose(*rng.uniform(0, 12, 2), rng.uniform(-math.pi, math.pi))
        roll, pitch = rng.normal(0, 0.4, 2) if k % 2 else (0.0, 0.0)
        altitude = rng.uniform(0.3, 2.5)
        frame = camera.render(pose, altitude, roll=roll, pitch=pitch)
        transform = T_world_camera(pose, cfg, seabed_z=scene.seabed_z, altitude=altitude, roll=roll, pitch=pitch)
        ids = assert_same(scene, frame, oracle, transform)
        shown |= set(scene.kind[ids[ids >= 0]].tolist())
    assert shown == {ELLIPSOID, BOX, CYLINDER}


@ORACLE
@pytest.mark.parametrize("shape", ["sphere", "ellipsoid", "cylinder", "box"])
def test_a_close_solid_equals_mujocos_even_beside_and_around_the_camera(shape):
    """Solids that reach behind the image plane have silhouettes without end; around the camera they have none."""
    size = {
        "sphere": (0.6, 0.6, 0.6),
        "ellipsoid": (0.9, 0.4, 0.7),
        "cylinder": (0.5, 0.5, 1.5),
        "box": (0.9, 0.4, 0.7),
    }[shape]
    scene = lone(Obstacle(shape=shape, x=10, y=10, z=0.8, size=size, yaw=0.5))
    cfg = CameraCfg(near_m=1e-6, width=96, height=72)
    camera, oracle = Camera(scene, cfg), MujocoCamera(scene, cfg)
    inside = 0
    for k, angle in enumerate(np.linspace(0, 2 * math.pi, 24, endpoint=False)):
        away = (0.0, 0.45, 0.95)[k % 3]
        pose = Pose(10 + away * math.cos(angle), 10 + away * math.sin(angle), 5 * angle)
        frame = camera.render(pose, roll=0.3 * math.sin(k), pitch=0.6 * math.cos(k))
        transform = T_world_camera(pose, cfg, roll=0.3 * math.sin(k), pitch=0.6 * math.cos(k))
        ids = assert_same(scene, frame, oracle, transform)
        inside += bool((ids == 1).all())
    assert inside >= 8


def test_a_sphere_ahead_is_as_far_as_its_front():
    cfg = CameraCfg(width=161, height=121, pitch_down_deg=0)
    frame = Camera(lone(Obstacle(shape="sphere", x=5, y=2, z=1, size=(0.5, 0.5, 0.5))), cfg).render(Pose(2, 2, 0))
    assert frame.depth[60, 80] == pytest.approx(2.5, abs=1e-6)
    assert frame.labels[60, 80] == Label.OBSTACLE
    assert frame.instances[60, 80] == 1
    # Its silhouette's half-angle is asin(0.5 / 3); fx pixels make a slope of 1.
    row = np.flatnonzero(frame.instances[60] == 1)
    reach = math.floor(cfg.intrinsics[0] * math.tan(math.asin(0.5 / 3)))
    assert (row[0], row[-1]) == (80 - reach, 80 + reach)


def test_left_is_left_and_up_is_up():
    box = Obstacle(shape="box", x=5, y=4, z=2.5, size=(0.2, 0.2, 0.2))
    frame = Camera(lone(box), CameraCfg(pitch_down_deg=0)).render(Pose(2, 2, 0))
    v, u = np.nonzero(frame.instances == 1)
    assert u.max() < 79.5
    assert v.max() < 59.5


def test_surfaces_nearer_than_the_near_plane_are_not_seen():
    sphere = Obstacle(shape="sphere", x=5, y=2, z=1, size=(0.5, 0.5, 0.5))
    cfg = CameraCfg(width=161, height=121, pitch_down_deg=0, near_m=0.2)
    camera = Camera(lone(sphere), cfg)
    assert camera.render(Pose(4.25, 2, 0)).depth[60, 80] == pytest.approx(0.25, abs=1e-6)
    assert camera.render(Pose(4.35, 2, 0)).depth[60, 80] == pytest.approx(1.15, abs=1e-6)


def test_nothing_is_seen_beyond_the_range():
    scene, cfg = Scene.from_world(random_world(1)), CameraCfg(range_m=3.0)
    frame = Camera(scene, cfg).render(Pose(1, 1, 0.8))
    fx, fy, cx, cy = cfg.intrinsics
    u, v = np.meshgrid(np.arange(cfg.width), np.arange(cfg.height))
    length = np.sqrt(1 + ((u - cx) / fx) ** 2 + ((v - cy) / fy) ** 2)
    seen = np.isfinite(frame.depth)
    assert (frame.depth * length)[seen].max() <= 3.0
    assert (frame.depth * length)[seen].max() > 2.9
    assert (frame.labels == Label.WATER)[~seen].all()
    far = Camera(scene, CameraCfg()).render(Pose(1, 1, 0.8))
    np.testing.assert_array_equal(frame.depth[seen], far.depth[seen])


def test_pose_of_the_camera():
    level = T_world_camera(Pose(1, 2, 0), CameraCfg(pitch_down_deg=0), seabed_z=-3)
    np.testing.assert_allclose(level[:3, 3], [1, 2, -2])
    np.testing.assert_allclose(level[:3, :3] @ [0, 0, 1], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(level[:3, :3] @ [1, 0, 0], [0, -1, 0], atol=1e-15)
    np.testing.assert_allclose(level[:3, :3] @ [0, 1, 0], [0, 0, -1], atol=1e-15)
    tilted = T_world_camera(Pose(0, 0, 0), CameraCfg(pitch_down_deg=20), pitch=math.radians(10))
    np.testing.assert_allclose(tilted[:3, :3] @ [0, 0, 1], [math.cos(math.pi / 6), 0, -0.5], atol=1e-15)
    rolled = T_world_camera(Pose(0, 0, 0), CameraCfg(pitch_down_deg=0), roll=0.1)
    assert (rolled[:3, :3] @ [1, 0, 0])[2] < 0


def test_the_field_of_view_spans_the_outer_edges_of_the_pixels():
    cfg = CameraCfg(width=160, hfov_deg=120)
    fx, fy, cx, cy = cfg.intrinsics
    assert (159.5 - cx) / fx == pytest.approx(math.tan(math.radians(60)))
    assert (fx, cy) == (fy, 59.5)


def test_each_picture_has_its_own_memory():
    camera = Camera(lone())
    first = camera.render(Pose(0, 0, 0))
    kept = first.depth.copy()
    camera.render(Pose(0, 0, 0), altitude=3.0)
    np.testing.assert_array_equal(first.depth, kept)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("width", 1),
        ("hfov_deg", 180.0),
        ("altitude_m", 0.0),
        ("range_m", math.inf),
        ("near_m", 0.0),
        ("pitch_down_deg", 91.0),
        ("hfov_deg", math.nan),
    ],
)
def test_a_bad_setting_is_named(field, value):
    with pytest.raises(InputError, match=f"camera: {field}"):
        CameraCfg(**{field: value})


def test_a_lost_pose_sees_no_solid():
    camera = Camera(Scene.from_world(random_world(0)))
    for pose in (Pose(math.nan, 5, 0), Pose(5, 5, math.nan)):
        assert (camera.render(pose).instances == -1).all()


def test_a_flush_of_edge_poses_never_writes_outside():
    """Straight down over a cylinder's axis, level with a box's faces, exactly on a surface."""
    for shape in ("sphere", "ellipsoid", "cylinder", "box"):
        camera = Camera(
            lone(Obstacle(shape=shape, x=5, y=5, z=1, size=(1, 1, 1))),
            CameraCfg(width=41, height=31, pitch_down_deg=90),
        )
        for x in (4.0, 5.0, 6.0):
            for altitude in (0.5, 2.0, 3.0):
                for pitch in (0.0, -math.pi / 2):
                    frame = camera.render(Pose(x, 5, 0), altitude, pitch=pitch)
                    assert not np.isnan(frame.depth).any()
                    assert frame.instances.max() <= 1
        assert camera.render(Pose(5, 5, 0), 3.0).depth[15, 20] == pytest.approx(1.0, abs=1e-6)


def test_a_ray_is_longer_than_its_depth_off_the_axis():
    lengths = ray_lengths(CameraCfg(width=3, height=3, hfov_deg=90.0))
    assert lengths[1, 1] == 1.0
    np.testing.assert_allclose(lengths[1, 2], np.sqrt(1 + (1 / 1.5) ** 2), rtol=1e-6)


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, 0.0), (0.1, -0.2)])
def test_rays_of_pixels_near_and_below_the_axis(roll, pitch):
    camera = CameraCfg()
    rays = pixel_rays(camera, roll, pitch)
    down = T_world_camera(Pose(0.0, 0.0, 0.0), camera, roll=roll, pitch=pitch)[2, :3] @ [0.0, 0.0, 1.0]
    assert -rays[60, 80, 2] == pytest.approx(-down, abs=2.0 / camera.intrinsics[0])
    assert -rays[-1, 80, 2] > math.tan(math.radians(camera.pitch_down_deg))
