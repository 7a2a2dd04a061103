"""`coral memory bench`: whether the memory finds the right plan for changed tasks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from coral.contact.episode.retrieval_bench import rank_by_wording, retrieve_cases, score_retrieval
from coral.contact.episode.retrieval_cases import load_retrieval_cases
from coral.contact.memory.embedding import DEFAULT, embedder_of


@dataclass(frozen=True, kw_only=True)
class MemoryBench:
    """Look up a plan for changed tasks: other words, sizes, heights, more objects, and tasks that nothing fits."""

    half: str = "development"
    """Half of the test set: development, or test, which is kept for measuring."""
    embedder: str = DEFAULT
    """Embeds instructions: concepts, words, wordllama, or an entry point of the group coral.embedders."""
    json: bool = False
    """Print one JSON object."""

    def __call__(self) -> Mapping[str, Any]:
        """Look up every case."""
        cases, embedder = load_retrieval_cases(self.half), embedder_of(self.embedder)
        results = retrieve_cases(cases, embedder)
        reworded, nearest = rank_by_wording(cases, embedder)
        return {
            "half": self.half,
            "embedder": embedder.name,
            "by_wording_alone": {"cases": reworded, "right": nearest},
            "by_change": score_retrieval(results),
            "cases": [
                {
                    "task": one.case.origin,
                    "change": one.case.change,
                    "instruction": one.case.task.instruction,
                    "fits": list(one.case.fits),
                    "found": one.found,
                    "similarity": one.similarity,
                    "right": one.right,
                }
                for one in results
            ],
        }

    def describe(self, result: Mapping[str, Any]) -> str:
        """Return a table by kind of change, then what went wrong."""
        head = f"{'change':<10}{'cases':>6}{'right':>7}{'wrong plan offered':>20}"
        rows = [
            f"{kind:<10}{row['cases']:>6}{row['right']:>7}{row['wrong_offers']:>20}"
            for kind, row in result["by_change"].items()
        ]
        missed = [
            f"{one['task']}, {one['change']}: fits {' or '.join(one['fits'])}, found {one['found']}"
            for one in result["cases"]
            if not one["right"]
        ]
        alone = result["by_wording_alone"]
        rows.append(f"by wording alone ({result['embedder']}): {alone['right']} of {alone['cases']} reworded tasks")
        return "\n".join([head, *rows, *(["", *missed] if missed else [])])
