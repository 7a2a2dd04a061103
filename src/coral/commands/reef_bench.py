"""`coral reef bench`: compare variants over many missions, and make the paper's tables from them."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import tyro

from coral.advisor.fallback import FOR_BENCHES, Fallback
from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor
from coral.advisor.registry import advisor_help, asks_person, make_advisor, rules_alone
from coral.campaign.bench import digest
from coral.campaign.campaign import Summary
from coral.campaign.reef_tables import DRAWN, REFERENCE, TABLE_I, reef_tables
from coral.campaign.spec import NO_ADVISOR, Spec, called, grid, parse_names, parse_seeds
from coral.campaign.store import Store
from coral.campaign.sweep import parse_sweeps
from coral.campaign.version import code_version
from coral.commands.campaigns import (
    CampaignFlags,
    check_finished,
    check_jobs,
    describe_campaign,
    read_results,
    run_specs,
    write_tables,
)
from coral.commands.config_flag import config_words, configured
from coral.commands.preflight import preflight_campaign
from coral.commands.reef_run import with_fallback
from coral.config import checked, to_mapping
from coral.errors import InputError
from coral.reef.campaign_episode import run_episode
from coral.reef.heuristic import REEF_RULES
from coral.reef.mission import MissionCfg
from coral.reef.mistakes import REEF_MISTAKES
from coral.reef.sweep import apply_setting
from coral.reef.variants import apply_variant
from coral.reef.world import ReefWorld, load_world, shipped_worlds
from coral.runs import provenance
from coral.view.questions import question_pictures


@dataclass(frozen=True)
class ReefEpisode:
    """Runs the mission of a spec. It contains the worlds, so that a worker needs none of the caller's files."""

    cfg: MissionCfg
    model: ModelCfg
    worlds: Mapping[str, ReefWorld]

    def __call__(self, spec: Spec, folder: Path) -> dict[str, Any]:
        """Run the mission."""
        cfg, world = mission_of(spec, self.cfg, self.worlds[spec.world])
        advisor = "heuristic" if spec.advisor == NO_ADVISOR else spec.advisor
        sees = not rules_alone(advisor)
        return run_episode(
            world,
            cfg,
            folder,
            variant=spec.variant,
            advisor=advisor,
            seed=spec.seed,
            model=self.model,
            draw=question_pictures if sees else None,
        )


def mission_alone() -> MissionCfg:
    """Return the default mission configuration of a campaign, in which no fallback decides for the advisor."""
    return with_fallback(MissionCfg(), FOR_BENCHES)


@dataclass(frozen=True, kw_only=True)
class ReefBench(CampaignFlags):
    """Compare variants of the reef survey over worlds, seeds and advisors.

    The same command continues a stopped campaign; a larger grid in the same folder extends it.
    """

    variants: str = "dream,pd,full,blind-sweep,random,oracle"
    """Variants, separated by commas."""
    worlds: str = "all"
    """Shipped reefs or world files, separated by commas; all: the ten shipped ones."""
    seeds: str = "0"
    """Numbers and ranges, such as 0-4 or 0,3,7-9."""
    advisors: Annotated[str, tyro.conf.arg(help=advisor_help("Separated by commas"))] = "heuristic"
    sweep: Annotated[tuple[str, ...], tyro.conf.UseAppendAction] = ()
    """KEY=V1,V2,...: repeat the whole grid for each value. KEY: current, visibility, mask_errors, depth_noise,
    pose_drift, or a key of the configuration. If given several times, each key is swept separately."""
    fallback: Fallback | None = None
    """Fallback when an advisor does not decide: hold (the default: nothing else decides), fail (the mission ends),
    or rules, whose rows are marked."""
    out: Path = Path("runs/bench")
    """Folder of the campaign."""
    config: Path | None = None
    """YAML file with configuration values; flags override it."""
    model: ModelCfg = field(default_factory=ModelCfg)
    """Calls of a real model, and the spending limit of each mission."""
    cfg: MissionCfg = field(default_factory=mission_alone)
    """Configuration of the missions."""

    @classmethod
    def from_file(cls, words: Sequence[str]) -> ReefBench | None:
        """Read the defaults of the flags from the file of `--config`, before the flags themselves."""
        cfg = configured(words, mission_alone())
        return None if cfg is None else cls(cfg=cfg)

    def __call__(self) -> Mapping[str, Any]:
        """Run the missing missions, then make the tables."""
        if self.fallback is not None:
            return replace(self, cfg=with_fallback(self.cfg, self.fallback), fallback=None)()
        store = Store(self.out)
        if self.collect:
            store.manifest()
            with store.lock():
                return self._collect(store, None)
        worlds = self._worlds()
        specs = self._specs(worlds)
        check_jobs(self.jobs)
        if self.preflight:
            preflight_campaign(
                store, specs, self._advisor, pictures=True, retry_failed=self.retry_failed, quiet=self.quiet
            )
        with store.lock():
            store.open(specs, self._conditions(worlds), command=self._command(), mix=self.mix, about=provenance())
            summary = run_specs(self, store, specs, ReefEpisode(self.cfg, self.model, worlds))
            result = self._collect(store, summary)
        check_finished(result, summary, self.out, "mission")
        return result

    def describe(self, result: Mapping[str, Any]) -> str:
        """Describe the tables and list the files."""
        return describe_campaign(self.out, result, "mission", ("data", "tables", "figure", "sweep"))

    def _worlds(self) -> dict[str, ReefWorld]:
        names = shipped_worlds() if self.worlds == "all" else parse_names(self.worlds, "--worlds")
        return {name: load_world(name) for name in names}

    def _advisor(self, name: str) -> Advisor:
        """Make the advisor of a row, as far as it can be checked here."""
        return make_advisor(
            name, rules=REEF_RULES, rng=_rng(), cfg=self.model, where="--advisors", mistakes=REEF_MISTAKES
        )

    def _specs(self, worlds: Mapping[str, ReefWorld]) -> tuple[Spec, ...]:
        variants = parse_names(self.variants, "--variants")
        alone = {variant for variant in variants if apply_variant(variant, self.cfg).decider != "advisor"}
        advisors = parse_names(self.advisors, "--advisors")
        for advisor in advisors:
            if asks_person(advisor):
                raise InputError("--advisors", "", repr(advisor), "advisors that answer by themselves")
            self._advisor(advisor)
        specs = grid(
            "reef",
            variants=variants,
            worlds=tuple(worlds),
            seeds=parse_seeds(self.seeds),
            advisors=advisors,
            alone=alone,
            overrides=parse_sweeps(self.sweep),
        )
        for spec in {(spec.variant, spec.overrides): spec for spec in specs}.values():
            mission_of(spec, self.cfg, worlds[spec.world])  # reject a bad value here, not in every worker
        return specs

    def _conditions(self, worlds: Mapping[str, ReefWorld]) -> dict[str, str]:
        """Compute digests of all conditions that must be equal for every mission of a table."""
        cfg = {"mission": to_mapping(self.cfg), "model": to_mapping(self.model)}
        cfg["mission"].pop("record")
        return {
            "code version": f"{code_version()}",
            "configuration": digest(cfg),
            **{f"world {name}": digest(world.model_dump(mode="json")) for name, world in worlds.items()},
        }

    def _collect(self, store: Store, summary: Summary | None) -> dict[str, Any]:
        results = read_results(store, "mission", "coral reef bench")
        tables = reef_tables(results.rows, results.about, results.command)
        return {
            **write_tables(store, results, tables, "Reef survey", summary),
            "figure": self._draw(store, results.done),
            "sweep": self._draw_sweep(results.rows),
        }

    def _draw(self, store: Store, done: Sequence[Mapping[str, Any]]) -> str:
        """Draw the trajectories of the first seed and advisor in every world: the paper's variants, or the first 4."""
        specs = [Spec.from_json(record["spec"]) for record in done]
        if not specs:
            return ""
        seed = min(spec.seed for spec in specs)
        advisor = next((spec.advisor for spec in specs if spec.advisor != NO_ADVISOR), NO_ADVISOR)
        overrides = min((spec.overrides for spec in specs), key=len)  # the nominal setting if present
        there = list(dict.fromkeys(spec.variant for spec in specs))
        variants = [name for name in TABLE_I if name in there]
        variants = variants if len(variants) > 1 else there[:4]
        variants.sort(key=lambda name: name == REFERENCE)  # drawn last, on top
        runs: dict[str, dict[str, Path]] = {}
        for variant in variants:
            for spec in specs:
                if (
                    (spec.variant, spec.seed) == (variant, seed)
                    and spec.advisor in (advisor, NO_ADVISOR)
                    and spec.overrides == overrides
                    and store.run_folder(spec).is_dir()
                ):
                    runs.setdefault(Path(spec.world).stem, {})[variant] = store.run_folder(spec)
        if not runs:
            return ""
        from coral.campaign.overlay import draw_overlay

        draw_overlay(runs, self.out / "trajectories.png", seed=seed, advisor=advisor)
        return str(self.out / "trajectories.png")

    def _draw_sweep(self, rows: Sequence[Mapping[str, Any]]) -> str:
        """Draw the sweep's figure under the first advisor; return "" if nothing was swept."""
        from coral.campaign.sweep_figure import draw_sweep

        done = [row for row in rows if row["status"] == "done"]
        advisor = next((row["advisor"] for row in done if row["advisor"] != NO_ADVISOR), NO_ADVISOR)
        variants: dict[str, list[Mapping[str, Any]]] = {}
        for row in done:
            if row["advisor"] in (advisor, NO_ADVISOR):
                variants.setdefault(row["variant"], []).append(row)
        worlds = ", ".join(dict.fromkeys(Path(row["world"]).stem for row in done))
        drawn = draw_sweep(variants, DRAWN, self.out / "sweep.png", title=f"{worlds} · advisor {called(advisor)}")
        return str(self.out / "sweep.png") if drawn else ""

    def _command(self) -> str:
        """Return the command that makes this campaign, without flags that do not change its results."""
        words = [
            "coral",
            "reef",
            "bench",
            "--variants",
            self.variants,
            "--worlds",
            self.worlds,
            "--seeds",
            self.seeds,
            "--advisors",
            self.advisors,
        ]
        words += [word for text in self.sweep for word in ("--sweep", text)]
        words += config_words(self.cfg, mission_alone(), self.config)
        words += config_words(self.model, ModelCfg(), None, "model")
        return shlex.join(words)


def mission_of(spec: Spec, cfg: MissionCfg, world: ReefWorld) -> tuple[MissionCfg, ReefWorld]:
    """Return configuration and world of a mission: the campaign's, then the spec's setting, then its variant.

    Raises:
        InputError: A key is unknown, or a value is invalid.
    """
    cfg, world = apply_setting(spec.overrides, cfg, world)
    return checked(apply_variant(spec.variant, cfg), "--cfg"), world


def _rng() -> Any:
    import numpy as np

    return np.random.default_rng(0)
