"""Steps LIBERO's own environment for `benchmarks/libero_inside.py`, in a Python environment of LIBERO's.

LIBERO requires robosuite 1.4 and cannot share an environment with this package, so this program runs in one of its
own and imports nothing of ours. It reads one JSON object a line from standard input and answers each with one on
standard output, followed by the bytes of the picture where one was asked for.

    {"do": "make", "problem": FILE.bddl, "states": FILE.npz, "state": 0, "wait": 10}    a scene in an initial state
    {"do": "step", "action": [seven numbers]}                                            one action of OSC_POSE
    {"do": "picture"}                                                                    depth and objects
"""

import json
import os
import sys

os.environ.setdefault("MUJOCO_GL", "egl")
ANSWERS = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)  # whatever LIBERO prints goes to standard error

import numpy as np  # noqa: E402
from libero.libero.envs.env_wrapper import ControlEnv  # noqa: E402

CAMERA, WIDTH, HEIGHT = "agentview", 320, 240
SITE = "gripper0_grip_site"


class Scene:
    """A task of LIBERO in one of its initial states."""

    def __init__(self, problem, states, state, wait):
        self.env = ControlEnv(bddl_file_name=problem, use_camera_obs=False, horizon=10_000)
        self.env.seed(0)
        self.env.reset()
        with np.load(states, allow_pickle=False) as file:
            self.env.set_init_state(file["states"][state])
        for _ in range(wait):  # the objects fall the last centimetres, as in published evaluations
            self.env.step([0.0] * 6 + [-1.0])
        self.env.sim._render_context_offscreen.scn.flags[:] = 0  # no shadows, reflections, sky: depth has none
        self.began = self.env.sim.data.time
        self.inner = self.env.env
        self.bodies = self.inner.obj_body_id
        self.names = list(self.bodies)
        model = self.env.sim.model
        self.label = np.zeros(model.ngeom + 1, np.uint8)  # the last one is for pixels without a geom
        for geom in range(model.ngeom):
            body = model.geom_bodyid[geom]
            while model.body_parentid[body]:
                body = model.body_parentid[body]  # up to the body below the world
            name = model.body_id2name(body)
            if name.startswith(("robot0", "gripper0", "mount0")):
                self.label[geom] = 1 + len(self.names)
            elif body in self.bodies.values():
                self.label[geom] = 1 + list(self.bodies.values()).index(body)

    def camera(self):
        """Return the camera: its intrinsics, its position, and its axes x right, y down, z forward."""
        sim = self.env.sim
        index = sim.model.camera_name2id(CAMERA)
        axes = sim.data.cam_xmat[index].reshape(3, 3) @ np.diag([1.0, -1.0, -1.0])
        focal = 0.5 * HEIGHT / np.tan(np.radians(sim.model.cam_fovy[index]) / 2)
        return {
            "lens": [focal, focal, (WIDTH - 1) / 2, (HEIGHT - 1) / 2],
            "position": sim.data.cam_xpos[index].tolist(),
            "axes": axes.tolist(),
            "names": [*self.names, "robot"],
        }

    def state(self):
        """Return what the robot measures, LIBERO's own verdict, and the true poses of the objects."""
        data = self.env.sim.data
        robot = self.inner.robots[0]
        hand = data.get_site_xmat("gripper0_ft_frame")
        return {
            "time_s": data.time - self.began,
            "position": data.get_site_xpos(SITE).tolist(),
            "axes": data.get_site_xmat(SITE).tolist(),
            "velocity": data.get_site_xvelp(SITE).tolist(),
            "spin": data.get_site_xvelr(SITE).tolist(),
            "fingers": [float(data.qpos[k]) for k in robot._ref_gripper_joint_pos_indexes],
            "force": (hand @ robot.ee_force).tolist(),
            "solved": bool(self.env.check_success()),
            "objects": {
                name: [data.body_xpos[body].tolist(), data.body_xquat[body].tolist()]
                for name, body in self.bodies.items()
            },
        }

    def picture(self):
        """Return depth along the axis (m), Shape=(H, W), and labels: 1 + index of the name, 0 for the rest."""
        sim = self.env.sim
        geoms, depth = sim.render(width=WIDTH, height=HEIGHT, camera_name=CAMERA, depth=True, segmentation=True)
        geoms = geoms[..., 1]
        near, far = (part * sim.model.stat.extent for part in (sim.model.vis.map.znear, sim.model.vis.map.zfar))
        depth = near / (1.0 - depth[::-1] * (1.0 - near / far))  # from OpenGL's depth, and rows from the top
        return np.ascontiguousarray(depth, np.float32).reshape(HEIGHT, WIDTH), self.label[geoms[::-1]]


def main():
    """Answer until standard input ends."""
    scene = None
    for line in sys.stdin:
        asked = json.loads(line)
        blobs = []
        if asked["do"] == "make":
            scene = Scene(asked["problem"], asked["states"], asked["state"], asked["wait"])
            answer = {"camera": scene.camera(), **scene.state()}
        elif asked["do"] == "step":
            scene.env.step(asked["action"])
            answer = scene.state()
        else:
            blobs = list(scene.picture())
            answer = {"shape": [HEIGHT, WIDTH]}
        ANSWERS.write(json.dumps(answer).encode() + b"\n" + b"".join(blob.tobytes() for blob in blobs))
        ANSWERS.flush()


if __name__ == "__main__":
    main()
