"""What `coral reef bench` and `coral contact bench` share: flags, pending episodes, results and tables."""

from __future__ import annotations

import shlex
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from coral.advisor.preflight import preflight
from coral.advisor.question import Advisor
from coral.campaign.campaign import Summary, run_campaign
from coral.campaign.dataset import Row, write_dataset
from coral.campaign.episode import Episode, Executor
from coral.campaign.local import LocalExecutor
from coral.campaign.progress import CampaignProgress
from coral.campaign.slurm import SlurmCfg
from coral.campaign.spec import NO_ADVISOR, Spec
from coral.campaign.store import CampaignFiles, Store
from coral.campaign.table import Table, document, overview, table_json
from coral.errors import InputError, RunError
from coral.file_writer import write_whole
from coral.flag_parser import scan
from coral.flags import Option
from coral.flags import describe as describe_flags
from coral.runs import provenance
from coral.terminal import tell
from coral.words import many


@dataclass(frozen=True, kw_only=True)
class CampaignCommand(ABC):
    """A command that runs a campaign."""

    name: ClassVar[str]
    """Its words after `coral`."""
    noun: ClassVar[str]
    """The word for an episode."""
    title: ClassVar[str]
    """Title of the tables."""

    out: Path
    """Folder of the campaign."""
    preflight: bool = True
    """Ask each model one small question first, and refuse the campaign if one cannot be used."""
    jobs: int = 1
    """Maximum number of simultaneous episodes (executor local or slurm), one core each."""
    executor: Literal["local", "ray", "slurm"] = "local"
    """local: processes of this machine; ray: a Ray cluster; slurm: jobs of a Slurm cluster."""
    address: str = "auto"
    """Address of the Ray cluster: auto, HOST:PORT, or ray://HOST:PORT."""
    slurm: SlurmCfg = field(default_factory=SlurmCfg)
    retry_failed: bool = False
    """Repeat episodes with a recorded failure."""
    mix: bool = False
    """Accept results of other code or another configuration in the same folder."""
    collect: bool = False
    """Run nothing: make the data set and the tables from the recorded episodes."""
    json: bool = False
    """Print one JSON object on standard output; progress stays on standard error."""
    quiet: bool = False
    """No progress."""
    typed: Annotated[tuple[str, ...], Option(hidden=True)] = ()
    """The words of the command line."""

    @abstractmethod
    def _advisor(self, name: str) -> Advisor:
        """Make the advisor of a row, as far as it can be checked here."""

    @abstractmethod
    def _tables(self, rows: Sequence[Row], about: Mapping[str, Any], command: str) -> list[Table]:
        """Make the tables of all recorded episodes; `about` tells commit and machine, `command` what made them."""

    @abstractmethod
    def _first_tables(self) -> Sequence[str]:
        """Return the beginnings of the names of tables that a terminal shows, by importance."""

    def _collect_recorded(self) -> dict[str, Any]:
        """Make the tables of what is recorded, as `--collect` asks.

        Raises:
            InputError: The folder is no campaign's.
            RunError: Nothing is recorded.
        """
        store = Store(self.out)
        store.manifest()
        with store.lock():
            return self._collect(store, None)

    def _run(self, specs: Sequence[Spec], episode: Episode, conditions: Mapping[str, str]) -> dict[str, Any]:
        """Run the episodes that are not recorded yet, and make the tables.

        `conditions` are digests of what must be equal for all episodes of a table.

        Raises:
            InputError: There are no workers, or a model cannot be used.
            RunError: All of the episodes failed.
        """
        store, retry = Store(self.out), self.retry_failed
        if self.jobs < 1:
            raise InputError("--jobs", "", self.jobs, "a number of 1 or more")
        if self.preflight:
            self._ask_models(store, specs)
        executor = self._executor()
        with store.lock():
            store.open(specs, conditions, command=self._command(), mix=self.mix, about=provenance())
            progress = CampaignProgress(quiet=self.quiet)
            try:
                summary = run_campaign(
                    store, specs, episode, executor, retry_failed=retry, mix=self.mix, progress=progress
                )
            except KeyboardInterrupt:
                tell(f"stopped; the same command continues from here ({self.out})")
                raise
            result = self._collect(store, summary)
        if summary.failed and not result["done"]:
            raise RunError(f"every {self.noun} failed; see {self.out / 'failures'}")
        return result

    def _ask_models(self, store: Store, specs: Sequence[Spec]) -> None:
        """Ask each model of a pending episode one small question; nothing is written."""
        known = store.manifest_path.exists()
        pending = store.pending(specs, retry_failed=self.retry_failed) if known else specs
        for advisor in dict.fromkeys(spec.advisor for spec in pending if spec.advisor != NO_ADVISOR):
            preflight(self._advisor(advisor), pictures=True, where="--advisors", quiet=self.quiet)

    def _executor(self) -> Executor:
        if self.executor == "ray":
            from coral.campaign.cluster import RayExecutor

            return RayExecutor(self.address)
        if self.executor == "slurm":
            from coral.campaign.slurm import SlurmExecutor

            return SlurmExecutor(self.out / ".slurm", self.jobs, self.slurm)
        return LocalExecutor(self.jobs)

    def _command(self) -> str:
        """Return the command as it was typed, without the flags that do not change its results."""
        about = describe_flags(type(self))
        given = scan(self.typed, about, self.name)
        alike = {field.name for field in fields(CampaignCommand)} | {"inbox"}
        words = ["coral", *self.name.split()]
        for flag in about.flags:
            values = given.get(flag.field)
            if values is None or flag.field[0] in alike:
                continue
            if not flag.words:
                words.append(flag.spellings[values == ["no"]])
            elif flag.repeated:
                words += [word for value in values for word in (flag.name, value)]
            else:
                words += [flag.name, *values]
        return shlex.join(words)

    def _collect(self, store: Store, summary: Summary | None) -> dict[str, Any]:
        """Write data set and tables of all recorded episodes; return the bench's result."""
        manifest, records = store.manifest(), store.records()
        if not records:
            raise RunError(f"no {self.noun} is recorded in {self.out} yet")
        about, data = manifest["about"], self.out / CampaignFiles.RESULTS
        rows = write_dataset(records, {name: about.get(name, "") for name in ("commit", "machine")}, data)
        tables = self._tables(rows, about, "; then ".join(manifest["commands"]) or f"coral {self.name}")
        for name in (CampaignFiles.TABLES, CampaignFiles.HTML):
            write_whole(self.out / name, document(tables, name.rpartition(".")[2], self.title).encode())
        done = sum(record["status"] == "done" for record in records)
        return {
            "out": str(self.out),
            "episodes": len(store.specs()),
            "done": done,
            "failed": len(records) - done,
            "ran": summary.finished + summary.failed if summary else 0,
            "found": summary.found if summary else len(records),
            "data": str(data),
            "tables": str(self.out / CampaignFiles.TABLES),
            "results": [table_json(table) for table in tables],
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        """Describe the tables that matter, two at most, the number of episodes, and where the files are."""
        failed = f"; {result['failed']} failed (see {self.out / 'failures'}; --retry-failed runs them again)"
        lines = [
            overview([_table(found) for found in result["results"]], self._first_tables()),
            f"{many(result['done'], self.noun)}{failed if result['failed'] else ''}",
            *(f"{name}: {result[name]}" for name in ("data", "tables", "memory") if result.get(name)),
        ]
        return "\n".join(lines)


def _table(found: Mapping[str, Any]) -> Table:
    """Make a table of what `table_json` returned."""
    header, rows = tuple(next(iter(found["rows"]), ())), tuple(tuple(row.values()) for row in found["rows"])
    return Table(found["name"], found["caption"], header, rows, tuple(found["notes"]))
