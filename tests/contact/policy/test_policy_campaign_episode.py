"""A served policy in a campaign: from the connection to the metrics, and what says nothing of the policy."""

import dataclasses

import numpy as np
import pytest

from coral.contact.episode.cfg import EpisodeCfg
from coral.contact.episode.policy_cfg import LiberoCfg, PolicyCfg
from coral.contact.policy.address import Address
from coral.contact.policy.policy_campaign_episode import run_policy_episode, serving
from coral.contact.tasks import load_task
from coral.errors import RunError

SHORT = load_task("pick-box").model_copy(update={"time_limit_s": 0.2})


@pytest.fixture
def run(serve, patient, tmp_path):
    """An episode with the policy that a server answers for; returns the metrics and the server."""

    def start(*answer):
        server = serve(*answer)
        cfg = EpisodeCfg(policy=PolicyCfg(libero=LiberoCfg(pixels=16), client=patient))
        address = Address("fake", server.url)
        return run_policy_episode(SHORT, cfg, tmp_path / "run", world="hand", address=address, seed=0), server

    return start


def test_the_result_has_the_world_and_the_run_no_report(run, tmp_path):
    result, server = run()
    assert (result["end_reason"], result["evaluation_world"], result["strategy"]) == ("timeout", "hand", "fake")
    assert result["policy_calls"] == len(server.asked) == 1
    assert (tmp_path / "run" / "metrics.json").is_file()
    assert not (tmp_path / "run" / "report.html").exists()


def test_a_bad_answer_is_a_result_of_the_policy(run):
    result, _ = run(lambda k, seen: {"actions": np.zeros((10, 3))})
    assert (result["success"], result["end_reason"]) == (False, "policy: bad-actions")


def test_a_server_that_hangs_up_says_nothing_of_the_policy(run):
    with pytest.raises(RunError, match="policy: closed"):
        run(lambda k, seen: ConnectionError)


def test_no_server_is_told_by_its_reason(hasty):
    nobody = Address("fake", "ws://127.0.0.1:1")
    with pytest.raises(RunError, match=r"^no policy: unreachable"), serving(nobody, hasty):
        pytest.fail("there is a server")


def test_the_client_leaves_the_server_whatever_happens(serve, patient):
    server = serve()
    address = Address("fake", server.url)
    clients = []

    def fail():
        with serving(address, patient) as client:
            clients.append(client)
            client.infer({"prompt": "x"})
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert clients[0]._line is None
    with serving(address, dataclasses.replace(patient, attempts=1)) as client:
        assert client.infer({"prompt": "y"})["actions"].shape == (10, 7)
    assert server.connections == 2
