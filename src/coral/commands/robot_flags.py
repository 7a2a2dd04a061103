"""The flags of `coral contact run` that concern a robot, and what answers to them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.scene.trial import Trial
from coral.contact.worlds.robot_world import RobotWorld
from coral.errors import InputError
from coral.plugins import find_plugins, has_plugin, named_plugin

GROUP = "coral.robots"
SIMULATED, SIMULATED_CAMERA = "sim", "sim"


@dataclass(frozen=True)
class RobotFlags:
    """The flags of the command that concern an arm."""

    world: str
    robot: str | None
    dry_run: bool
    yes: bool
    quiet: bool
    camera: str | None = None
    camera_pose: Path | None = None
    masks: str | None = None

    def check(self) -> bool:
        """Return whether an arm is asked for.

        Raises:
            InputError: The flags contradict each other.
        """
        if not self.given:
            for name, value in (
                ("--robot", self.robot),
                ("--dry-run", self.dry_run),
                ("--yes", self.yes),
                ("--camera", self.camera),
                ("--camera-pose", self.camera_pose),
                ("--masks", self.masks),
            ):
                if value:
                    raise InputError(name, "", value, f"it goes with --world {' or '.join(robot_names())} only")
            return False
        if not self.robot:
            raise InputError("--robot", "", "nothing", f"the arm's address, or {SIMULATED!r} for the simulated arm")
        if self.yes and self.robot != SIMULATED and not self.dry_run:
            raise InputError(
                "--yes",
                "",
                f"--robot {self.robot}",
                f"--robot {SIMULATED}: a real arm moves only when a person confirms",
            )
        self._check_camera()
        return True

    def _check_camera(self) -> None:
        if self.camera is None:
            for name, value in (("--camera-pose", self.camera_pose), ("--masks", self.masks)):
                if value:
                    raise InputError(name, "", value, "it goes with --camera only")
        elif (self.camera == SIMULATED_CAMERA) != (self.robot == SIMULATED):
            expected = f"--camera {SIMULATED_CAMERA} with --robot {SIMULATED}, a real camera with a real arm"
            raise InputError("--camera", "", f"{self.camera} with --robot {self.robot}", expected)
        elif self.camera != SIMULATED_CAMERA and self.camera_pose is None:
            raise InputError("--camera-pose", "", "nothing", "a file of coral contact calibrate")

    @property
    def given(self) -> bool:
        """Return whether `--world` names a robot."""
        return not has_plugin("coral.worlds", self.world) and has_plugin(GROUP, self.world)

    def robot_of(self) -> RobotKind:
        """Import the robot.

        Raises:
            InputError: Its wing is not installed.
        """
        found: RobotKind = named_plugin(GROUP, self.world, "--world")
        return found


class RobotKind(Protocol):
    """A kind of robot that attempts tasks: what an entry point of the group `coral.robots` is."""

    def robot_trial(self, trial: Trial, flags: RobotFlags) -> Trial:
        """Return the trial as it is attempted."""
        ...

    def robot_cfg(self, cfg: EpisodeCfg, flags: RobotFlags) -> EpisodeCfg:
        """Return the configuration for the robot."""
        ...

    def make_robot_world(self, trial: Trial, cfg: EpisodeCfg, flags: RobotFlags) -> RobotWorld:
        """Connect with the robot, and return its world, ready to move."""
        ...


def robot_names() -> tuple[str, ...]:
    """List the robots that `--world` may name."""
    return tuple(find_plugins(GROUP))
