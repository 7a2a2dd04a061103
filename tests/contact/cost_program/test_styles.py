"""Ways in which models write costs: most are accepted and give what Python with numpy gives, the others get a hint."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

from coral.contact.cost_program import CostError, CostProgram

REFUSED = {
    *("while loop", "while on the state", "del", "nonlocal", "try and except", "finally", "walrus", "scipy rotation"),
    *("set of a comprehension", "dict comprehension", "generator with a filter", "f-string keys", "from lines"),
    *("helper that adds terms", "item assignment", "for with break", "for over a range with continue"),
    *("star arguments in a call", "norm over an axis", "stack and mean", "matrix of a quaternion", "bits of truths"),
    *("getattr with defaults", "hasattr", "pybullet contact points", "pybullet pose"),
}

STYLES = {
    "one line": "def state_cost(self):\n    return np.linalg.norm(self.ee_pos - self.box_pos)",
    "import lines": """
        import numpy as np
        import math

        def state_cost(self):
            return math.exp(-np.linalg.norm(self.ee_pos)) + math.pi
    """,
    "from lines": """
        from math import exp as e

        def state_cost(self):
            return e(-self.time)
    """,
    "module constants": """
        W_REACH = 10.0
        W_LIFT, GOAL = 4.0, [0.1, 0.2, 0.3]

        def state_cost(self):
            return W_REACH * np.linalg.norm(self.ee_pos - self.box_pos) - W_LIFT * (self.box_pos[2] - GOAL[2])
    """,
    "module helper": """
        def sigmoid(x, k=1.0):
            return 1.0 / (1.0 + np.exp(-k * x))

        def state_cost(self):
            return sigmoid(self.box_pos[2], k=5.0) + sigmoid(self.time)
    """,
    "docstring and annotations": '''
        def state_cost(self) -> float:
            """Cost of one state."""
            reach: float = float(np.linalg.norm(self.ee_pos - self.box_pos))
            return 5.0 * reach
    ''',
    "nested def with a default": """
        def state_cost(self):
            def soft(x, width=0.1):
                return np.exp(-(x / width) ** 2)
            return -soft(np.linalg.norm(self.ee_pos)) - soft(self.time, width=0.5)
    """,
    "lambdas": """
        def state_cost(self):
            clip01 = lambda v: max(0.0, min(1.0, float(v)))
            d = lambda a, b: np.linalg.norm(np.array(a) - np.array(b))
            return clip01(self.box_pos[2]) + d(self.ee_pos, self.box_pos)
    """,
    "if and else": """
        def state_cost(self):
            cost = 0.0
            d = np.linalg.norm(self.ee_pos - self.box_pos)
            if d > 0.4:
                cost += 10.0 * d
            elif d > 0.2:
                cost += 5.0 * d
            else:
                cost -= 3.0
            return cost
    """,
    "early return": """
        def state_cost(self):
            if self.box_hand_contact:
                return -10.0 * self.box_pos[2]
            if self.time > 0.5:
                return 3.0
            return np.linalg.norm(self.ee_pos - self.box_pos)
    """,
    "early return in a helper": """
        def state_cost(self):
            def band(x):
                if x < 0.3:
                    return 0.3 - x
                if x > 0.6:
                    return x - 0.6
                return 0.0
            return band(self.time) + band(self.box_pos[0])
    """,
    "ternaries": """
        def state_cost(self):
            w = 2.0 if self.box_hand_contact else 8.0
            return w * np.linalg.norm(self.ee_pos - self.box_pos) * (1.0 if self.time > 0.5 else 0.5)
    """,
    "dict of weights": """
        def state_cost(self):
            weights = {"reach": 10.0, "lift": 5.0, "effort": 0.01}
            terms = {"reach": np.linalg.norm(self.ee_pos - self.box_pos), "lift": max(0.0, 0.2 - self.box_pos[2]),
                     "effort": np.sum(np.square(self.last_action))}
            return sum(weights[k] * terms[k] for k in weights)
    """,
    "dict of two weights": """
        def state_cost(self):
            w = {"reach": 2.0, "lift": 1.0}
            return w["reach"] * self.time + w["lift"] * self.gripper_opening
    """,
    "named terms returned": """
        def state_cost(self):
            return {"reach": 3.0 * norm(self.ee_pos - self.box_pos), "lift": -2.0 * self.box_pos[2]}
    """,
    "named terms accumulated": """
        def state_cost(self):
            terms = {}
            terms["reach"] = norm(self.ee_pos - self.box_pos)
            terms["touch"] = 0.0
            if not self.box_hand_contact:
                terms["touch"] += 2.0
            return terms
    """,
    "sum of values": """
        def state_cost(self):
            terms = {"reach": norm(self.ee_pos - self.box_pos)}
            if self.box_hand_contact:
                terms["bonus"] = -4.0
            return sum(terms.values())
    """,
    "helper that adds terms": """
        def state_cost(self):
            parts = []
            def add(w, value):
                parts.append(w * value)
            add(3.0, np.linalg.norm(self.ee_pos - self.box_pos))
            add(-2.0, self.box_pos[2])
            return sum(parts)
    """,
    "negated reward": """
        def state_cost(self):
            reward = 0.0
            reward += np.exp(-np.linalg.norm(self.ee_pos - self.box_pos))
            reward += 2.0 * self.box_pos[2]
            return -reward
    """,
    "sum of variables": """
        def state_cost(self):
            reach_cost = 10 * np.linalg.norm(self.ee_pos - self.box_pos)
            lift_cost = 5 * abs(self.box_pos[2] - 0.2)
            effort = 1e-3 * np.dot(self.last_action, self.last_action)
            return reach_cost + lift_cost + effort
    """,
    "list comprehension": """
        def state_cost(self):
            gaps = [abs(a - b) for a, b in zip(self.ee_pos, self.box_pos)]
            return sum(gaps) + max(gaps)
    """,
    "generator with a filter": """
        def state_cost(self):
            return sum(v ** 2 for v in self.last_action[:6] if v > 0.0)
    """,
    "dict comprehension": """
        def state_cost(self):
            base = {"a": 1.0, "b": 2.0}
            scaled = {k: 2.0 * v for k, v in base.items()}
            return scaled["a"] * self.time + scaled["b"]
    """,
    "for over points": """
        def state_cost(self):
            cost = 0.0
            for point, w in [(self.board_handle_pos, 2.0), (self.box_pos, 1.0)]:
                cost += w * np.linalg.norm(self.ee_pos - point)
            return cost
    """,
    "for over a range with continue": """
        def state_cost(self):
            cost = 0.0
            for i in range(3):
                gap = self.ee_pos[i] - self.box_pos[i]
                if gap < 0.0:
                    continue
                cost += gap ** 2
            return cost
    """,
    "for with break": """
        def state_cost(self):
            level = 0.0
            for i, bound in enumerate([0.2, 0.4, 0.6, 0.8]):
                if self.time < bound:
                    break
                level = i + 1.0
            return level
    """,
    "pybullet contact points": """
        def state_cost(self):
            touching = len(p.getContactPoints(self.panda, self.box)) > 0
            on_table = p.getContactPoints(self.box, self.table)
            return (0.0 if touching else 5.0) + (1.0 if on_table else 0.0)
    """,
    "pybullet pose": """
        def state_cost(self):
            pos, ori = p.getBasePositionAndOrientation(self.box)
            pos = np.array(pos)
            return np.linalg.norm(pos - self.ee_pos) + abs(ori[2])
    """,
    "getattr with defaults": """
        def state_cost(self):
            goal = np.array(getattr(self, "goal_pos", [0.3, 0.0, 0.2]))
            scale = getattr(self, "time", 1.0)
            return np.linalg.norm(self.box_pos - goal) * scale
    """,
    "hasattr": """
        def state_cost(self):
            cost = self.time
            if hasattr(self, "wrench"):
                cost += self.wrench[0]
            return cost
    """,
    "norm over an axis": """
        def state_cost(self):
            corners = np.array([self.box_pos, self.board_pos, self.ee_pos])
            return np.sum(np.linalg.norm(corners - self.ee_pos, axis=-1)) + np.linalg.norm(self.ee_pos, axis=-1)
    """,
    "stack and mean": """
        def state_cost(self):
            both = np.stack([self.box_pos, self.board_pos])
            return np.linalg.norm(both.mean(axis=0) - self.ee_pos)
    """,
    "concatenate": """
        def state_cost(self):
            u = np.concatenate([self.ee_vel, self.ee_angvel])
            return 0.1 * float(u @ u)
    """,
    "item assignment": """
        def state_cost(self):
            target = self.box_pos.copy()
            target[2] += 0.1
            flat = np.zeros(3)
            flat[:2] = target[:2]
            return np.linalg.norm(self.ee_pos - target) + np.linalg.norm(flat)
    """,
    "np.where and np.clip": """
        def state_cost(self):
            d = np.linalg.norm(self.ee_pos - self.box_pos)
            return np.where(d < 0.3, d ** 2, np.clip(d, 0.0, 0.5)) + np.maximum(0.0, self.time - 0.5)
    """,
    "weighted vector error": """
        def state_cost(self):
            w = np.array([1.0, 2.0, 0.5])
            e = (self.ee_pos - self.box_pos) * w
            return np.sum(e ** 2) + e.dot(e)
    """,
    "matrix of a quaternion": """
        def state_cost(self):
            w, x, y, z = self.box_quat
            R = np.array([[1 - 2*(y*y + z*z), 2*(x*y - w*z), 2*(x*z + w*y)],
                          [2*(x*y + w*z), 1 - 2*(x*x + z*z), 2*(y*z - w*x)],
                          [2*(x*z - w*y), 2*(y*z + w*x), 1 - 2*(x*x + y*y)]])
            up = R @ np.array([0.0, 0.0, 1.0])
            return 1.0 - up[2] + R[0, 2] + R[:, 0][1]
    """,
    "our quaternion helpers": """
        def state_cost(self):
            return quat_angle(self.box_quat, self.box_init_quat) + 1.0 - quat_axis(self.box_quat, 2)[2]
    """,
    "phases with a soft switch": """
        def state_cost(self):
            d = dist(self.ee_pos, self.box_pos)
            s = sigmoid(20.0 * (0.1 - d))
            return (1.0 - s) * d + s * abs(self.box_pos[2] - 0.2) - near(d, 0.05)
    """,
    "boolean algebra": """
        def state_cost(self):
            grasped = self.box_left_contact and self.box_right_contact
            lifted = not self.box_table_contact
            if grasped and lifted or self.time > 0.9:
                return 0.0
            return 1.0 + 2.0 * (not grasped)
    """,
    "bits of truths": """
        def state_cost(self):
            return 1.0 * (self.box_wall_contact & self.box_hand_contact)
    """,
    "chained comparison": """
        def state_cost(self):
            return 0.0 if 0.2 < self.time < 0.6 else 1.0
    """,
    "variable set in both branches": """
        def state_cost(self):
            if self.box_hand_contact:
                goal = np.array([0.2, 0.0, 0.3])
                w = 5.0
            else:
                goal = self.box_pos
                w = 2.0
            return w * np.linalg.norm(self.ee_pos - goal)
    """,
    "variable of one branch read in the same branch again": """
        def state_cost(self):
            cost = self.time
            if self.box_hand_contact:
                height = self.box_pos[2]
            if self.box_hand_contact:
                cost -= height
            return cost
    """,
    "walrus": """
        def state_cost(self):
            if (d := np.linalg.norm(self.ee_pos - self.box_pos)) > 0.3:
                return d
            return d ** 2
    """,
    "star arguments in a call": """
        def state_cost(self):
            gaps = [self.time, self.gripper_opening, 0.3]
            return max(*gaps) - min(gaps)
    """,
    "tuple unpacking": """
        def state_cost(self):
            (x, y, z), g = self.box_pos, self.gripper_opening
            a = b = x * y
            return a + b + z * g
    """,
    "closure over the state": """
        def state_cost(self):
            box = self.box_pos
            def gap(axis):
                return abs(self.ee_pos[axis] - box[axis])
            return sum([gap(i) for i in range(3)])
    """,
    "augmented by other operators": """
        def state_cost(self):
            cost = np.linalg.norm(self.ee_pos - self.box_pos)
            cost *= 2.0
            cost /= 1.0 + self.time
            cost **= 2
            return cost
    """,
    "np.abs and a number of times": """
        def state_cost(self):
            n = 3
            return np.abs(self.time) * n + float(self.box_hand_contact)
    """,
    "constant quantities": """
        def state_cost(self):
            slip = self.box_friction * self.box_mass * 9.81
            return max(0.0, np.linalg.norm(self.box_hand_force) - slip) + self.box_size[2]
    """,
    "other name for self": """
        def state_cost(env):
            return np.linalg.norm(env.ee_pos - env.box_pos)
    """,
    "try and except": """
        def state_cost(self):
            try:
                return self.time
            except Exception:
                return 0.0
    """,
    "scipy rotation": """
        from scipy.spatial.transform import Rotation as R
        def state_cost(self):
            return R.from_quat(self.box_ori).magnitude()
    """,
    "while loop": """
        def state_cost(self):
            i, cost = 0, 0.0
            while i < 3:
                cost += abs(self.ee_pos[i])
                i += 1
            return cost
    """,
    "finally": """
        def state_cost(self):
            try:
                cost = self.time
            finally:
                cost = 1.0
            return cost
    """,
    "set of a comprehension": """
        def state_cost(self):
            return len({i for i in range(3)}) + self.time
    """,
    "while on the state": """
        def state_cost(self):
            x = self.time
            while x > 0.1:
                x = x - 0.2
            return x
    """,
    "del": """
        def state_cost(self):
            x = self.time
            del x
            return 1.0
    """,
    "nonlocal": """
        def state_cost(self):
            n = 0
            def add():
                nonlocal n
                n = n + 1
            add()
            return n
    """,
    "f-string keys": """
        def state_cost(self):
            terms = {}
            for i in range(2):
                terms[f"axis {i}"] = self.ee_pos[i] ** 2
            return terms
    """,
}


def source_of(style):
    return textwrap.dedent(STYLES[style]).strip("\n")


def accepted(style, schema, state):
    try:
        CostProgram(source_of(style), schema)(state)
    except CostError:
        return False
    return True


def test_most_styles_are_accepted(schema, states):
    state = states(np.random.default_rng(0), 3, 3)
    refused = {style for style in STYLES if not accepted(style, schema, state)}
    assert refused == REFUSED
    assert len(STYLES) >= 40


@pytest.mark.parametrize("style", sorted(set(STYLES) - REFUSED))
def test_an_accepted_style_gives_what_python_gives(style, schema, states, plainly):
    state = states(np.random.default_rng(len(style)), 3, 4)
    source = source_of(style)
    program = CostProgram(source, schema)
    wanted = plainly(source, state)
    np.testing.assert_allclose(sum(program.evaluate(state).values()), wanted, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("style", sorted(REFUSED))
def test_a_refused_style_is_told_what_to_write_instead(style, schema, states):
    with pytest.raises(
        CostError, match=r"write |leave it out|return the value instead|make a new one|xs = xs|takes \("
    ) as caught:
        CostProgram(source_of(style), schema)(states(np.random.default_rng(0)))
    assert caught.value.line >= 1
