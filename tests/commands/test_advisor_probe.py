import json

import pytest
from stub import Stub, completion, error

from coral.commands.advisor_probe import AdvisorProbe


@pytest.fixture
def model():
    """Makes the address of a model that gives one reply for ever."""
    servers = []

    def make(reply):
        servers.append(Stub(reply))
        return f"local:{servers[-1].url}#m"

    yield make
    for server in servers:
        server.close()


def able(body):
    """A model without eyes that obeys in plain words alone."""
    content = body["messages"][-1]["content"]
    if not isinstance(content, str):
        return error(400, "this model takes no images")
    if "tools" in body or "response_format" in body:
        return error(400, "plain words only")
    return completion(json.dumps({"number": int(content.split("which is ")[1][0]), "color": "none"}))


def test_what_an_endpoint_can_do_is_told_in_words_and_in_json(model, told):
    address = model(able)
    code, result, err = told("advisor", "probe", address, "--json")
    assert (code, err, result["usable"], result["recommended"]) == (0, "", True, "plain")
    text = AdvisorProbe(model=address).describe(result)
    assert text.startswith(address)
    assert text.endswith("--model.output plain --model.no-pictures")


@pytest.mark.parametrize("flags", [(), ("--json",)])
def test_a_model_that_cannot_be_used_is_told_and_the_command_fails(model, told, flags):
    code, out, err = told("advisor", "probe", model(error(404, "no such model")), *flags)
    assert (code, err) == (1, "")
    assert "no output mode works" in (json.dumps(out) if flags else out)


def test_only_a_real_model_can_be_probed(refused):
    assert "a real model" in refused("advisor", "probe", "heuristic")
