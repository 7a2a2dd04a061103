import io

import pytest
from rich.console import Console

from coral.campaign.episode import EpisodeOutcome
from coral.campaign.progress import CampaignProgress
from coral.campaign.spec import Spec

SPEC = Spec(system="toy", variant="a", world="w", seed=0, advisor="x")


@pytest.fixture
def told():
    return io.StringIO()


def test_without_a_terminal_lines_appear_now_and_then_and_at_the_end(told):
    now = [0.0]
    progress = CampaignProgress(clock=lambda: now[0], console=Console(file=told, width=200))
    progress.begin(6, 2, jobs=1)
    good, bad = EpisodeOutcome(SPEC, {}), EpisodeOutcome(SPEC, message="[b] no")
    for seconds, outcome in ((5.0, good), (20.0, good), (30.0, bad), (40.0, good)):
        now[0] = seconds
        progress.ended(outcome)
    progress.close()
    assert told.getvalue().splitlines() == [
        "recorded before: 2 of 6 episodes",
        f"4 of 6 · about 20 s left · last: {SPEC.key}",
        f"failed: {SPEC.key}: [b] no",
        f"6 of 6 · 1 failed · in 40 s · last: {SPEC.key}",
    ]


def test_the_last_round_of_parallel_missions_takes_a_whole_mission(told):
    now = [0.0]
    progress = CampaignProgress(clock=lambda: now[0], console=Console(file=told))
    progress.begin(5, 0, jobs=4)
    now[0] = 100.0
    for _ in range(4):
        progress.ended(EpisodeOutcome(SPEC, {}))
    assert progress.status() == "4 of 5 · about 2 min left"
