"""SciPy's Rotation, state by state."""

import pytest

HEAD = "from scipy.spatial.transform import Rotation as R\n"
SAME = {
    "rotation": "r = R.from_quat(self.box_ori)\nreturn r.magnitude() + r.as_matrix()[0, 2] + r.apply([0, 0, 1])[1]",
    "rotation of the other order": "return R.from_quat(self.box_quat, scalar_first=True).as_quat()[3]",
    "relative rotation": "return (R.from_quat(self.box_ori) * R.from_quat(self.ee_ori).inv()).magnitude()",
    "rotation vector": "v = R.from_quat(self.box_ori).as_rotvec()\nreturn v[0] + 2.0 * v[1] + np.linalg.norm(v)",
    "euler angles": "e = R.from_quat(self.box_ori).as_euler('xyz')\nreturn e[0] + 2.0 * e[1] + 3.0 * e[2]",
    "euler angles in degrees": "e = R.from_quat(self.box_ori).as_euler('ZYX', degrees=True)\nreturn e[0] + 0.5 * e[2]",
    "from euler angles": (
        "r = R.from_euler('xyz', [0.1, self.time, 0.3])\ns = R.from_euler('z', 90, degrees=True)\n"
        "return (r * s).as_quat()[1] + r.as_euler('xyz')[1]"
    ),
    "from a rotation vector": (
        "r = R.from_rotvec(self.ee_pos)\nreturn r.as_rotvec()[0] + r.as_quat()[2] + R.identity().magnitude()"
    ),
    "rows turned": "m = np.stack([self.ee_pos, self.box_pos])\nreturn np.sum(R.from_quat(self.box_ori).apply(m)[1])",
    "turned back": "return R.from_quat(self.box_ori).apply(self.ee_pos, inverse=True)[0]",
    "small rotations stay exact": (
        "v = R.from_rotvec(1e-5 * self.ee_pos)\nw = R.from_rotvec(np.zeros(3))\n"
        "return 1e5 * v.as_rotvec()[0] + w.as_rotvec()[1] + w.magnitude()"
    ),
    "rotation of two branches": (
        "if self.time > 0.5:\n    r = R.from_quat(self.box_ori)\nelse:\n    r = R.from_quat(self.ee_ori)\n"
        "return r.magnitude()"
    ),
}
REFUSED = {
    "other euler angles": ("return R.from_quat(self.box_ori).as_euler('zxz')[0]", "wrong_call", "'xyz' or 'ZYX'"),
    "rotation of the wrong order": ("return R.from_quat(self.box_quat).magnitude()", "quaternion_order", "NAME_ori"),
    "rotation of a matrix": (
        "return R.from_matrix(np.eye(3)).magnitude()",
        "unknown_attribute",
        "it has from_euler",
    ),
    "too few angles": ("return R.from_euler('xyz', [0.1, 0.2]).magnitude()", "wrong_size", "takes 3 angles, not 2"),
    "quaternion as a rotation": (
        "return (R.from_quat(self.box_ori) * self.ee_ori).magnitude()",
        "wrong_type",
        "`*` does not apply",
    ),
    "long rotation vector": ("return R.from_rotvec(self.ee_quat).magnitude()", "wrong_size", "3 components, not 4"),
}


@pytest.mark.parametrize("case", sorted(SAME))
def test_a_rotation_gives_what_scipy_gives(case, agrees):
    agrees(HEAD + SAME[case])


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_a_rotation_that_cannot_be_made_is_refused(case, refusal):
    body, code, words = REFUSED[case]
    found = refusal(HEAD + body)
    assert (found.code, words in found.text) == (code, True), found
