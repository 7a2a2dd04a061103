import base64
import json
import socket

import cv2
import numpy as np
import pytest

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.models import ModelAdvisor
from coral.advisor.preflight import model_of, preflight, probe
from coral.cli import main
from coral.erring.sloppy import Rates, SloppyAdvisor
from coral.errors import InputError

CFG = ModelCfg(attempt_timeout_s=5.0, deadline_s=5.0, backoff_s=0.01)
FLAGS = ["--quiet", "--model.backoff-s", "0.01", "--model.attempt-timeout-s", "5"]


def seeing(stub, *, eyes=True):
    """A server that answers the small question; without eyes it guesses the colour."""

    def reply(body):
        content = body["messages"][-1]["content"]
        parts = [{"type": "text", "text": content}] if isinstance(content, str) else content
        color = "none" if '"none"' in parts[0]["text"] else "red"
        for part in parts if eyes else ():
            if part["type"] == "image_url":
                data = np.frombuffer(base64.b64decode(part["image_url"]["url"].split(",")[1]), np.uint8)
                blue, green, red = cv2.imdecode(data, cv2.IMREAD_COLOR)[0, 0]
                color = "yellow" if min(green, red) > 150 > blue else "black"
        return stub.completion(json.dumps({"number": 7, "color": color}))

    return reply


def advisor(url, cfg=CFG):
    return ModelAdvisor.local(url, "m", cfg)


@pytest.fixture
def dead():
    """An address at which nothing listens."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        yield f"http://127.0.0.1:{taken.getsockname()[1]}/v1"


@pytest.mark.parametrize("pictures", [True, False])
def test_a_model_that_answers_passes_with_one_request(stub, pictures):
    server = stub(seeing(stub))
    preflight(advisor(server.url), pictures=pictures)
    assert len(server.requests) == 1
    assert ("image_url" in json.dumps(server.requests[0]["body"])) == pictures


def test_the_model_inside_an_advisor_that_errs_is_asked(stub):
    inside = advisor(stub(stub.error(404)).url)
    spoilt = SloppyAdvisor(SloppyAdvisor(inside, Rates(), None, ()), Rates(), None, ())
    assert model_of(spoilt) is inside
    with pytest.raises(InputError, match="no-such-model"):
        preflight(spoilt, pictures=False)


@pytest.mark.parametrize(
    ("reply", "complaint"),
    [
        (lambda stub: stub.error(404, "no such model"), "no-such-model: .*no such model"),
        (lambda stub: stub.error(401), "key-refused"),
        (lambda stub: stub.error(400, "this model takes no images"), "takes no images.*--model.no-pictures"),
        (lambda stub: seeing(stub, eyes=False), "calls a yellow picture red.*--model.no-pictures"),
        (lambda stub: stub.completion("I am sorry, I cannot help with that"), "its reply is no answer, refusal"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(stub, reply, complaint):
    with pytest.raises(InputError, match=complaint) as refused:
        preflight(advisor(stub(reply(stub)).url), pictures=True)
    assert "\n" not in str(refused.value)
    assert "--no-preflight" in str(refused.value)


COMMANDS = [
    ["reef", "run", "l1", "--advisor"],
    ["reef", "bench", "--worlds", "l1", "--variants", "full,lawnmower", "--advisors"],
    ["contact", "run", "pick-box", "--variant", "full", "--world", "hand", "--advisor"],
    ["contact", "bench", "--tasks", "pick-box", "--variants", "full", "--worlds", "hand", "--advisors"],
]


@pytest.mark.parametrize("words", COMMANDS)
def test_a_dead_address_is_refused_before_anything_is_written(dead, stub, tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    assert main([*words, f"local:{dead}#m", *FLAGS, "--out", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "connection" in err
    assert "--no-preflight" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", COMMANDS)
def test_a_model_that_refuses_is_refused_before_anything_is_written(stub, tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    server = stub(stub.completion("I am sorry, I cannot help with that"))
    assert main([*words, f"local:{server.url}#m", *FLAGS, "--out", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "its reply is no answer, refusal" in err
    assert "--no-preflight" in err
    assert server.requests
    assert list(tmp_path.iterdir()) == []


def test_a_dead_address_is_known_without_the_client_library(dead, monkeypatch):
    monkeypatch.setattr(ModelAdvisor, "answer", None)
    with pytest.raises(InputError, match="nothing answers at that address"):
        preflight(advisor(dead), pictures=False)


def test_variants_that_ask_nobody_need_no_model(dead, tmp_path, capsys):
    words = ["reef", "run", "l1", "--variant", "rule-based", "--advisor", f"local:{dead}#m", *FLAGS, "--json"]
    short = ["--cfg.time-limit-s", "0.3", "--cfg.record.no-report", "--cfg.record.no-frames"]
    assert main([*words, *short, "--out", str(tmp_path / "run")]) == 0


def test_with_the_preflight_skipped_the_last_line_says_who_decided(dead, stub, tmp_path, capsys):
    words = ["reef", "run", "l1", "--advisor", f"local:{dead}#m", *FLAGS, "--no-preflight", "--cfg.latency", "fixed:1"]
    words += ["--cfg.time-limit-s", "8", "--cfg.record.no-frames", "--model.max-retries", "0"]
    assert main([*words, "--out", str(tmp_path / "run")]) == 0
    out, err = capsys.readouterr()
    metrics = json.loads((tmp_path / "run" / "metrics.json").read_text())
    by = metrics["decided_by"]
    assert (by["advisor"], by["fallback"]) == (0, sum(by.values()))
    said = f"he advisor decided 0 of {by['fallback']} goals, the fallback's rules {by['fallback']}"
    assert out.rstrip().splitlines()[-1] == f"t{said}"
    assert f"T{said}".replace("'", "&#39;") in (tmp_path / "run" / "report.html").read_text()
    assert (
        "the advisor did not decide (every answer was refused): the fallback's rules decide (--fallback rules)" in err
    )


@pytest.mark.slow
def test_in_a_bench_nobody_decides_for_a_dead_model(dead, stub, tmp_path, capsys):
    words = ["reef", "bench", "--worlds", "l1", "--variants", "full", "--advisors", f"local:{dead}#m", *FLAGS]
    words += ["--no-preflight", "--cfg.latency", "fixed:1", "--cfg.time-limit-s", "8", "--model.max-retries", "0"]
    assert main([*words, "--out", str(tmp_path / "out"), "--json"]) == 0
    tables = {table["name"]: table["rows"] for table in json.loads(capsys.readouterr().out)["results"]}
    row = tables["Who decided"][0]
    assert row["variant"] == "CORAL (full) §"
    assert (row["by advisor"], row["by fallback"]) == ("0 (0 %)", f"{row['decisions']} (100 %)")
    assert "left undecided by the advisor" in (tmp_path / "out" / "tables.md").read_text()


def model(stub, *, native=True, tool=True, eyes=True):
    """A server that obeys, as far as it can."""
    see = seeing(stub)

    def reply(body):
        if body.get("response_format", {}).get("type") == "json_schema" and not native:
            return stub.error(500, "json_schema is not supported")
        if "tools" in body:
            return stub.completion(None, tool='{"number": 7, "color": "none"}') if tool else stub.completion("A tool?")
        if "image_url" in json.dumps(body) and not eyes:
            return stub.error(400, "this model takes no images")
        return see(body)

    return reply


def test_what_an_able_endpoint_can_do_is_found(stub):
    report = probe(f"local:{stub(model(stub)).url}#m", CFG)
    assert {mode: found["says"] for mode, found in report["modes"].items()} == dict.fromkeys(
        ("native", "tool", "prompted", "plain"), "ok"
    )
    assert (report["pictures"]["works"], report["recommended"]) == (True, "native")


def test_gaps_of_an_endpoint_are_named(stub):
    report = probe(f"local:{stub(model(stub, native=False, tool=False, eyes=False)).url}#m", CFG)
    assert "http-500" in report["modes"]["native"]["says"]
    assert "not-json" in report["modes"]["tool"]["says"]
    assert report["recommended"] == "prompted"
    assert "takes no images" in report["pictures"]["says"]


def test_an_endpoint_that_refuses_the_key_is_probed_once(stub):
    server = stub(stub.error(401))
    report = probe(f"local:{server.url}#m", CFG)
    assert (len(server.requests), report["recommended"], report["pictures"]) == (1, None, None)
