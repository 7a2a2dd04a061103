"""The parts of `coral reef sail`, by the names on its command line: area, vehicle, camera, sonar."""

from __future__ import annotations

import dataclasses
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np

from coral.advisor.rules import RuleAdvisor
from coral.check_line import CheckLine, blocking
from coral.errors import InputError
from coral.flags import Argument
from coral.plugins import has_plugin, named_plugin, our_part
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.eyes.backends import PAINTED, RGB, open_eyes
from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.mission.mission import Mission
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.pictures.questions import question_pictures
from coral.reef.sea.checklist import Equipment, StampRates, preflight_list
from coral.reef.sea.frames import LocalFrame
from coral.reef.sea.latest_reading import LatestReading, LatestShot, SensorSource
from coral.reef.sea.link import VehicleLink
from coral.reef.sea.recorded_camera import read_camera
from coral.reef.sea.safety import SailCfg
from coral.reef.sea.survey_file import SurveyArea, is_survey, read_survey
from coral.reef.sea.transport import parse_address
from coral.reef.sea.udp_sonar import PORT as SONAR_PORT
from coral.reef.sea.udp_sonar import UdpSonar
from coral.reef.sea.video_camera import WIDEST_PX, VideoCamera, resized
from coral.reef.simulation.noise import PoseDrift, SensorNoise
from coral.reef.simulation.simulator import make_stills
from coral.reef.simulation.stills import make_painter
from coral.reef.vehicle.collision import clearance
from coral.reef.vehicle.sensing import HeardImage
from coral.reef.world.find_world import find_world
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import ReefWorld, load_world
from coral.reef.world.world_names import shipped_worlds

DEPTH_M = 1.0
WARM_UP_S = 6.0
LOOK_S = 2.0
"""The checks before arming watch the sensors for this long, to measure their rates."""
PATIENCE_S = 30.0
"""Longest wait for sensors that are not there yet."""
AWAITED = "vehicle", "pose", "velocity", "depth", "camera", "sonar"


def read_area(name: str) -> tuple[SurveyArea, ReefWorld | None, float]:
    """Read a survey file or a world. Return the area, the reef to simulate if there is one, and the depth (m).

    Raises:
        InputError: There is no such file or world, or it is broken.
    """
    if is_survey(Path(name)):
        area, file = read_survey(Path(name))
        world = None if file.rehearse is None else find_world(file.rehearse)
        if world is not None and tuple(world.size_m) != tuple(file.size_m):
            found = f"{file.rehearse}, {world.size_m[0]:g} x {world.size_m[1]:g} m"
            raise InputError(name, "rehearse", found, f"a world of {file.size_m[0]:g} x {file.size_m[1]:g} m")
        return area, world, file.depth_m
    world = find_world(name)
    return SurveyArea.of_world(world), world, DEPTH_M


@dataclass(frozen=True, kw_only=True)
class SailFlags:
    """The flags of the command that say what is opened."""

    area: Annotated[str, Argument(metavar="WORLD_OR_SURVEY", names=shipped_worlds)]
    """A simulated reef to rehearse in (s1, gen:3, a world file), or a survey file with a real area and its geofence."""
    vehicle: str = "simulated"
    """simulated: ours, in real time. mavlink:udp:HOST:PORT, mavlink:udpin:HOST:PORT or mavlink:tcp:HOST:PORT: ArduSub,
    real or in the loop; #ID behind it names the vehicle of that system id. ros2, ros2:NAMESPACE or
    ros2:PARAMETERS.yaml: odometry in, velocities out, with map, events and services as topics."""
    camera: str = "simulated"
    """simulated: pictures of the simulated reef from where the vehicle is. Or a file, an address (RTSP, HTTP) or a
    device for OpenCV, or ros2:TOPIC, whose pictures need `--perception`."""
    camera_latency: float = 0.0
    """Time from exposure to the picture's arrival (s), as calibrated."""
    lens: Path | None = None
    """Camera file (camera.yaml) of a real camera: size, lens and tilt. Its pictures are rectified. By default the lens
    that `camera_info` states beside ros2:TOPIC, or the configured one."""
    sonar: str = "none"
    """none; simulated: of the simulated reef. udp:PORT: a Water Linked Sonar 3D-15, whose own port is 4747
    (udp:ADDRESS:PORT with this computer's address on the sonar's network). ros2:TOPIC: a cloud of
    points."""
    truth: str = ""
    """Second address of a simulation in the loop, from which camera and judge learn where the vehicle truly is."""
    seed: int = 0
    """Seed of the controller's samples."""


@dataclass
class Parts:
    """What was opened, and how it hangs together."""

    link: VehicleLink
    area: SurveyArea
    reef: ReefWorld | None
    """The simulated reef around the vehicle; None in real water."""
    pose_source: str
    trust_heading: bool
    """Whether the vehicle's heading counts from east as the area's does: a compass, and a survey file with a start."""
    proven_simulation: bool
    """Whether the vehicle cannot be a real one."""
    truth: Callable[[], tuple[float, Pose] | None]
    """Monotonic time and true pose, in the frame of the simulation."""
    camera: LatestShot = field(init=False)
    sonar: LatestReading[HeardImage] | None = None
    frame: LocalFrame = field(default_factory=LocalFrame)
    placed: bool = False
    """Whether the survey has begun: the frame stays from then on."""

    def place(self) -> None:
        """Put the simulated reef around the vehicle, which is at the area's start until the survey begins."""
        found = None if self.placed else self.truth()
        if found is not None:
            self.frame = LocalFrame.from_start(found[1], self.area.start, trust_heading=self.trust_heading)

    def settle(self) -> None:
        """Keep the reef where it is now: the survey begins."""
        self.place()
        self.placed = True

    def where(self) -> tuple[float, Pose] | None:
        """Return a monotonic time and the true pose of the vehicle in the reef."""
        found = self.truth()
        return None if found is None else (found[0], self.frame.to_survey(found[1]))

    def true_pose(self) -> Pose | None:
        """Return the true pose of the vehicle in the reef, for the judge."""
        found = self.where()
        return None if found is None else found[1]


def open_camera(flags: SailFlags, cfg: MissionCfg, opened: ExitStack) -> tuple[MissionCfg, LatestShot | None]:
    """Open a real camera. Return the configuration with its lens, and the camera; None where it is simulated.

    The lens is that of the camera file, or of the CameraInfo beside a topic; without both, as configured.

    Raises:
        InputError: It does not open, or the file or the lens cannot be used.
    """
    if flags.camera == "simulated":
        return cfg, None
    eyes = open_eyes(cfg.perception, depth=cfg.depth)
    known = None if flags.lens is None else read_camera(flags.lens, WIDEST_PX)
    view = cfg.simulator.camera if known is None else known.view
    if flags.camera.startswith("ros2:"):
        topic, place = flags.camera.removeprefix("ros2:"), _ros_place(flags)
        source = our_part("ros2", "camera", "--camera")(topic, flags.camera_latency, view, place, known)
        view = source.view
    else:
        fit = partial(resized, camera=view) if known is None else known.picture
        source = VideoCamera(flags.camera, flags.camera_latency, fit)
    camera = LatestShot(source, eyes, view)
    opened.callback(camera.close)
    return dataclasses.replace(cfg, simulator=dataclasses.replace(cfg.simulator, camera=view)), camera


def open_parts(
    flags: SailFlags,
    area: SurveyArea,
    world: ReefWorld | None,
    cfg: MissionCfg,
    depth_m: float,
    opened: ExitStack,
    camera: LatestShot | None = None,
) -> Parts:
    """Open vehicle, simulated camera and sonar, which `opened` closes; `camera` is a real one, open already.

    Raises:
        InputError: A name is wrong, or something does not answer.
    """
    parts = _vehicle(flags, area, world, cfg, depth_m, opened)
    if camera is None:
        parts.camera = _simulated_camera(flags, _needed(world, "--camera"), cfg, parts)
        opened.callback(parts.camera.close)
    else:
        parts.camera, parts.reef = camera, None
    if flags.sonar != "none":
        parts.sonar = LatestReading(_sonar(flags, world, cfg, parts), "coral-sonar")
        opened.callback(parts.sonar.close)
    return parts


def _needed(world: ReefWorld | None, where: str) -> ReefWorld:
    if world is None:
        raise InputError(where, "", "simulated", "a world, or a survey file that says `rehearse: WORLD`")
    return world


def _simulated_camera(flags: SailFlags, world: ReefWorld, cfg: MissionCfg, parts: Parts) -> LatestShot:
    sim, scene, painter = cfg.simulator, Scene.from_world(world), None
    eyes = open_eyes(cfg.perception, depth=cfg.depth, painted=True)
    if sim.pictures or eyes is not None:
        painter = make_painter(scene, sim.camera, sim.picture_water(), sim.painter, world.seed)
    source = our_part("rehearsal", "camera", "--camera")(
        scene,
        sim.camera,
        parts.where,
        painter=painter,
        stills=make_stills(scene, sim, world.seed).make_ready() if sim.stills else None,
        noise=SensorNoise(sim.noise, np.random.default_rng([flags.seed, 5]), sim.camera),
    )
    return LatestShot(source, eyes, sim.camera)


def _vehicle(
    flags: SailFlags, area: SurveyArea, world: ReefWorld | None, cfg: MissionCfg, depth_m: float, opened: ExitStack
) -> Parts:
    if flags.vehicle == "simulated":
        return _simulated(flags, area, _needed(world, "--vehicle"), cfg, depth_m, opened)
    kind, _, rest = flags.vehicle.partition(":")
    link: VehicleLink
    if kind != "mavlink" and has_plugin("coral.vehicles", kind):
        link = named_plugin("coral.vehicles", kind, "--vehicle")(rest)
    else:
        link = our_part("coral.vehicles", "mavlink", "--vehicle")(parse_address(flags.vehicle))
    opened.callback(link.close)

    def reported() -> tuple[float, Pose] | None:
        report = link.report()  # without a second address the reef is drawn around wherever the vehicle says it is
        return None if report.pose is None else (report.pose_stamp_s, report.pose)

    return Parts(
        link=link,
        area=area,
        reef=world,
        pose_source="autopilot" if kind == "mavlink" else kind,
        trust_heading=is_survey(Path(flags.area)),
        proven_simulation=bool(flags.truth),
        truth=await_truth(flags.truth, opened) if flags.truth else reported,
    )


def _simulated(
    flags: SailFlags, area: SurveyArea, world: ReefWorld, cfg: MissionCfg, depth_m: float, opened: ExitStack
) -> Parts:
    if flags.truth:
        raise InputError("--truth", "", flags.truth, "--vehicle mavlink:...; the simulated vehicle knows its own")
    outlines = Scene.from_world(world).footprints()
    sim = cfg.simulator
    link = our_part("coral.vehicles", "simulated", "--vehicle")(
        sim.vehicle,
        area.start,
        depth_m=depth_m,
        drift=PoseDrift(sim.noise, np.random.default_rng([flags.seed, 4])),
        altitude_m=sim.camera.altitude_m,
        current=(world.current.x_m_s, world.current.y_m_s),
        contact=partial(clearance, outlines) if sim.contact == "solid" else None,
    )
    opened.callback(link.close)
    return Parts(
        link=link,
        area=area,
        reef=world,
        pose_source="simulated vehicle",
        trust_heading=False,
        proven_simulation=True,
        truth=lambda: (time.monotonic(), link.true_pose()),
    )


def _ros_place(flags: SailFlags) -> str:
    """Return the namespace or the file of ROS parameters of the vehicle; "" for one that is not of ROS 2."""
    kind, _, place = flags.vehicle.partition(":")
    return place if kind == "ros2" else ""


def await_truth(address: str, opened: ExitStack, timeout_s: float = 10.0) -> Callable[[], tuple[float, Pose] | None]:
    """Wait for the state of a simulation at an address: only a simulation tells one. Return what tells the newest.

    Raises:
        InputError: None is told.
    """
    truth = our_part("rehearsal", "truth", "--truth")(parse_address(address))
    opened.callback(truth.close)
    end = time.monotonic() + timeout_s
    while truth.latest is None:
        if time.monotonic() > end:
            raise InputError("--truth", "", "no SIM_STATE", "the second address of a simulation in the loop")
        time.sleep(0.05)
    return lambda: truth.latest  # type: ignore[no-any-return]


def _sonar(flags: SailFlags, world: ReefWorld | None, cfg: MissionCfg, parts: Parts) -> SensorSource[HeardImage]:
    kind, _, place = flags.sonar.partition(":")
    if flags.sonar == "simulated":
        world = _needed(world, "--sonar")
        surface_z = None if world.water_depth_m is None else world.seabed.z_m + world.water_depth_m
        rng = np.random.default_rng([flags.seed, 3])
        sonar = Sonar3d15(Scene.from_world(world).resting, cfg.simulator.sonar, rng, surface_z=surface_z)
        simulated: SensorSource[HeardImage] = our_part("rehearsal", "sonar", "--sonar")(
            sonar, parts.where, cfg.simulator.camera.altitude_m
        )
        return simulated
    if kind == "ros2":
        ranges: SensorSource[HeardImage] = our_part("ros2", "sonar", "--sonar")(
            place, cfg.simulator.sonar, _ros_place(flags)
        )
        return ranges
    interface, _, port = place.rpartition(":")
    if kind != "udp" or (port and not (port.isdigit() and int(port) < 65536)):
        expected = "udp, udp:PORT or udp:ADDRESS:PORT of this computer, ros2:TOPIC, simulated or none"
        raise InputError("--sonar", "", repr(flags.sonar), expected)
    return UdpSonar(int(port) if port else SONAR_PORT, interface or "0.0.0.0")


def watch_sensors(parts: Parts, cfg: SailCfg, equipment: Equipment) -> list[CheckLine]:
    """Watch the sensors for a while and make the preflight list; wait for those that are not there yet."""
    rates, began = StampRates(), time.monotonic()

    def measured() -> bool:
        known = (rates.rate_hz("pose"), parts.camera.rate_hz, 0.0 if parts.sonar is None else parts.sonar.rate_hz)
        return None not in known

    while True:
        looked = time.monotonic()
        while (spent := time.monotonic() - looked) < LOOK_S or (spent < 3.0 * LOOK_S and not measured()):
            rates.note(time.monotonic(), parts.link.report())
            parts.place()
            time.sleep(0.02)
        now, report = time.monotonic(), parts.link.report()
        lines = preflight_list(now, report, rates, parts.camera, parts.area, cfg, equipment, parts.sonar)
        waits = [line for line in blocking(lines) if line.subject in AWAITED]
        if not waits or now - began > PATIENCE_S:
            return lines


def warm_up(cfg: MissionCfg) -> None:
    """Run a few simulated seconds, so that nothing has to be compiled or imported under way."""
    record = RecordCfg(pictures=cfg.record.pictures, frames=cfg.record.frames, report=False)
    eyes = PAINTED if cfg.perception == RGB else cfg.perception  # what is simulated is painted
    brief = dataclasses.replace(cfg, time_limit_s=WARM_UP_S, latency="fixed:0.5", record=record, perception=eyes)
    with tempfile.TemporaryDirectory() as folder:
        rules = RuleAdvisor(REEF_RULES)
        Mission(load_world("s1"), brief, rules, Path(folder) / "warm-up", draw=question_pictures).run()
