"""Shared parts of `coral reef bench` and `coral contact bench`: flags, pending episodes, results and tables."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Any, Literal

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
from coral.flags import Option, describe
from coral.runs import provenance
from coral.terminal import tell
from coral.words import many


@dataclass(frozen=True, kw_only=True)
class CampaignFlags:
    """Flags of a campaign, the same for both applications."""

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


@dataclass(frozen=True)
class Results:
    """The contents of a campaign's folder."""

    rows: Sequence[Row]
    """One row per recorded episode, as in results.parquet."""
    records: Sequence[Mapping[str, Any]]
    about: Mapping[str, Any]
    """Origin of the results: commit, machine."""
    command: str
    """The commands that made them."""

    @property
    def done(self) -> list[Mapping[str, Any]]:
        """Return the records of the finished episodes."""
        return [record for record in self.records if record["status"] == "done"]


Collect = Callable[[Store, Summary | None], dict[str, Any]]
"""Makes data set and tables of a folder's records; returns the bench's result."""


def collect_only(out: Path, collect: Collect) -> dict[str, Any]:
    """Make the tables of what is recorded in a folder, as `--collect` asks.

    Raises:
        InputError: It is no campaign's folder.
    """
    store = Store(out)
    store.manifest()
    with store.lock():
        return collect(store, None)


def run_specs(
    flags: CampaignFlags,
    store: Store,
    specs: Sequence[Spec],
    episode: Episode,
    conditions: Mapping[str, str],
    command: str,
    collect: Collect,
    noun: str,
    make: Callable[[str], Advisor],
) -> dict[str, Any]:
    """Run the episodes that are not recorded yet, and make the tables.

    `conditions` are digests of what must be equal for all episodes of a table, `noun` is the word for an episode.
    `make` makes the advisor of a string, as far as it can be checked here.

    Raises:
        InputError: There are no workers, or a model cannot be used.
        RunError: All of the episodes failed.
    """
    if flags.jobs < 1:
        raise InputError("--jobs", "", flags.jobs, "a number of 1 or more")
    if flags.preflight:
        _ask_models(flags, store, specs, make)
    executor = _executor(flags, store)
    with store.lock():
        store.open(specs, conditions, command=command, mix=flags.mix, about=provenance())
        progress = CampaignProgress(quiet=flags.quiet)
        try:
            summary = run_campaign(
                store, specs, episode, executor, retry_failed=flags.retry_failed, mix=flags.mix, progress=progress
            )
        except KeyboardInterrupt:
            tell(f"stopped; the same command continues from here ({store.folder})")
            raise
        result = collect(store, summary)
    if summary.failed and not result["done"]:
        raise RunError(f"every {noun} failed; see {store.folder / 'failures'}")
    return result


def _ask_models(flags: CampaignFlags, store: Store, specs: Sequence[Spec], make: Callable[[str], Advisor]) -> None:
    """Ask each model of a pending episode one small question; nothing is written."""
    known = store.manifest_path.exists()
    pending = store.pending(specs, retry_failed=flags.retry_failed) if known else specs
    for advisor in dict.fromkeys(spec.advisor for spec in pending if spec.advisor != NO_ADVISOR):
        preflight(make(advisor), pictures=True, where="--advisors", quiet=flags.quiet)


def _executor(flags: CampaignFlags, store: Store) -> Executor:
    if flags.executor == "ray":
        from coral.campaign.cluster import RayExecutor

        return RayExecutor(flags.address)
    if flags.executor == "slurm":
        from coral.campaign.slurm import SlurmExecutor

        return SlurmExecutor(store.folder / ".slurm", flags.jobs, flags.slurm)
    return LocalExecutor(flags.jobs)


def typed_command(name: str, flags: CampaignFlags) -> str:
    """Return a command such as "reef bench" as it was typed, without the flags that do not change its results."""
    about = describe(type(flags))
    given = scan(flags.typed, about, name)
    alike = {field.name for field in fields(CampaignFlags)} | {"out"}
    words = ["coral", *name.split()]
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


def read_results(store: Store, noun: str, command: str) -> Results:
    """Write results.parquet from the records; `command` is told where the manifest names none.

    Raises:
        RunError: Nothing is recorded.
    """
    manifest, records = store.manifest(), store.records()
    about = manifest["about"]
    if not records:
        raise RunError(f"no {noun} is recorded in {store.folder} yet")
    origin = {name: about.get(name, "") for name in ("commit", "machine")}
    rows = write_dataset(records, origin, store.folder / CampaignFiles.RESULTS)
    return Results(rows, records, about, "; then ".join(manifest["commands"]) or command)


def write_tables(
    store: Store, results: Results, tables: Sequence[Table], title: str, summary: Summary | None
) -> dict[str, Any]:
    """Write the tables as Markdown and HTML; return the bench's result."""
    for name in (CampaignFiles.TABLES, CampaignFiles.HTML):
        write_whole(store.folder / name, document(tables, name.rpartition(".")[2], title).encode())
    return {
        "out": str(store.folder),
        "episodes": len(store.specs()),
        "done": len(results.done),
        "failed": len(results.records) - len(results.done),
        "ran": summary.finished + summary.failed if summary else 0,
        "found": summary.found if summary else len(results.records),
        "data": str(store.folder / CampaignFiles.RESULTS),
        "tables": str(store.folder / CampaignFiles.TABLES),
        "results": [table_json(table) for table in tables],
    }


def describe_campaign(out: Path, result: Mapping[str, Any], noun: str, first: Sequence[str]) -> str:
    """Describe the tables that matter, two of those in `first`, the number of episodes, and where the files are."""
    failed = f"; {result['failed']} failed (see {out / 'failures'}; --retry-failed runs them again)"
    lines = [
        overview([_table(found) for found in result["results"]], first),
        f"{many(result['done'], noun)}{failed if result['failed'] else ''}",
        *(f"{name}: {result[name]}" for name in ("data", "tables", "memory") if result.get(name)),
    ]
    return "\n".join(lines)


def _table(found: Mapping[str, Any]) -> Table:
    """Make a table of what `table_json` returned."""
    header, rows = tuple(next(iter(found["rows"]), ())), tuple(tuple(row.values()) for row in found["rows"])
    return Table(found["name"], found["caption"], header, rows, tuple(found["notes"]))
