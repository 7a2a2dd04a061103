from dataclasses import replace

import pytest

from coral.campaign.campaign import run_campaign
from coral.campaign.episode import perform
from coral.campaign.spec import grid
from coral.campaign.store import Store
from coral.errors import RunError

SEEDS = (0, 1, 2, 3)


class Here:
    """Runs episodes one after the other in this process, and notes which."""

    jobs = 1

    def __init__(self, **about):
        self.seeds, self.about, self.closed = [], about, False

    def run(self, episode, tasks):
        try:
            for task in tasks:
                self.seeds.append(task.spec.seed)
                outcome = perform(episode, task.spec, task.scratch)
                yield replace(outcome, about={**outcome.about, **self.about})
        finally:
            self.closed = True


def specs(seeds=SEEDS):
    return grid("toy", variants=["a"], worlds=["w"], seeds=seeds, advisors=["x"])


def episode(spec, folder):
    if spec.seed == 1:
        raise ValueError("the reef is closed")
    return {"score": spec.seed}


@pytest.fixture
def run(tmp_path):
    """Runs a campaign in one and the same folder."""
    store = Store(tmp_path / "out")

    def go(wanted=None, executor=None, **options):
        wanted = wanted or specs()
        with store.lock():
            store.open(wanted, {"code": "1"})
            return run_campaign(store, wanted, episode, executor or Here(), **options)

    go.store = store
    return go


class Full(Here):
    """The disk is full from the second episode on."""

    def run(self, episode, tasks):
        for k, outcome in enumerate(super().run(episode, tasks)):
            full = replace(outcome, result=None, message="OSError: no space left", no_room=True)
            yield outcome if k == 0 else full


def test_a_full_disk_ends_the_campaign_and_no_episode_is_recorded_as_a_failure(run):
    wanted = specs((0, 2, 3))
    with pytest.raises(RunError, match="no space left; make room, and the same command continues"):
        run(wanted, Full())
    after = run(wanted)
    assert (after.found, after.finished, after.failed) == (1, 2, 0)


def test_the_same_command_again_runs_nothing_a_larger_one_the_rest_a_retry_the_failures(run):
    first = run(specs((0, 1)))
    assert (first.wanted, first.found, first.finished, first.failed) == (2, 0, 1, 1)
    again = Here()
    assert run(specs((0, 1)), again).found == 2
    assert again.seeds == []
    more = Here()
    assert (run(executor=more).finished, sorted(more.seeds)) == (2, [2, 3])
    retried = Here()
    assert (run(executor=retried, retry_failed=True).failed, retried.seeds) == (1, [1])
    assert [record["status"] for record in run.store.records()] == ["done", "failed", "done", "done"]


def test_the_longest_episodes_start_first_as_far_as_they_were_measured(tmp_path):
    store = Store(tmp_path / "out")
    known = grid("toy", variants=["short", "long"], worlds=["w"], seeds=[0], advisors=["x"])
    more = grid("toy", variants=["short", "long"], worlds=["v"], seeds=[2], advisors=["x"])
    order = []
    with store.lock():
        store.open(known, {})
        for spec in known:
            store.finish(spec, {}, {"episode_wall_s": {"short": 1.0, "long": 9.0}[spec.variant]})
        store.open(more, {})
        run_campaign(store, more, lambda spec, folder: order.append(spec.variant) or {}, Here())
    assert order == ["long", "short"]


def test_a_worker_of_another_version_is_refused_unless_mixed(run):
    other = Here(code="other", host="reef-7")
    with pytest.raises(RunError, match=r"a worker on reef-7 runs another version of coral \(other\) .* give --mix"):
        run(executor=other)
    assert other.closed
    assert run.store.records() == []
    assert run(executor=Here(code="other"), mix=True).finished == 3


def test_progress_hears_of_every_outcome_and_of_the_end(run):
    class Progress:
        def __init__(self):
            self.heard = []

        def begin(self, total, found, jobs):
            self.heard.append((total, found, jobs))

        def ended(self, outcome):
            self.heard.append((outcome.spec.seed, outcome.message))

        def close(self):
            self.heard.append("closed")

    progress = Progress()
    run(specs((0, 1)), progress=progress)
    assert progress.heard == [(2, 0, 1), (0, ""), (1, "ValueError: the reef is closed"), "closed"]
