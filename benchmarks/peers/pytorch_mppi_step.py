"""The peer's half of control_peer.py: our dynamics and costs written for pytorch-mppi; needs torch, not this package.

Usage: python pytorch_mppi_step.py PROBLEM.npz THREADS, then one JSON request a line on standard input.

Everything runs over all K rollouts at once, as pytorch-mppi asks for. Where the centre of the hull is far from
everything, its boundary points are left out, as in our kernel; a rollout that has collided is carried on, because a
batch cannot stop for one of its members.
"""

from __future__ import annotations

import json
import math
import sys
import time
import warnings

warnings.filterwarnings("ignore")

import numpy as np  # noqa: E402
import torch  # noqa: E402
from pytorch_mppi import MPPI  # noqa: E402

X, Y, TH, U, V, R, NEAREST, DRIVEN, PV, PW, SMOOTH, HIT, N_STATE = range(13)
COLLIDED = 1e4
"""Cost of a collision: exp(-1e4 / 0.03) is zero."""


class Problem:
    """Vehicle, map, cost-to-go and weights."""

    def __init__(self, path: str) -> None:
        data = np.load(path)
        # Lists, because a torch built for NumPy 1 cannot take over an array of NumPy 2.
        self.grid = {name: torch.tensor(data[name].tolist(), dtype=torch.float32) for name in ("distance", "value")}
        self.flat = {name: grid.reshape(-1) for name, grid in self.grid.items()}
        self.circle = torch.tensor(data["circle"].tolist(), dtype=torch.float32)
        self.table = {name: data[name].tolist() for name in ("dt", "substeps", "rate", "yaw_rate", "points")}
        self.weights = data["weights"].tolist()
        self.__dict__.update({name: float(data[name]) for name in data.files if data[name].ndim == 0})
        self.horizon = sum(self.table["dt"])
        self.last = len(self.table["dt"]) - 1
        self.x0 = self.y0 = self.v0 = 0.0

    def begin(self, state: list[float], previous: list[float]) -> torch.Tensor:
        """The state vector at the start of a plan; six numbers and the command being executed."""
        self.x0, self.y0 = state[0], state[1]
        self.v0 = float(self.look(torch.tensor([state[0]]), torch.tensor([state[1]]))[0])
        return torch.tensor([*state, 0.0, 0.0, *previous, 0.0, 0.0], dtype=torch.float32)

    def clearance(self, x: torch.Tensor, y: torch.Tensor) -> torch.Tensor:
        """Distance to the nearest obstacle or to the edge of the map."""
        h, w = self.grid["distance"].shape
        cell = self.cell_m
        edge = torch.minimum(torch.minimum(x, w * cell - x), torch.minimum(y, h * cell - y))
        i, j = (x / cell).long().clamp(0, w - 1), (y / cell).long().clamp(0, h - 1)
        return torch.minimum(edge, self.flat["distance"][j * w + i])

    def look(self, x: torch.Tensor, y: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        """Bilinear cost-to-go and its gradient."""
        h, w = self.grid["value"].shape
        cell, value = self.value_cell_m, self.flat["value"]
        fx, fy = (x / cell - 0.5).clamp(0.0, w - 1.001), (y / cell - 0.5).clamp(0.0, h - 1.001)
        i, j = fx.long(), fy.long()
        a, b = fx - i, fy - j
        at = j * w + i
        v00, v01, v10, v11 = value[at], value[at + 1], value[at + w], value[at + w + 1]
        low, high = v00 + a * (v01 - v00), v10 + a * (v11 - v10)
        return low + b * (high - low), ((1 - b) * (v01 - v00) + b * (v11 - v10)) / cell, (high - low) / cell

    def dynamics(self, state: torch.Tensor, command: torch.Tensor, t: int) -> torch.Tensor:
        """One step of the schedule: integration steps, swept collision checks, path length, smoothness."""
        x, y, th, u, v, r, _, driven, pv, pw, smooth, hit = state.unbind(1)
        cv, cw = command.unbind(1)
        dt, substeps = self.table["dt"][t], self.table["substeps"][t]
        rate, yaw_rate, points = self.table["rate"][t], self.table["yaw_rate"][t], self.table["points"][t]
        h = dt / substeps
        smooth = smooth + ((cv - pv) / self.speed_m_s) ** 2 + ((cw - pw) / self.yaw_rate_rad_s) ** 2
        nearest = torch.full_like(x, 1e9)
        hit = hit.clone()
        for _ in range(substeps):
            cor_u = self.m22 * v * r - (self.du + self.duu * u.abs()) * u
            cor_v = -self.m11 * u * r - (self.dv + self.dvv * v.abs()) * v
            cor_r = (self.m11 - self.m22) * u * v - (self.dr + self.drr * r.abs()) * r
            most = self.thrust_max
            n = ((self.m66 * yaw_rate * (cw - r) - cor_r) / self.moment_arm).clamp(-most, most)
            left = most - n.abs()
            fy = torch.clamp((-self.m22 * rate * v - cor_v) / self.force_arm, -left, left)
            left = left - fy.abs()
            fx = torch.clamp((self.m11 * rate * (cv - u) - cor_u) / self.force_arm, -left, left)
            u1 = u + h * (fx * self.force_arm + cor_u) / self.m11
            v1 = v + h * (fy * self.force_arm + cor_v) / self.m22
            r1 = r + h * (n * self.moment_arm + cor_r) / self.m66
            um, vm, half = 0.5 * (u + u1), 0.5 * (v + v1), 0.25 * h * (r + r1)
            c, s = torch.cos(th + half), torch.sin(th + half)
            dx, dy = h * (c * um - s * vm), h * (s * um + c * vm)
            step2 = dx * dx + dy * dy
            inside = (x + dx - self.x0) ** 2 + (y + dy - self.y0) ** 2 < self.range_m**2
            for part in (0.5, 1.0):
                check = inside & (step2 > self.cell_m**2) if part < 1.0 else inside
                if part < 1.0 and not bool(check.any()):
                    continue
                px, py = x + part * dx, y + part * dy
                d = self.clearance(px, py)
                nearest = torch.where(check, torch.minimum(nearest, d), nearest)
                hit[check & (d <= self.margin_m)] = 1.0
                close = (check & (d < self.hull_m + self.margin_m + 1.5 * self.cell_m)).nonzero()[:, 0]
                if len(close):
                    rim = self.circle[t, :points]
                    hull = self.clearance(
                        px[close, None] + self.hull_m * rim[:, 0], py[close, None] + self.hull_m * rim[:, 1]
                    )
                    hit[close[hull.amin(1) <= self.margin_m]] = 1.0
            x, y, th, u, v, r = x + dx, y + dy, th + 2.0 * half, u1, v1, r1
            driven = driven + step2.sqrt()
        return torch.stack([x, y, th, u, v, r, nearest, driven, cv, cw, smooth, hit], 1)

    def cost(self, state: torch.Tensor, command: torch.Tensor, t: int) -> torch.Tensor:
        """This step's share of the six cost terms."""
        goal, obstacle, speed, path, heading, smooth = self.weights
        dt, th = self.table["dt"][t], state[:, TH]
        value, gx, gy = self.look(state[:, X], state[:, Y])
        total = goal * 0.5 * value * dt / self.horizon / self.reach_m
        tight = (1.0 - (state[:, NEAREST] - self.body_m) / self.soft_m).clamp(min=0.0)
        total = total + obstacle * tight * tight * dt / self.horizon
        far = value.clamp(max=1.0) * dt / self.horizon
        slow = (1.0 - state[:, U].clamp(min=0.0) / self.speed_m_s).clamp(min=0.0)
        size = torch.sqrt(gx * gx + gy * gy).clamp(min=1e-9)
        away = 0.5 * (1.0 + (gx * torch.cos(th) + gy * torch.sin(th)) / size)
        total = total + (speed * slow + heading * away) * far
        if t == self.last:
            total = total + goal * (0.5 * value - self.v0) / self.reach_m
            total = total + path * (state[:, DRIVEN] + value - self.v0) / self.reach_m
            total = total + smooth * state[:, SMOOTH] / (self.last + 1) + COLLIDED * state[:, HIT]
        return total


def main() -> None:
    """Answer requests until the input ends."""
    problem = Problem(sys.argv[1])
    torch.set_num_threads(int(sys.argv[2]))
    torch.manual_seed(0)
    limits = torch.tensor([problem.speed_m_s, problem.yaw_rate_rad_s])
    sigma = torch.diag(torch.tensor([problem.sigma_v**2, problem.sigma_omega**2]))
    planner = MPPI(
        problem.dynamics,
        problem.cost,
        N_STATE - 1,
        sigma,
        num_samples=int(problem.n_rollouts),
        horizon=problem.last + 1,
        lambda_=problem.temperature,
        u_min=limits * torch.tensor([0.0, -1.0]),
        u_max=limits,
        U_init=torch.zeros(problem.last + 1, 2),
        step_dependent_dynamics=True,
        sample_null_action=True,
    )
    print(json.dumps({"torch": torch.__version__, "threads": torch.get_num_threads()}), flush=True)
    clock = time.process_time if int(sys.argv[2]) == 1 else time.perf_counter
    previous = [0.0, 0.0]
    with torch.no_grad():
        for line in sys.stdin:
            asked = json.loads(line)
            if "controls" in asked:
                controls = torch.tensor(asked["controls"], dtype=torch.float32)
                state = problem.begin(asked["state"], asked["previous"]).expand(len(controls), -1)
                total = torch.zeros(len(controls))
                for t in range(controls.shape[1]):
                    state = problem.dynamics(state, controls[:, t], t)
                    total = total + problem.cost(state, controls[:, t], t)
                print(json.dumps({"costs": total.tolist(), "hit": (state[:, HIT] > 0).tolist()}), flush=True)
                continue
            begun = clock()
            command = planner.command(problem.begin(asked["state"], previous))
            ms = 1e3 * (clock() - begun)
            previous = command.tolist()
            finite = all(map(math.isfinite, previous))
            print(json.dumps({"ms": ms, "command": previous if finite else None}), flush=True)


if __name__ == "__main__":
    main()
