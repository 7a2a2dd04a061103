"""A survey through MAVLink against the simulated autopilot, in the autopilot's own time: no clock, no thread."""

import numpy as np
from voyage import WORLD

from autopilot.autopilot import AutopilotCfg, SimulatedAutopilot
from autopilot.body import Body, ReefWaters
from autopilot.line import AutopilotLine
from coral.advisor.clock import SimulatedClock
from coral.advisor.rules import RuleAdvisor
from coral.reef.decide.heuristic import REEF_RULES
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.record import RecordCfg
from coral.reef.sea import ardusub
from coral.reef.sea.latest_reading import Shot
from coral.reef.sea.mavlink_link import MavlinkLink
from coral.reef.sea.safety import SafetyCfg, SailCfg
from coral.reef.sea.sea_mission import Crew, SeaMission
from coral.reef.sea.survey_file import SurveyArea
from coral.reef.vehicle.camera import Camera
from coral.reef.world.scene import Scene


class TrueCamera:
    """A picture from where the autopilot's body truly is, whenever one is asked for."""

    name, rate_hz, failure, eyes = "true", 10.0, "", None

    def __init__(self, voyage, cfg):
        self.voyage, self.camera, self.source = voyage, Camera(Scene.from_world(WORLD), cfg), self

    @property
    def latest(self):
        return Shot(stamp_s=self.voyage.line.clock(), frame=self.camera.render(self.voyage.autopilot.body.pose))


class MavlinkVoyage:
    def __init__(self, folder, *, time_limit_s=7.0, **safety):
        self.waters = ReefWaters("s1")
        self.autopilot = SimulatedAutopilot(Body(self.waters), AutopilotCfg(position_after_s=1.0))
        self.line = AutopilotLine(self.autopilot)
        cfg = MissionCfg(time_limit_s=time_limit_s, record=RecordCfg(pictures=False))
        area = SurveyArea.of_world(WORLD)
        self.link = MavlinkLink(self.line, self.line.clock, threaded=False)
        self.sleep(3.0)
        camera = TrueCamera(self, cfg.simulator.camera)
        crew = Crew(link=self.link, camera=camera, advisor=RuleAdvisor(REEF_RULES))
        self.words, self.at, self.states, self.until_s = crew.words, {}, [], time_limit_s
        self.mission = SeaMission(
            area,
            SailCfg(mission=cfg, safety=SafetyCfg(**{"reserve_s": 0.0, "on_time": "none", **safety})),
            crew,
            folder,
            clock=self.line.clock,
            sleep=self.sleep,
            decision_clock=SimulatedClock("fixed:1", np.random.default_rng(0)),
            threaded=False,
        )
        self.mission.align(trust_heading=False)
        self.link.arm()

    def sleep(self, seconds):
        until = self.line.clock() + seconds
        while self.line.clock() < until - 1e-9:
            self.link.poll()

    def parameter(self, name, value):
        self.autopilot.parameters.write(name, value)

    def station(self, message):
        """Speak as another station on the same line."""
        self.autopilot.receive(message.pack(ardusub.load_dialect().MAVLink(None, 255, 190)), "other")

    def tick(self, mission):
        self.states.append((mission.t, mission.states.state.value))
        mission.record.work.drain()
        act = self.at.pop(mission.step, None)
        if act is not None:
            act()
        if mission.t > self.until_s:  # a survey that a person has taken over does not end by itself
            self.words.say("stop", "test")

    def stop_requested(self):
        return ""

    def run(self):
        """Return the metrics, and the events as dictionaries."""
        self.events = []
        self.mission.record.listeners.append(self.events.append)
        return self.mission.run([self])

    def first(self, state, after_s):
        """Return how long after a time a state was reached; None if it never was."""
        return next((t - after_s for t, name in self.states if name == state and t >= after_s), None)
