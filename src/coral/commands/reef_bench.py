"""`coral reef bench`: compare variants over many missions, and make the paper's tables from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

from coral.advisor.fallback import FOR_BENCHES, Fallback
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor
from coral.advisor.registry import advisor_help, asks_person, rules_alone
from coral.campaign.dataset import Row
from coral.campaign.episode import code_version, digest
from coral.campaign.reef_tables import BASELINES, TABLE_I, TABLE_II, reef_tables, word_tables
from coral.campaign.spec import NO_ADVISOR, Spec, grid, parse_names, parse_seeds
from coral.campaign.sweep import PRESET, parse_sweeps, with_presets
from coral.campaign.table import Table
from coral.commands.campaigns import CampaignCommand
from coral.commands.config_flag import configured, given_keys, set_keys
from coral.config import checked, merge, to_mapping
from coral.errors import InputError
from coral.flags import Option
from coral.reef.drive.controllers import controller_maker
from coral.reef.generator.word_missions import half_of
from coral.reef.mission.campaign_episode import run_episode
from coral.reef.mission.mission_cfg import MissionCfg
from coral.reef.mission.presets import CLEAR, apply_preset, apply_setting, named, preset_help
from coral.reef.mission.resolution import reef_advisor
from coral.reef.mission.variants import apply_variant
from coral.reef.pictures.questions import question_pictures
from coral.reef.world.find_world import expand_names, find_world
from coral.reef.world.world import ReefWorld


@dataclass(frozen=True)
class ReefEpisode:
    """Runs the mission of a spec. It contains the worlds, so that a worker needs none of the caller's files."""

    cfg: MissionCfg
    model: ModelCfg
    worlds: Mapping[str, ReefWorld]
    keep: frozenset[str] = frozenset()
    """Keys of the configuration that win over a preset."""
    inbox: Path | None = None
    """Where the desk asks."""

    def __call__(self, spec: Spec, folder: Path) -> dict[str, Any]:
        cfg, world = mission_of(spec, self.cfg, self.worlds[spec.world], self.keep)
        advisor = "heuristic" if spec.advisor == NO_ADVISOR else spec.advisor
        sees = not rules_alone(advisor)
        return run_episode(
            world,
            cfg,
            folder,
            variant=spec.variant,
            preset=preset_of(spec),
            advisor=advisor,
            seed=spec.seed,
            model=self.model,
            inbox=self.inbox,
            draw=question_pictures if sees else None,
        )


def mission_alone() -> MissionCfg:
    """Return the default mission of a campaign: no fallback decides for the advisor, and full coverage ends it."""
    return merge(MissionCfg(), {"stop_when_covered": True, "pilot": {"fallback": FOR_BENCHES}}, "--cfg")


@dataclass(frozen=True, kw_only=True)
class ReefBench(CampaignCommand):
    """Compare variants of the reef survey over worlds, seeds and advisors.

    The same command continues a stopped campaign; a larger grid in the same folder extends it.
    """

    name, noun, title = "reef bench", "mission", "Reef survey"

    variants: str = "dream,pd,full,blind-sweep,random,oracle"
    """Variants, separated by commas."""
    worlds: str = "all"
    """Shipped reefs, generated ones or world files, separated by commas; all: the ten shipped ones; generated: the
    forty generated ones; gen:0-9: ten of them."""
    seeds: str = "0"
    """Numbers and ranges, such as 0-4 or 0,3,7-9."""
    advisors: Annotated[str, Option(help=advisor_help("Separated by commas"))] = "heuristic"
    inbox: Path | None = None
    """With --advisors desk: folder in which the questions of one mission after the other wait for a reader outside."""
    presets: Annotated[str, Option(help=preset_help("Water and sensors, separated by commas"))] = CLEAR
    study: Annotated[tuple[str, ...] | None, Option(metavar="[words]")] = None
    """The study: all variants of Tables I and II and the references, with the rules and two sloppy advisors, in three
    waters with three seeds, each mission to its own end or to 757 s. words: missions in words, both halves, in three
    waters. Flags change these defaults."""
    sweep: Annotated[tuple[str, ...], Option(repeated=True)] = ()
    """KEY=V1,V2,...: repeat the whole grid for each value. KEY: current, the water's speed (m/s), or a key of
    the configuration. If given several times, each key is swept separately."""
    fallback: Fallback | None = None
    """Fallback when an advisor does not decide: hold (the default: nothing else decides), fail (the mission ends),
    or rules, whose rows are marked."""
    out: Path = Path("runs/bench")
    config: Path | None = None
    """YAML file with configuration values; flags override it."""
    model: ModelCfg = field(default_factory=ModelCfg)
    """Calls of a real model, and the spending limit of each mission."""
    cfg: MissionCfg = field(default_factory=mission_alone)
    """The mission."""
    given: Annotated[tuple[str, ...], Option(hidden=True)] = ()
    """Keys of the mission that flags or the file set: they win over a preset."""

    @classmethod
    def from_file(cls, words: Sequence[str]) -> ReefBench:
        cfg, given = configured(words, mission_alone()) or mission_alone(), given_keys(words)
        study: Mapping[str, Any] = {}
        if "--study" in words:
            study = STUDY_IN_WORDS if list(words[words.index("--study") + 1 :][:1]) == ["words"] else STUDY
            cfg = cfg if "stop_when_covered" in given else replace(cfg, stop_when_covered=False)
            cfg = cfg if "time_limit_s" in given or study is STUDY_IN_WORDS else replace(cfg, time_limit_s=DREAM_S)
        return cls(**study, cfg=cfg, given=given, typed=tuple(words))

    def __call__(self) -> Mapping[str, Any]:
        """Run the missing missions, then make the tables."""
        if self.fallback is not None:
            cfg = merge(self.cfg, {"pilot": {"fallback": self.fallback}}, "--fallback")
            return replace(self, cfg=cfg, fallback=None)()
        if self.study not in (None, (), ("words",)):
            raise InputError("--study", "", " ".join(self.study or ()), "words, or nothing")
        if self.collect:
            return self._collect_recorded()
        names = expand_names(parse_names(self.worlds, "--worlds"))
        worlds = {name: find_world(name) for name in names}
        specs = self._specs(worlds)
        episode = ReefEpisode(self.cfg, self.model, worlds, self._keep, self.inbox)
        return self._run(specs, episode, self._conditions(worlds))

    def _first_tables(self) -> Sequence[str]:
        return SHOWN if len(parse_names(self.variants, "--variants")) > 1 else SHOWN_OF_ONE

    @property
    def _keep(self) -> frozenset[str]:
        return set_keys(self.cfg, mission_alone(), self.given)

    @property
    def _presets(self) -> tuple[str, ...]:
        names = parse_names(self.presets, "--presets")
        for name in names:
            named(name)
        return tuple(names)

    def _advisor(self, name: str) -> Advisor:
        return reef_advisor(name, inbox=self.inbox, model=self.model, where="--advisors")

    def _check_desk(self, advisor: str) -> None:
        """Check that a reader outside can answer, and that the results will not depend on his clock."""
        if self.inbox is None:
            raise InputError("--advisors", "", repr(advisor), "advisors that answer by themselves, or --inbox DIR")
        if self.cfg.latency in ("auto", "measured"):
            raise InputError("--cfg.latency", "", self.cfg.latency, "the same for every answer at the desk: fixed:10")
        if self.jobs != 1 or self.executor != "local":
            raise InputError("--jobs", "", self.jobs, "1 with --inbox: one mission asks after the other")

    def _specs(self, worlds: Mapping[str, ReefWorld]) -> tuple[Spec, ...]:
        variants = parse_names(self.variants, "--variants")
        alone = {variant for variant in variants if apply_variant(variant, self.cfg).decider != "advisor"}
        advisors = parse_names(self.advisors, "--advisors")
        for advisor in advisors:
            if asks_person(advisor):
                self._check_desk(advisor)
            self._advisor(advisor)
        specs = grid(
            "reef",
            variants=variants,
            worlds=tuple(worlds),
            seeds=parse_seeds(self.seeds),
            advisors=advisors,
            alone=alone,
            overrides=with_presets(self._presets, parse_sweeps(self.sweep)),
        )
        for spec in {(spec.variant, spec.overrides): spec for spec in specs}.values():
            mission_of(spec, self.cfg, worlds[spec.world], self._keep)  # reject a bad value here, not in every worker
        return specs

    def _conditions(self, worlds: Mapping[str, ReefWorld]) -> dict[str, str]:
        """Compute digests of all conditions that must be equal for every mission of a table."""
        cfg = {"mission": to_mapping(self.cfg), "model": to_mapping(self.model)}
        cfg["mission"].pop("record")
        return {
            "code version": code_version(),
            "configuration": digest(cfg),
            **{
                f"preset {name}": digest({key: v for key, v in named(name).values.items() if key not in self._keep})
                for name in self._presets
            },
            **{f"world {name}": digest(world.model_dump(mode="json")) for name, world in worlds.items()},
        }

    def _tables(self, rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
        return word_tables(rows, half_of) or reef_tables(rows, about, command)


SHOWN = ("Sweep", "Effects", "All variants", "Table I, differences", "Table II, differences")
SHOWN_OF_ONE = ("Missions in words", "Sweep", "By world", "All variants")
"""Tables that the terminal shows, two at most, of several variants and of one."""
STUDY: dict[str, Any] = {
    "variants": ",".join(dict.fromkeys((*TABLE_I, *TABLE_II, *BASELINES))),
    "advisors": "heuristic,sloppy:0.3:heuristic,sloppy:0.6:heuristic",
    "presets": "clear,bay,hard",
    "seeds": "0-2",
    "out": Path("runs/study"),
}
"""Defaults of the flags with `--study`."""
DREAM_S = 757.0
"""Time limit of a mission of the study (s): DREAM gets the 126 calls that the paper's had, one in 6 s (Table I)."""
STUDY_IN_WORDS: dict[str, Any] = {
    "variants": "full,geometry,keywords,lawnmower,random,oracle",
    "worlds": "words:all:0-3,words:all:100-103",
    "presets": "clear,coast,bay",
    "out": Path("runs/words"),
}
"""Defaults of the flags with `--study words`."""


def preset_of(spec: Spec) -> str:
    """Return the name of the water that a mission runs in."""
    return str(dict(spec.overrides).get(PRESET, CLEAR))


def mission_of(
    spec: Spec, cfg: MissionCfg, world: ReefWorld, keep: frozenset[str] = frozenset()
) -> tuple[MissionCfg, ReefWorld]:
    """Return configuration and world of a mission: the campaign's, then its preset, its setting and its variant.

    Raises:
        InputError: A key is unknown, or a value is invalid.
    """
    cfg, world = apply_preset(preset_of(spec), cfg, world, keep)
    cfg, world = apply_setting([(key, value) for key, value in spec.overrides if key != PRESET], cfg, world)
    controller_maker(cfg.driver)
    return checked(apply_variant(spec.variant, cfg), "--cfg"), world
