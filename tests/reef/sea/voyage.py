"""A survey in a simulated reef on a fake clock: nothing sleeps, and the same seed gives the same voyage."""

import dataclasses
import re
import socket
from contextlib import nullcontext
from unittest import mock

import numpy as np

from coral.advisor.clock import SimulatedClock
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.map.sonar_3d15 import Sonar3d15
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.mission.resolution import with_sonar
from coral.reef.rehearsal.simulated_link import SimulatedLink
from coral.reef.sea.latest_reading import LatestReading, Shot
from coral.reef.sea.safety import SafetyCfg, SailCfg
from coral.reef.sea.sea_mission import Crew, SeaMission
from coral.reef.sea.sonar_packets import encode_packet
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.sea.udp_sonar import UdpSonar
from coral.reef.vehicle.camera import Camera
from coral.reef.vehicle.sensing import Stamped
from coral.reef.world.geometry import Pose
from coral.reef.world.scene import Scene
from coral.reef.world.world import load_world
from reference import texts

WORLD = load_world("s1")


class FakeClock:
    def __init__(self):
        self.now = 1000.0

    def __call__(self):
        return self.now

    def sleep(self, seconds):
        self.now += max(seconds, 0.0)


class FakeCamera:
    """Takes a picture whenever it is asked for one, unless it is blind."""

    name = "fake"
    rate_hz, failure, eyes, late_s = 10.0, "", None, 0.0

    def __init__(self, link, clock, cfg, world=WORLD):
        self.link, self.clock, self.blind, self.last = link, clock, False, None
        self.camera = Camera(Scene.from_world(world), cfg)
        self.source = self

    @property
    def latest(self):
        if not self.blind:
            pose = self.link.true_pose()
            self.last = Shot(stamp_s=self.clock.now - self.late_s, frame=self.camera.render(pose))
        return self.last


class SentSonar:
    """Takes range images at the sonar's rate, sends each as a packet through UDP, and reads it back."""

    def __init__(self, link, clock, cfg):
        self.link, self.clock, self.deaf = link, clock, False
        self.sonar = Sonar3d15(Scene.from_world(WORLD), cfg, np.random.default_rng(3))
        self.reader = LatestReading(UdpSonar(0, clock=clock), "sonar", clock=clock, threaded=False)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sent, self.due_s = 0, clock.now
        self.last_image = None

    @property
    def latest(self):
        if not self.deaf and self.clock.now >= self.due_s - 1e-6:
            self.due_s = self.clock.now + 0.2
            self.sent += 1
            self.last_image = self.sonar.image(self.link.true_pose(), 1.0)
            packet = encode_packet(Stamped(self.clock.now, self.last_image))
            self.socket.sendto(packet, ("127.0.0.1", self.reader.source.port))
            self.reader.step()
        return self.reader.latest

    def close(self):
        self.socket.close()
        self.reader.close()


class Voyage:
    def __init__(
        self,
        folder,
        *,
        known=True,
        area=None,
        time_limit_s=20.0,
        sonar=False,
        belief=None,
        landmarks=None,
        off=(0.0, 0.0, 0.0),
        cfg=None,
        drift=None,
        world=WORLD,
        rules=REEF_RULES,
        **safety,
    ):
        self.clock = FakeClock()
        record = RecordCfg(pictures=False)
        mission = with_sonar(dataclasses.replace(cfg or MissionCfg(), time_limit_s=time_limit_s, record=record), sonar)
        sim = mission.simulator
        small = dataclasses.replace(sim.sonar, width=96, height=32)
        mission = dataclasses.replace(mission, simulator=dataclasses.replace(sim, sonar=small))
        self.area = area or SurveyArea.of_world(world)
        begins = Pose(*(said + error for said, error in zip(self.area.start, off, strict=True)))
        self.link = SimulatedLink(mission.simulator.vehicle, begins, drift=drift, clock=self.clock)
        self.camera = FakeCamera(self.link, self.clock, mission.simulator.camera, world)
        self.sonar = SentSonar(self.link, self.clock, small) if sonar else None
        crew = Crew(
            link=self.link,
            camera=self.camera,
            sonar=self.sonar,
            advisor=RuleAdvisor(rules),
            world=world if known else None,
            true_pose=self.link.true_pose if known else lambda: None,
        )
        self.words = crew.words
        self.mission = SeaMission(
            self.area,
            SailCfg(mission=mission, safety=SafetyCfg(**{"reserve_s": 0.0, "on_time": "none", **safety})),
            crew,
            folder,
            clock=self.clock,
            sleep=self.clock.sleep,
            decision_clock=SimulatedClock("fixed:1", np.random.default_rng(0)),
            threaded=False,
            belief=belief,
            landmarks=landmarks,
        )
        self.mission.align(trust_heading=False)
        self.at = {}
        self.states = []
        self.link.arm()

    def on(self, step, action):
        """Do something just after a tick."""
        self.at[step] = action
        return self

    def tick(self, mission):
        self.states.append(mission.states.state.value)
        mission.record.work.drain()
        if mission.step in self.at:
            self.at[mission.step]()

    def stop_requested(self):
        return ""

    def run(self):
        with mock.patch("coral.reef.sea.sea_mission.little_garbage", nullcontext):  # the tests' own takes long
            result = self.mission.run([self])
        assert re.split(r": | \(", result["end_reason"])[0] in {*texts.SURVEY_ENDS, "killed"}
        return result
