"""Marked `ray`: a real cluster of two nodes on this machine, one of which is killed midway (make test-ray)."""

import sys
from pathlib import Path
from types import ModuleType

import pytest

from coral.campaign.campaign import run_campaign
from coral.campaign.cluster import RayExecutor, pack, unpack
from coral.campaign.store import Store
from coral.errors import InputError, RunError

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


@pytest.mark.ray
def test_a_node_killed_midway_costs_no_episode_and_doubles_none(cluster, tmp_path, specs_of, toy):
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


@pytest.mark.ray
def test_bad_episodes_are_failures_and_deadly_ones_too(cluster, tmp_path, specs_of, toy):
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


def test_without_ray_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(InputError, match="--executor: found ray, which is not installed, expected local, or"):
        RayExecutor("auto")


@pytest.mark.parametrize(
    ("address", "error", "said"),
    [
        ("127.0.0.1:1", RunError, r"^no Ray cluster at 127\.0\.0\.1:1: Connection refused"),
        ("ray://127.0.0.1:1", RunError, r"^no Ray cluster at ray://127\.0\.0\.1:1"),
        ("127.0.0.1:99999", RunError, r"^no Ray cluster at 127\.0\.0\.1:99999"),
        ("nowhere", InputError, r"--address: found 'nowhere', expected auto, HOST:PORT"),
        ("host:port", InputError, r"--address: found 'host:port'"),
        (":6379", InputError, r"--address: found ':6379'"),
    ],
)
def test_an_address_at_which_nothing_listens_is_one_clear_error_at_once(monkeypatch, address, error, said):
    monkeypatch.setitem(sys.modules, "ray", ModuleType("ray"))
    with pytest.raises(error, match=said):
        RayExecutor(address)


def test_what_a_node_wrote_comes_back_in_place_of_what_was_there(tmp_path):
    there, here = tmp_path / "there", tmp_path / "runs" / "here"
    (there / "frames").mkdir(parents=True)
    (there / "frames" / "1.png").write_bytes(bytes(range(256)))
    (there / "log.txt").write_text("a")
    here.mkdir(parents=True)
    (here / "old.txt").write_text("of an earlier attempt")
    unpack(pack(there), here)
    assert sorted(path.name for path in here.rglob("*")) == ["1.png", "frames", "log.txt"]
    assert (here / "frames" / "1.png").read_bytes() == bytes(range(256))
    unpack(pack(tmp_path / "nothing"), here)
    assert not here.exists()


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
