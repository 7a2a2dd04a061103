"""The flags of `coral contact run` that concern a robot, and what answers to them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Protocol

from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.scene.trial import Trial
from coral.contact.worlds.robot_world import RobotWorld
from coral.errors import InputError
from coral.flags import Option
from coral.plugins import find_plugins, has_plugin, named_plugin

GROUP = "coral.robots"
SIMULATED, SIMULATED_CAMERA = "sim", "sim"


@dataclass(frozen=True, kw_only=True)
class RobotFlags:
    """The flags of the command that concern the world, or an arm in its place."""

    world: str = "panda"
    """World: panda, the robot in robosuite; hand, its hand alone, free-flying; franka, the arm of --robot."""
    robot: Annotated[str | None, Option(metavar="ADDRESS|sim")] = None
    """The arm of --world franka: its address; or sim, a simulated arm that speaks the arm's own protocol."""
    dry_run: bool = False
    """Read the arm and show its commands without sending them."""
    yes: bool = False
    """Move the simulated arm without asking; a real arm always asks."""
    camera: str | None = None
    """Track the objects of --world franka by a camera: sim, for the simulated arm, or one that `coral contact poses`
    takes."""
    camera_pose: Path | None = None
    """File that says where that camera stands."""
    masks: str | None = None
    """What segments its pictures, as `coral contact poses` takes it; colour by default."""

    def check(self) -> bool:
        """Return whether an arm is asked for.

        Raises:
            InputError: The flags contradict each other.
        """
        if not self.given:
            for name in ("robot", "dry_run", "yes", "camera", "camera_pose", "masks"):
                self._refuse(name, f"--world {' or '.join(robot_names())}")
            return False
        if not self.robot:
            raise InputError("--robot", "", "nothing", f"the arm's address, or {SIMULATED!r} for the simulated arm")
        if self.yes and self.robot != SIMULATED and not self.dry_run:
            expected = f"--robot {SIMULATED}: a real arm moves only when a person confirms"
            raise InputError("--yes", "", f"--robot {self.robot}", expected)
        self._check_camera()
        return True

    def _refuse(self, name: str, only: str) -> None:
        """Refuse a flag that is given, because it goes with something else only."""
        if value := getattr(self, name):
            raise InputError(f"--{name.replace('_', '-')}", "", value, f"it goes with {only} only")

    def _check_camera(self) -> None:
        if self.camera is None:
            self._refuse("camera_pose", "--camera")
            self._refuse("masks", "--camera")
        elif (self.camera == SIMULATED_CAMERA) != (self.robot == SIMULATED):
            expected = f"--camera {SIMULATED_CAMERA} with --robot {SIMULATED}, a real camera with a real arm"
            raise InputError("--camera", "", f"{self.camera} with --robot {self.robot}", expected)
        elif self.camera != SIMULATED_CAMERA and self.camera_pose is None:
            raise InputError("--camera-pose", "", "nothing", "a file that says where the camera stands")

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

    def robot_cfg(self, cfg: EpisodeCfg, flags: RobotFlags) -> EpisodeCfg:
        """Return the configuration for the robot."""

    def make_robot_world(self, trial: Trial, cfg: EpisodeCfg, flags: RobotFlags, quiet: bool = False) -> RobotWorld:
        """Connect with the robot, and return its world, ready to move; `quiet` shows no commands of a dry run."""


def robot_names() -> tuple[str, ...]:
    """List the robots that `--world` may name."""
    return tuple(find_plugins(GROUP))
