"""Batched rollouts by MuJoCo Warp: all rollouts at once on an NVIDIA GPU, or on the CPU as a check.

MuJoCo computes a single rollout on the CPU, such as the prediction before each plan: it has finished by the time that a
GPU has been told, and the GPU keeps its memory and its recorded step for batches of one size.

The same physics in single precision, with another order of sums: rollouts agree with MuJoCo's for some tenths of a
second and then part where contacts begin or end. On a GPU two runs need not agree bit for bit. Nothing sleeps here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from coral.contact.control.rollouts import Mend, Rolled, Rollouts, RolloutStart, column_major
from coral.contact.scene.observation import Array
from coral.errors import InputError, install_extra

MISSING = install_extra("warp")
CONTACTS, CONSTRAINTS = 96, 400
"""Room for each rollout. A grasped object among others needs some 20 contacts of four pyramid's edges each."""
KEPT_MODELS = 8
"""Models kept on the device: two tables for each of a few beliefs."""


@dataclass
class _OnDevice:
    """A model with its worlds on the device."""

    host: mujoco.MjModel
    model: Any
    data: Any
    worlds: int
    graph: Any = None
    """A step, recorded on a GPU."""


class WarpRollouts:
    """Rollouts on a device, with the interface of `Rollouts`.

    The device is one of Warp's, such as cuda:0 or cpu; "" takes the first GPU, or the CPU if there is none. The threads
    are for single rollouts under several beliefs; 0 uses every core.

    Raises:
        InputError: MuJoCo Warp is not installed, or there is no such device.
    """

    can_sleep = False

    def __init__(self, device: str = "", threads: int = 1) -> None:
        try:
            import mujoco_warp
            import warp
        except ImportError as error:
            raise InputError("--cfg", "planning.rollouts", f"warp ({error})", MISSING) from None
        warp.config.quiet = True
        self._physics, self._warp = mujoco_warp, warp
        known = [str(one) for one in warp.get_devices()]
        if device and device not in known:
            raise InputError("--cfg", "planning.device", repr(device), f"one of {', '.join(known)}")
        self.device = warp.get_device(device or next((one for one in known if one.startswith("cuda")), "cpu"))
        self._kept: dict[int, _OnDevice] = {}
        self._single = Rollouts(threads)

    def close(self) -> None:
        """Free the device's memory, and stop the threads."""
        self._kept.clear()
        self._single.close()

    def run(self, starts: Sequence[RolloutStart], control: Array, spec: int, every: int, mend: Mend) -> Rolled:
        """Roll out every start under its share of the controls; see `Rollouts.run`."""
        total, steps = control.shape[:2]
        each, first = total // len(starts), starts[0]
        if each == 1:
            return self._single.run(starts, control, spec, every, mend)
        found = Rolled(
            column_major(total, steps // every, len(first.state)),
            column_major(total, steps // every, first.model.nsensordata),
            np.empty(total, dtype=bool),
        )
        with self._warp.ScopedDevice(self.device):
            for k, start in enumerate(starts):
                rows = slice(k * each, (k + 1) * each)
                self._roll(start, control[rows], every, found.states[rows], found.sensors[rows])
        found.sane[:] = mend(found.states, found.sensors)
        return found

    def _roll(self, start: RolloutStart, control: Array, every: int, states: Array, sensors: Array) -> None:
        """Roll out one start into its rows of states and sensor data, Shape=(K, T, ...)."""
        warp, host = self._warp, start.model
        worlds, steps = control.shape[:2]
        own = self._on_device(host, worlds)
        data = own.data
        own.model.actuator_gainprm.assign(host.actuator_gainprm[None].astype(np.float32))
        own.model.actuator_biasprm.assign(host.actuator_biasprm[None].astype(np.float32))
        qpos, qvel = np.split(start.state[1 : 1 + host.nq + host.nv], [host.nq])
        data.time.fill_(float(start.state[0]))
        data.qpos.assign(np.tile(qpos, (worlds, 1)).astype(np.float32))
        data.qvel.assign(np.tile(qvel, (worlds, 1)).astype(np.float32))
        data.qacc_warmstart.zero_()
        inputs = self._upload(host, control)
        outputs = data.qpos, data.qvel, data.sensordata
        kept = [warp.empty((steps // every, *values.shape), dtype=float) for values in outputs]
        for step in range(steps):
            for into, values in zip((data.ctrl, data.mocap_pos, data.mocap_quat), inputs, strict=True):
                warp.copy(into, values[step])
            self._step(own)
            if (step + 1) % every == 0:
                for into, values in zip(kept, outputs, strict=True):
                    warp.copy(into[step // every], values)
        states[..., 0] = start.state[0] + host.opt.timestep * every * np.arange(1.0, steps // every + 1)
        for into, values in zip((*np.split(states[..., 1:], [host.nq], axis=-1), sensors), kept, strict=True):
            # The device turns it into column-major order, for which the CPU takes ten times as long.
            into[:] = np.moveaxis(values.transpose((2, 1, 0)).contiguous().numpy(), 0, -1)

    def _upload(self, host: mujoco.MjModel, control: Array) -> list[Any]:
        """Return controls, positions and orientations of the mocap body on the device, step by step."""
        warp, (worlds, steps) = self._warp, control.shape[:2]
        values = warp.array(control.astype(np.float32), dtype=float).transpose((1, 0, 2))
        ctrl, position, quaternion = (
            values[:, :, low:high].contiguous() for low, high in ((0, host.nu), (host.nu, -4), (-4, None))
        )
        shape = steps, worlds, 1
        return [ctrl, position.view(warp.vec3).reshape(shape), quaternion.view(warp.quat).reshape(shape)]

    def _on_device(self, host: mujoco.MjModel, worlds: int) -> _OnDevice:
        own = self._kept.pop(id(host), None)
        if own is None or own.worlds != worlds:
            data = self._physics.make_data(host, nworld=worlds, nconmax=CONTACTS, njmax=CONSTRAINTS)
            own = _OnDevice(host, self._put_model(host), data, worlds)
        self._kept[id(host)] = own  # the newest last
        while len(self._kept) > KEPT_MODELS:
            self._kept.pop(next(iter(self._kept)))
        return own

    def _put_model(self, host: mujoco.MjModel) -> Any:
        try:
            return self._physics.put_model(host)
        except NotImplementedError as error:
            raise InputError("--cfg", "planning.rollouts", f"warp ({error})", "mujoco for this task") from None

    def _step(self, own: _OnDevice) -> None:
        if not self.device.is_cuda:
            self._physics.step(own.model, own.data)
            return
        if own.graph is None:
            self._physics.step(own.model, own.data)  # compiles what is missing; only then can it be recorded
            with self._warp.ScopedCapture() as capture:
                self._physics.step(own.model, own.data)
            own.graph = capture.graph
        else:
            self._warp.capture_launch(own.graph)
