import json

import pytest
from stub import Stub, completion

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.models import ModelAdvisor
from coral.advisor.rules import RuleAdvisor
from coral.campaign.spec import NO_ADVISOR, grid
from coral.campaign.store import Store
from coral.commands.preflight import preflight_campaign
from coral.errors import InputError


@pytest.fixture
def model():
    """A model's server that answers the small question."""
    server = Stub(completion(json.dumps({"number": 7, "color": "none"})))
    yield server
    server.close()


@pytest.fixture
def refusing():
    """A model's server that does not."""
    server = Stub(completion("I am sorry, I cannot help with that."))
    yield server
    server.close()


@pytest.fixture
def asked(tmp_path, model, refusing):
    """Asks the models of a campaign's episodes; returns the advisors that were made for it."""
    cfg = ModelCfg(attempt_timeout_s=5.0, deadline_s=5.0, backoff_s=0.0, max_retries=0, format_repairs=0)

    def ask(specs, **options):
        made = []

        def make(name):
            made.append(name)
            servers = {"good": model, "bad": refusing}
            return ModelAdvisor.local(servers[name].url, name, cfg) if name in servers else RuleAdvisor({})

        preflight_campaign(Store(tmp_path / "out"), specs, make, pictures=False, quiet=True, **options)
        return made

    return ask


def specs(*advisors, alone=()):
    return grid("toy", variants=["a"], worlds=["w"], seeds=[0, 1], advisors=advisors, alone=alone)


def test_each_model_is_asked_once_and_nothing_is_written(asked, model, tmp_path):
    assert asked(specs("good", "rules")) == ["good", "rules"]
    assert len(model.requests) == 1
    assert not (tmp_path / "out").exists()


def test_a_model_that_cannot_be_used_refuses_the_campaign(asked):
    with pytest.raises(InputError, match=r"--advisors.*no answer"):
        asked(specs("good", "bad"))


def test_episodes_that_ask_nobody_need_no_model(asked, model):
    (one, _) = alone = specs("good", alone=["a"])
    assert one.advisor == NO_ADVISOR
    assert asked(alone) == []
    assert model.requests == []


def test_only_models_of_pending_episodes_are_asked(asked, tmp_path):
    wanted = specs("bad")
    store = Store(tmp_path / "out")
    with store.lock():
        store.open(wanted, {})
        store.finish(wanted[0], {}, {})
        store.fail(wanted[1], "no", "", {})
    assert asked(wanted) == []
    with pytest.raises(InputError, match="no answer"):
        asked(wanted, retry_failed=True)
