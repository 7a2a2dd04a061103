"""The files of a bench's folder: writers and readers take their names from here, and the reference its table."""

from __future__ import annotations

from typing import Final


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
    MEMORY: Final = "memory.json"
    """Of tasks: the successes of `full`, for `--memory`."""
