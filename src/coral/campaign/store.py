"""Results of a campaign on disk: one small file per finished episode, written atomically."""

from __future__ import annotations

import fcntl
import json
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from coral.campaign.spec import Spec
from coral.errors import InputError
from coral.file_writer import open_log, write_whole, writing
from coral.foreign_file import read_json

FORMAT = "coral-campaign/1"
Record = dict[str, Any]


class Store:
    """The folder of a campaign.

    `runs/KEY/` contains the files of an episode, and `runs/.KEY/` those of a running one. The file in `episodes/` is
    the commit point: with it an episode is finished and stays, without it the episode never happened. Only one process
    at a time writes (`lock`).
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        self.manifest_path = self.folder / CampaignFiles.MANIFEST

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Lock the folder for this process; the system releases the lock however the process ends.

        Raises:
            InputError: The folder cannot be written, contains other files, or another campaign writes to it.
        """
        where = str(self.folder)
        with writing(where, "--out", "a folder that can be written"):
            self.folder.mkdir(parents=True, exist_ok=True)
            strangers = [p.name for p in self.folder.iterdir() if not p.name.startswith(".")]
            if strangers and not self.manifest_path.exists():
                found = f"a folder with other things in it ({strangers[0]})"
                raise InputError(where, "--out", found, "a new or empty folder, or one that a campaign made")
            handle = open_log(self.folder / ".lock", new=False)
        with handle:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                expected = "a folder that no other process writes to"
                raise InputError(where, "--out", "a campaign that is still running", expected) from None
            yield

    def manifest(self) -> Record:
        """Return the manifest of the campaign.

        Raises:
            InputError: There is none here, or it has another format.
        """
        content = _read(self.manifest_path)
        if content is None or content.get("format") != FORMAT:
            found = "no campaign" if content is None else repr(content.get("format"))
            raise InputError(str(self.folder), CampaignFiles.MANIFEST, found, f"a campaign's folder ({FORMAT})")
        return content

    def open(
        self,
        specs: Sequence[Spec],
        conditions: Mapping[str, str],
        *,
        command: str = "",
        mix: bool = False,
        about: Mapping[str, Any] | None = None,
    ) -> None:
        """Open the campaign with this grid: begin, continue or extend it.

        The conditions, by name, must be equal for compared results unless `mix` is set; names that only one side has
        are no conflict. `about` has further facts for the tables: commit, machine, date.

        Raises:
            InputError: A condition has changed and `mix` is not set.
        """
        old = self.manifest() if self.manifest_path.exists() else {"conditions": {}, "specs": [], "commands": []}
        known: dict[str, str] = old["conditions"]
        for name, value in conditions.items():
            if not mix and known.get(name, value) != value:
                found = f"results made with {known[name]} (now: {value})"
                expected = "the same as before, a new --out, or --mix to put both into one table"
                raise InputError(str(self.folder), name, found, expected)
        wanted = dict.fromkeys([*(Spec.from_json(content) for content in old["specs"]), *specs])
        commands = [*old["commands"], *([command] if command and command not in old["commands"] else [])]
        manifest = {
            "format": FORMAT,
            "conditions": {**known, **conditions},
            "about": {**old.get("about", {}), **(about or {})},
            "commands": commands,
            "specs": [spec.to_json() for spec in wanted],
        }
        self._write(self.manifest_path, manifest)
        self._sweep()

    def specs(self) -> tuple[Spec, ...]:
        """Return every episode ever requested."""
        return tuple(Spec.from_json(content) for content in self.manifest()["specs"])

    def pending(self, specs: Iterable[Spec], *, retry_failed: bool = False) -> tuple[Spec, ...]:
        """Return the episodes that still have to run."""
        done, failed = self._keys(CampaignFiles.EPISODES), self._keys(CampaignFiles.FAILURES)
        return tuple(spec for spec in specs if spec.key not in done and (retry_failed or spec.key not in failed))

    def scratch(self, spec: Spec) -> Path:
        """Return the folder of a running episode; it becomes `run_folder` once the episode is finished."""
        return self.folder / CampaignFiles.RUNS / f".{spec.key}"

    def run_folder(self, spec: Spec) -> Path:
        """Return the folder of a finished episode."""
        return self.folder / CampaignFiles.RUNS / spec.key

    def finish(self, spec: Spec, result: Mapping[str, Any], about: Mapping[str, Any]) -> bool:
        """Record a finished episode with its files; return False, and change nothing, if it was recorded before."""
        path = self.folder / CampaignFiles.EPISODES / f"{spec.key}.json"
        if _read(path) is not None:
            shutil.rmtree(self.scratch(spec), ignore_errors=True)
            return False
        self._keep(spec)
        self._write(path, {"spec": spec.to_json(), "status": "done", "result": dict(result), "about": dict(about)})
        (self.folder / CampaignFiles.FAILURES / path.name).unlink(missing_ok=True)
        return True

    def fail(self, spec: Spec, message: str, detail: str, about: Mapping[str, Any]) -> None:
        """Record that an episode could not be finished; its files are kept for diagnosis."""
        self._keep(spec)
        self._write(
            self.folder / CampaignFiles.FAILURES / f"{spec.key}.json",
            {"spec": spec.to_json(), "status": "failed", "message": message, "detail": detail, "about": dict(about)},
        )

    def records(self) -> list[Record]:
        """Return every recorded episode, finished or failed, in the order of the grid."""
        done, failed = self.folder / CampaignFiles.EPISODES, self.folder / CampaignFiles.FAILURES
        found = (_read(done / f"{spec.key}.json") or _read(failed / f"{spec.key}.json") for spec in self.specs())
        return [record for record in found if record is not None]

    def _keep(self, spec: Spec) -> None:
        """Move the episode's files to their place, replacing those of a run without a record."""
        scratch, place = self.scratch(spec), self.run_folder(spec)
        if scratch.is_dir():
            shutil.rmtree(place, ignore_errors=True)
            os.replace(scratch, place)

    def _sweep(self) -> None:
        """Remove the unfinished work of a killed campaign."""
        for leftover in self.folder.glob(f"{CampaignFiles.RUNS}.*"):
            shutil.rmtree(leftover, ignore_errors=True)
        for place in (self.folder, self.folder / CampaignFiles.EPISODES, self.folder / CampaignFiles.FAILURES):
            for leftover in place.glob("*.part"):
                leftover.unlink(missing_ok=True)

    def _keys(self, kind: str) -> set[str]:
        return {path.stem for path in (self.folder / kind).glob("*.json") if _read(path) is not None}

    def _write(self, path: Path, content: Mapping[str, Any]) -> None:
        write_whole(path, json.dumps(content, allow_nan=False, indent=1) + "\n", durable=True)


def _read(path: Path) -> Record | None:
    try:
        content = read_json(path, "a record of a campaign")
    except InputError:
        return None
    return content if isinstance(content, dict) else None


class CampaignFiles:
    """Files of a campaign."""

    TABLES: Final = "tables.md"
    """All tables; `pandoc tables.md -o tables.tex` makes LaTeX of them."""
    HTML: Final = "tables.html"
    """The same as a page."""
    RESULTS: Final = "results.parquet"
    """One row per episode: all metrics, times, commit, machine."""
    RUNS: Final = "runs/"
    """The run folder of every episode, without frames: of a survey, its final map alone. `coral report` makes its page;
    `coral reef run` with the same seed has the frames."""
    EPISODES: Final = "episodes/"
    """One record per finished episode, the source of all the files above."""
    FAILURES: Final = "failures/"
    """One record per failed episode, with its message and traceback."""
    MANIFEST: Final = "manifest.json"
    """Every episode ever asked for, the commands, and what must be equal: code, configuration, worlds."""
    MEMORY: Final = "memory.sqlite"
    """Of tasks: the successes of `full`, for `--memory`."""
