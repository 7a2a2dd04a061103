"""A real Ray cluster of two nodes on this machine, one of which is killed midway (make test-ray)."""

from pathlib import Path

import pytest

from coral.campaign.campaign import run_campaign
from coral.campaign.store import Store
from coral.errors import RunError

pytestmark = pytest.mark.ray
EPISODES = 24


@pytest.fixture
def cluster(monkeypatch):
    ray = pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    here = str(Path(__file__).parent)
    # Workers of every node import the toy episodes; a real episode comes with the installed package.
    monkeypatch.setenv("PYTHONPATH", here)
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    try:
        yield cluster
    finally:
        ray.shutdown()
        cluster.shutdown()


def test_a_node_killed_midway_costs_no_episode_and_doubles_none(cluster, tmp_path, specs_of, toy):
    from coral.campaign.cluster import RayExecutor

    doomed = cluster.add_node(num_cpus=2)
    cluster.wait_for_nodes()
    specs = specs_of(worlds=("w", "slow"), seeds=range(EPISODES // 2))
    store = Store(tmp_path / "out")
    executor = RayExecutor(cluster.address)
    assert executor.jobs == 3
    kill = Killer(cluster, doomed, after=4)
    with store.lock():
        store.open(specs, {})
        summary = run_campaign(store, specs, toy.on_a_node, executor, mix=True, progress=kill)
    assert kill.done
    assert (summary.finished, summary.failed) == (EPISODES, 0)
    records = store.records()
    assert [record["spec"] for record in records] == [spec.to_json() for spec in specs]
    assert len(list((store.folder / "episodes").iterdir())) == EPISODES
    assert all(record["result"]["score"] == record["spec"]["seed"] for record in records)
    assert all((store.run_folder(spec) / "log.txt").read_text() == f"{spec.seed}\n" for spec in specs)
    assert {record["about"]["node"] for record in records} >= {kill.node}, "the node was killed before it did anything"
    assert max(record["about"]["attempts"] for record in records) > 1, "the node was idle when it was killed"
    with store.lock():
        store.open(specs, {})
        again = run_campaign(store, specs, toy.on_a_node, executor, mix=True)
    assert (again.found, again.finished) == (EPISODES, 0)


def test_bad_episodes_are_failures_and_deadly_ones_too(cluster, tmp_path, specs_of, toy):
    from coral.campaign.cluster import RayExecutor

    specs = specs_of(worlds=("w", "raises", "exits"), seeds=(0,))
    store = Store(tmp_path / "out")
    with store.lock():
        store.open(specs, {})
        summary = run_campaign(store, specs, toy.toy, RayExecutor(cluster.address), mix=True)
    assert (summary.finished, summary.failed) == (1, 2)
    told = {record["spec"]["world"]: record for record in store.records()}
    assert told["w"]["result"] == {"score": 0, "threads": "1"}
    assert told["raises"]["message"] == "ValueError: the reef is\nclosed"
    assert told["exits"]["message"].startswith("lost 4 times: ")


def test_no_cluster_is_one_clear_error():
    pytest.importorskip("ray")
    from coral.campaign.cluster import RayExecutor

    with pytest.raises(RunError, match=r"no Ray cluster at 127\.0\.0\.1:1"):
        RayExecutor("127.0.0.1:1")


class Killer:
    """Takes a node away, as a power cut would, once that node and its neighbour have delivered some episodes."""

    def __init__(self, cluster, node, after):
        self.cluster, self.victim, self.after = cluster, node, after
        self.node = node.node_id
        self.seen, self.done = [], False

    def begin(self, total, found, jobs):
        pass

    def ended(self, outcome):
        self.seen.append(outcome.about.get("node"))
        if not self.done and self.seen.count(self.node) >= self.after:
            self.cluster.remove_node(self.victim, allow_graceful=False)
            self.done = True

    def close(self):
        pass
