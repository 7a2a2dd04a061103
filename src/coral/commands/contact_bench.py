"""`coral contact bench`: compare variants over many trials, and make the paper's Table 1 from them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.question import Advisor
from coral.advisor.registry import advisor_help, asks_person
from coral.campaign.campaign import Summary
from coral.campaign.contact_tables import contact_tables
from coral.campaign.dataset import Row
from coral.campaign.episode import code_version, digest
from coral.campaign.spec import Spec, grid, parse_names, parse_seeds
from coral.campaign.store import CampaignFiles, Store
from coral.campaign.table import Table
from coral.commands.campaigns import CampaignCommand
from coral.commands.config_flag import configured
from coral.commands.contact_run import TRACKER_HELP
from coral.config import to_mapping
from coral.contact.episode.campaign_episode import run_episode
from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.resolution import DEFAULT_ADVISOR, resolve_episode
from coral.contact.episode.variants import (
    ALONE,
    VARIANTS,
    check_variant,
    contact_advisor,
    contact_model,
    make_strategist,
)
from coral.contact.memory.memory import Experience, Memory, open_existing
from coral.contact.policy.address import Address, parse_address
from coral.contact.policy.policy_campaign_episode import run_policy_episode
from coral.contact.scene.task import Task
from coral.contact.scene.task_names import SUITES, shipped_tasks, suite_tasks
from coral.contact.scene.trial import sample_trial
from coral.contact.tasks import load_task
from coral.contact.thinker.think_cfg import StandIn
from coral.contact.thinker.thinking_clock import thinking_latency
from coral.contact.worlds.registry import check_world
from coral.errors import InputError
from coral.flags import Option
from coral.foreign_file import read_bytes
from coral.limits import MESH_BYTES
from coral.run_files import TaskFiles


@dataclass(frozen=True)
class ContactEpisode:
    """Runs the episode of a spec. It contains the tasks, so that a worker needs none of the caller's files."""

    cfg: EpisodeCfg
    model: ModelCfg
    tasks: Mapping[str, Task]
    policies: Mapping[str, Address] = field(default_factory=dict)
    memory: Sequence[Experience] = ()

    def __call__(self, spec: Spec, folder: Path) -> dict[str, Any]:
        task, world = self.tasks[spec.world], dict(spec.overrides)["world"]
        if spec.variant in self.policies:
            return run_policy_episode(
                task, self.cfg, folder, world=world, address=self.policies[spec.variant], seed=spec.seed
            )
        return run_episode(
            task,
            self.cfg,
            folder,
            world=world,
            variant=spec.variant,
            advisor=spec.advisor,
            seed=spec.seed,
            memory=self.memory,
            model=self.model,
        )


def episode_alone() -> EpisodeCfg:
    """Return the default episode configuration of a campaign, in which no fallback decides for the advisor."""
    return resolve_episode(EpisodeCfg(), fallback="hold")


@dataclass(frozen=True, kw_only=True)
class ContactBench(CampaignCommand):
    """Compare variants of the contact pipeline over tasks, evaluation worlds and seeds.

    The same command continues a stopped campaign; a larger grid in the same folder extends it.
    """

    name, noun, title = "contact bench", "episode", "Contact tasks"

    variants: str = "expert,expert-fsm"
    """Variants, separated by commas; none for policies only."""
    policies: str = ""
    """Served policies to compare, NAME=ws://HOST:PORT, separated by commas."""
    tasks: str = "all"
    """Shipped tasks or task files, separated by commas; all: the six of the paper; unseen or long: that suite, or
    unseen:development or unseen:test for half of it."""
    worlds: str = "panda"
    """Evaluation worlds, separated by commas: panda, hand."""
    seeds: str = "0-9"
    """Numbers and ranges, such as 0-4 or 0,3,7-9; the paper makes ten trials of each task."""
    advisors: Annotated[str, Option(help=advisor_help("Separated by commas", rules=False))] = DEFAULT_ADVISOR
    poses: Literal["tracked", "ground-truth"] | None = None
    """Source of the objects' poses: tracked, a simulated depth camera's pictures (the default); ground-truth."""
    tracker: Annotated[str | None, Option(help=f"{TRACKER_HELP} Every worker must be able to reach a server.")] = None
    memory: str | None = None
    """Initial memory of variants with memory: an SQLite file, such as the memory.sqlite of a campaign. Every trial has
    its own copy. By default it is empty."""
    samples: int | None = None
    """Rollouts per plan, instead of the configuration's; the variant paper has 200."""
    fallback: StandIn | None = None
    """Fallback when an advisor does not decide: hold (the default: nothing else decides, and the episode ends),
    fail, or prior, whose rows are marked."""
    out: Path = Path("runs/contact-bench")
    config: Path | None = None
    """YAML file with configuration values; flags override it."""
    model: ModelCfg = field(default_factory=contact_model)
    """Calls of a real model, and the spending limit of each episode."""
    cfg: EpisodeCfg = field(default_factory=episode_alone)
    """Configuration of the episodes."""

    @classmethod
    def from_file(cls, words: Sequence[str]) -> ContactBench:
        return cls(cfg=configured(words, episode_alone()) or episode_alone(), typed=tuple(words))

    def __call__(self) -> Mapping[str, Any]:
        """Run the missing episodes, then make the tables."""
        if self.fallback is not None:
            return dataclasses.replace(self, cfg=resolve_episode(self.cfg, fallback=self.fallback), fallback=None)()
        if self.collect:
            return self._collect_recorded()
        names = named_tasks(self.tasks)
        tasks = {name: load_task(name) for name in names}
        cfg = resolve_episode(self.cfg, samples=self.samples, poses=self.poses, tracker=self.tracker)
        if cfg.poses == "tracked" and self.executor == "local":  # a cluster may reach servers that this machine cannot
            cfg.tracked.choice().check()
        specs = self._specs(tasks)
        memory = [] if self.memory is None else [stored.experience for stored in open_existing(self.memory).all()]
        conditions = self._conditions(cfg, tasks, memory)
        if (self.jobs > 1 or self.executor != "local") and not cfg.planning.threads:
            cfg = dataclasses.replace(cfg, planning=dataclasses.replace(cfg.planning, threads=1))
        episode = ContactEpisode(cfg, self.model, tasks, self._policies(), memory)
        return self._run(specs, episode, conditions)

    def _first_tables(self) -> Sequence[str]:
        return "Table 1, success", "Against"

    def _advisor(self, name: str) -> Advisor:
        return contact_advisor(name, self.model, where="--advisors")

    def _specs(self, tasks: Mapping[str, Task]) -> tuple[Spec, ...]:
        worlds = parse_names(self.worlds, "--worlds")
        policies = self._policies()
        variants = () if policies and self.variants == "none" else parse_names(self.variants, "--variants")
        advisors = parse_names(self.advisors, "--advisors")
        seeds = parse_seeds(self.seeds)
        for name, task in tasks.items():
            for seed in seeds:
                sample_trial(task, seed, name)
        for variant in variants:
            check_variant(variant, "--variants")
            for task in tasks.values():
                make_strategist(variant, task)  # report what is missing here, not in every worker
        for world in worlds:
            check_world(world, "--worlds")
        for advisor in advisors:
            if asks_person(advisor):
                raise InputError("--advisors", "", repr(advisor), "advisors that answer by themselves")
            thinking_latency(self.cfg.think.latency, self._advisor(advisor), advisor)
        return grid(
            "contact",
            variants=(*variants, *policies),
            worlds=tuple(tasks),
            seeds=seeds,
            advisors=advisors,
            alone=[*(name for name in variants if name in ALONE), *policies],
            overrides=[{"world": world} for world in worlds],
        )

    def _policies(self) -> dict[str, Address]:
        words = parse_names(self.policies, "--policies") if self.policies else ()
        found = [parse_address(word, VARIANTS, "--policies") for word in words]
        if len({one.name for one in found}) < len(found):
            raise InputError("--policies", "", repr(self.policies), "a name of its own for each")
        return {one.name: one for one in found}

    def _conditions(self, cfg: EpisodeCfg, tasks: Mapping[str, Task], memory: Sequence[Experience]) -> dict[str, str]:
        """Compute digests of all conditions that must be equal for every episode of a table."""
        content = to_mapping(cfg)
        content.pop("record")
        content["planning"].pop("threads")  # affects only the run time
        content["tracked"]["by"] = cfg.tracked.choice().name  # a server's address does not matter either
        whole = {"episode": content, "model": to_mapping(self.model)}
        return {
            "code version": code_version(),
            "configuration": digest(whole),
            "memory": digest([one.model_dump(mode="json") for one in memory]) if memory else "none",
            **{f"task {name}": _task_digest(task) for name, task in tasks.items()},
        }

    def _collect(self, store: Store, summary: Summary | None) -> dict[str, Any]:
        return {**super()._collect(store, summary), "memory": self._gather_memories(store)}

    def _tables(self, rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
        return contact_tables(rows, about, command)

    def _gather_memories(self, store: Store) -> str:
        """Put the new experiences of all trials of `full`, in order, into one memory; "" if there are none.

        Plans without regions, as made by `unguided` and `no-regions`, would not help a variant with regions.
        """
        path = self.out / CampaignFiles.MEMORY
        path.unlink(missing_ok=True)
        memory = Memory(path)
        for spec in store.specs():
            if spec.variant == "full":
                for stored in Memory(store.run_folder(spec) / TaskFiles.REMEMBERED).all():
                    memory.add(stored.experience)
        return str(path) if memory.store.exists() else ""


def named_tasks(text: str) -> tuple[str, ...]:
    """Return the tasks that `--tasks` names.

    Raises:
        InputError: A suite has no such half.
    """
    which, _, half = text.partition(":")
    if "," in text or which not in ("all", *SUITES) or (which == "all" and half):
        return parse_names(text, "--tasks")
    return shipped_tasks() if which == "all" else suite_tasks(which, half)


def _task_digest(task: Task) -> str:
    """Compute a digest of a task file, with meshes represented by their content."""
    content = task.model_dump(mode="json")
    for item in content["objects"]:
        for part in item["parts"]:
            if part["file"] is not None:
                part["file"] = digest(read_bytes(Path(part["file"]), "a mesh", MESH_BYTES).hex())
    return digest(content)
