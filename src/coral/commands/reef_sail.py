"""`coral reef sail`: a survey in real time, with a simulated vehicle or a real one."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from coral.advisor.attribution import who_decided
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.preflight import preflight
from coral.advisor.registry import advisor_help, asks_person
from coral.check_line import blocking
from coral.commands.around_run import list_made, mission_notice, render
from coral.commands.config_flag import configured
from coral.commands.keyboard import HELP, Keyboard, conduct
from coral.commands.reef_run import fulfilled
from coral.commands.sail_parts import Parts, SailFlags, open_camera, open_parts, read_area, warm_up, watch_sensors
from coral.commands.sail_told import lens_told, survey_told
from coral.config import Positive, checked, merge, read_config
from coral.errors import InputError, RunError
from coral.exit_code import ExitCode
from coral.file_writer import write_whole
from coral.flags import Option
from coral.plugins import our_part
from coral.reef.map.landmark_map import LandmarkMap
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.resolution import reef_advisor, with_deadline, with_sonar
from coral.reef.mission.word_judge import instructed, with_instruction
from coral.reef.pictures.questions import question_pictures
from coral.reef.sea.checklist import Equipment
from coral.reef.sea.operator import OperatorWords
from coral.reef.sea.safety import SafetyCfg, SailCfg
from coral.reef.sea.saved_survey import load_survey
from coral.reef.sea.sea_mission import Crew, SeaMission
from coral.reef.vehicle.response import VehicleResponse
from coral.run_files import SurveyFiles
from coral.runs import new_run_folder
from coral.terminal import tell
from coral.words import many

ARM_S = 20.0


@dataclass(frozen=True, kw_only=True)
class ReefSail(SailFlags):
    """Survey a reef in real time: rehearse with a simulated vehicle, or drive a BlueROV2."""

    perception: Annotated[str | None, Option(metavar="exact|rgb|painted|FILE.onnx")] = None
    """Where classes and depth come from, as for `coral reef run`: exact (the simulated camera alone has them), or
    from colour pictures, by the network of CORAL for real (rgb) or for painted ones (painted), or by one of yours."""
    advisor: Annotated[str, Option(help=advisor_help("Who decides"))] = "heuristic"
    instruction: Annotated[str | None, Option(metavar="TEXT")] = None
    """What to do, in plain words, in place of a survey of everything; nobody judges it. A simulated reef may have words
    of its own (words:FAMILY:N), which are judged."""
    depth: Positive | None = None
    """Depth to hold (m), below the surface; by default the survey file's, or 1 m."""
    start: tuple[float, float, float] | None = None
    """Where the vehicle is when it begins: x, y (m) and heading (rad) in the area; by default the file's start."""
    response: Path | None = None
    """File with the keys of how this vehicle follows its set-points (`surge_lag_s` and so on); by default like the
    simulated one."""
    resume: Path | None = None
    """Run folder of an earlier survey of the same area, to continue with its map. The vehicle must be about where
    `--start` says, by default at the area's start again: it finds its place by the obstacles that it sees again."""
    yes: bool = False
    """Arm without asking. For rehearsals only: refused unless the vehicle is a simulation that proves to be one."""
    check: bool = False
    """Print the checks before arming, and end without arming."""
    preflight: bool = True
    """Ask a model one small question first."""
    out: Path | None = None
    """Run folder, new or empty; by default the next free runs/AREA-sail-NNN."""
    config: Path | None = None
    """YAML file with configuration values of the mission; flags override it."""
    inbox: Path | None = None
    """Folder for the questions of `--advisor desk`; by default inbox/ in the run folder."""
    json: bool = False
    """Print one JSON object on standard output; everything else goes to standard error."""
    quiet: bool = False
    """No list of checks and no progress on the terminal."""
    live: bool = False
    """Show the survey in a browser, with the operator's buttons; the address goes to standard error."""
    live_port: int = 0
    """Port of the page; 0 chooses a free one."""
    model: ModelCfg = field(default_factory=ModelCfg)
    """Calls of a real model, and the spending limit of the run."""
    safety: SafetyCfg = field(default_factory=SafetyCfg)
    """Limits, and what happens when one is reached."""
    cfg: MissionCfg = field(default_factory=MissionCfg)
    """The mission."""

    @classmethod
    def from_file(cls, words: Sequence[str]) -> ReefSail | None:
        cfg = configured(words, MissionCfg())
        return None if cfg is None else cls(area="", cfg=cfg)

    def __call__(self) -> Mapping[str, Any]:
        """Check, arm on the operator's word, survey."""
        with ExitStack() as opened:
            return self._sail(opened)

    def _sail(self, opened: ExitStack) -> Mapping[str, Any]:
        cfg = self._config()
        area, world, file_depth = read_area(self.area)
        text = None if world is None else world.mission
        cfg = instructed(cfg, text) if self.instruction is None else with_instruction(cfg, self.instruction, text)
        if self.start is not None:
            area = area.begun_at(self.start, "--start")
        depth = self.depth or file_depth
        response = None if self.response is None else read_config(self.response, VehicleResponse())
        cfg, camera = open_camera(self, cfg, opened)
        belief, landmarks, sim = None, LandmarkMap(), cfg.simulator
        if self.resume is not None:
            belief, landmarks = load_survey(self.resume, area.size_m, sim.camera, cfg.map, cfg.belief, sim.sonar)
        parts = open_parts(self, area, world, cfg, depth, opened, camera)
        for told in parts.camera.eyes.about if parts.camera.eyes else ():
            self._say(told)
        if self.yes and not parts.proven_simulation:
            found = f"{self.vehicle}, which may be a real vehicle"
            raise InputError("--yes", "", found, "--vehicle simulated, or --truth of a simulation")
        folder = self.out or new_run_folder(Path("runs"), f"{area.name}-sail")
        advisor = self._advisor(folder, cfg)
        if not self.check:
            warm_up(cfg)
        words = OperatorWords()
        crew = Crew(
            link=parts.link,
            camera=parts.camera,
            sonar=parts.sonar,
            advisor=advisor,
            words=words,
            world=parts.reef,
            true_pose=parts.true_pose,
            draw=question_pictures if cfg.record.pictures else None,
        )
        equipment = Equipment(
            vehicle=self.vehicle,
            pose_source=parts.pose_source,
            advisor=advisor.name,
            folder=str(folder),
            judged=parts.reef is not None
            and text is not None
            and text.instruction.strip() == cfg.planner.instruction.text,
            heading_trusted=parts.trust_heading,
            resumed="" if self.resume is None else f"{self.resume}, {many(len(landmarks.centres), 'landmark')}",
        )
        sail = SailCfg(mission=cfg, safety=self.safety, depth_m=depth, response=response)
        lines = watch_sensors(parts, sail, equipment)
        for line in lines:
            self._say(str(line))
        wrong = blocking(lines)
        if self.check:
            return {"ready": not wrong, "preflight": [str(line).strip() for line in lines]}
        if wrong:
            raise RunError(f"will not arm: {'; '.join(f'{line.subject}: {line.text}' for line in wrong)}")
        about = {"vehicle": self.vehicle, "camera": self.camera, "sonar": self.sonar}
        about |= {"resumed": str(self.resume)} if self.resume is not None else {}
        mission = SeaMission(area, sail, crew, folder, belief=belief, landmarks=landmarks, seed=self.seed, about=about)
        write_whole(folder / SurveyFiles.PREFLIGHT, "".join(f"{line}\n" for line in lines).encode())
        inbox = self.inbox or folder / SurveyFiles.INBOX
        asked = asks_person(self.advisor)
        noticed = mission_notice(
            asked,
            inbox,
            mission.instructing,
            world=area.name,
            advisor=advisor.name,
            seed=self.seed,
            run=str(folder),
            instruction=mission.instruction,
        )
        with (
            noticed as notice,
            ExitStack() as shown,
            survey_told(mission, self._say, None if notice is None else notice.hear),
        ):
            observers = [*self._observers(mission, shown)]
            for observer in observers:
                observer.waiting(tuple(str(line) for line in lines))
            self._arm(mission, parts, words)
            if self.camera != "simulated":
                shown.enter_context(lens_told(folder, self._say, our_part("lens", "check", "--camera")))
            result = conduct(mission, observers, words)
            if notice is not None:
                notice.finished(f"{result['clusters_covered']} clusters covered; {result['end_reason']}")
        decided = who_decided(result, things="goals", fallback=cfg.pilot.fallback)
        lens = "" if self.camera == "simulated" else our_part("lens", "check", "--camera")(folder)
        made = render(folder, report=cfg.record.report, video=cfg.record.video)
        return {**result, "decided": decided, "lens": lens, "run": str(folder), **made}

    def _config(self) -> MissionCfg:
        if self.seed < 0:
            raise InputError("--seed", "", self.seed, "a number of 0 or more")
        if not 0.0 <= self.camera_latency <= 1.0:
            raise InputError("--camera-latency", "", self.camera_latency, "0 to 1 s")
        checked(self.safety, "--safety")
        cfg = checked(self.cfg, "--cfg")
        # Pictures that are so late by nature may be that much older.
        guard = {"frame_timeout_s": cfg.pilot.guard.frame_timeout_s + self.camera_latency}
        cfg = merge(with_sonar(cfg, self.sonar != "none"), {"pilot": {"guard": guard}}, "--cfg")
        cfg = dataclasses.replace(cfg, perception=self.perception or cfg.perception)
        if self.lens is not None and self.camera == "simulated":
            expected = "a real camera (--cfg.simulator.camera is the simulated)"
            raise InputError("--lens", "", "--camera simulated", expected)
        if cfg.decider in ("clairvoyant", "sweep", "oracle"):
            found = f"{cfg.decider}, which only a simulation has"
            raise InputError("--cfg.decider", "", found, "advisor, nearest, frontier, constant, lawnmower or random")
        if self.safety.on_time != "none" and cfg.time_limit_s <= self.safety.reserve_s:
            kept = f"more than the {self.safety.reserve_s:g} s kept back for the way home (--safety.reserve-s)"
            raise InputError("--cfg.time-limit-s", "", f"{cfg.time_limit_s:g} s", kept)
        return with_deadline(cfg, asks_person(self.advisor))

    def _advisor(self, folder: Path, cfg: MissionCfg) -> Any:
        inbox = self.inbox or folder / SurveyFiles.INBOX
        advisor = reef_advisor(self.advisor, self.seed, inbox=inbox, model=self.model)
        if self.preflight and not self.check:
            preflight(advisor, pictures=cfg.record.pictures, quiet=self.quiet)
        if asks_person(self.advisor):
            self._say(f"to answer its questions in a browser: coral desk {inbox}")
        return advisor

    def _say(self, text: str) -> None:
        if not self.quiet:
            tell(text)

    def _arm(self, mission: SeaMission, parts: Parts, words: OperatorWords) -> None:
        """Wait for the operator's word, then arm.

        Raises:
            RunError: The operator gave up, or the vehicle refused.
        """
        if not self.yes:
            self._say("nothing moves until you type arm and press Enter, or press the button on the page")
            if not Keyboard(words).wait_for_arm():
                mission.record.close()
                raise RunError("not armed: the operator did not say so")
        mission.align(trust_heading=parts.trust_heading)
        parts.settle()
        mission.orders.give("arm")
        mission.orders.wait(ARM_S, time.sleep)
        refusals = [result.refusal for result in mission.orders.results() if result.refusal]
        if refusals or not mission.crew.link.report().armed:
            mission.record.close()
            raise RunError(f"the vehicle did not arm: {'; '.join(refusals) or 'no answer'}")
        self._say(f"armed. {HELP}")

    def _observers(self, mission: SeaMission, opened: ExitStack) -> Iterator[Any]:
        """Open what shows the survey elsewhere, as topics and on a page."""
        kind, _, place = self.vehicle.partition(":")
        if kind == "ros2":
            topics = our_part("ros2", "topics", "--vehicle")(place, mission.crew.words, mission.instructing)
            opened.callback(topics.close)
            yield topics
        if self.live:
            from coral.view.live.controls import SurveyControls
            from coral.view.live.viewer import Viewer
            from coral.view.live.watching import WatchedSurvey, reef_sketch

            controls, folder = SurveyControls(mission.crew.words, mission.instructing), mission.record.folder
            viewer = opened.enter_context(Viewer(folder, controls, port=self.live_port, flag="--live-port"))
            self._say(f"watch and steer the survey at {viewer.url}")
            opened.callback(lambda: viewer.stay() if viewer.watched else None)
            yield WatchedSurvey(viewer, None, reef_sketch, real_time=True)

    def describe(self, result: Mapping[str, Any]) -> str:
        if self.check:
            return "ready to arm" if result["ready"] else "not ready to arm"
        share = (
            f"{result['clusters_covered']} of {result['clusters_total']} oyster clusters covered "
            f"({100 * result['coverage']:.0f} %, by {result['judged_by']}), "
        )
        lines = [
            f"{self.area}: {share if result['clusters_total'] or 'success' not in result else ''}"
            f"{'' if result['collisions'] is None else many(result['collisions'], 'collision') + ', '}"
            f"{result['sim_time_s']:.0f} s in real time, {result['late_ticks']} of {result['ticks']} ticks late; "
            f"ended: {result['end_reason']}",
            f"run folder: {result['run']}",
        ]
        lines += fulfilled(result)
        lines += [result["lens"]] if result.get("lens") else []
        lines += [f"recording stopped: {result['recording_failure']}"] if result["recording_failure"] else []
        return "\n".join([*lines, *list_made(result)])

    def exit_code(self, result: Mapping[str, Any]) -> int:
        """Return a failure for a check that found the vehicle not ready."""
        return ExitCode.FAILED if self.check and not result["ready"] else ExitCode.DONE
