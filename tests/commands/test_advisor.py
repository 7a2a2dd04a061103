import json

import pytest
from stub import Stub, completion, error

from coral.advisor.prompt import kinds, version
from coral.commands.advisor import AdvisorProbe


def test_all_kinds_are_listed(told):
    assert told("advisor", "show", "list")[1].split() == kinds()


@pytest.mark.parametrize("kind", [kind for kind in kinds() if not kind.startswith("reef-")])
def test_a_prompt_is_shown_whole_and_written_as_it_is_shown(told, tmp_path, kind):
    code, result, _ = told("advisor", "show", kind, "--out", tmp_path / "shown", "--json")
    assert code == 0
    assert (result["kind"], result["version"], result["pictures"]) == (kind, version(kind), [])
    assert result["written"] == [str(tmp_path / "shown" / "prompt.md")]
    assert (tmp_path / "shown" / "prompt.md").read_text(encoding="utf-8") == result["prompt"]
    assert "{{" not in result["prompt"]


def test_a_reef_question_comes_with_the_pictures_of_a_mission(told, tmp_path):
    code, result, _ = told("advisor", "show", "reef-centroid", "--out", tmp_path, "--json")
    assert code == 0
    assert "map" in result["pictures"]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["prompt.md", *(f"{name}.png" for name in result["pictures"])]
    )
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in tmp_path.glob("*.png"))


def test_bad_words_are_one_line(refused, tmp_path):
    assert "did you mean 'reef-centroid'?" in refused("advisor", "show", "reef-centriod")
    (tmp_path / "file").write_text("")
    assert "--out" in refused("advisor", "show", "cost-function", "--out", tmp_path / "file" / "x")


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
    assert (code, err, result["recommended"]) == (0, "", "plain")
    text = AdvisorProbe(model=address).describe(result)
    assert text.startswith(address)
    assert text.endswith("--model.output plain --model.no-pictures")


@pytest.mark.parametrize("flags", [(), ("--json",)])
def test_a_model_that_cannot_be_used_is_told_and_the_command_fails(model, told, flags):
    code, out, err = told("advisor", "probe", model(error(404, "no such model")), *flags)
    assert (code, err) == (1, "")
    assert out["recommended"] is None if flags else "no output mode works" in out


def test_only_a_real_model_can_be_probed(refused):
    assert "a real model" in refused("advisor", "probe", "heuristic")
