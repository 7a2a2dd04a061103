import base64
import json

import cv2
import numpy as np
import pytest

from coral.advisor.model_cfg import ModelCfg
from coral.advisor.probe import probe
from coral.errors import InputError

CFG = ModelCfg(attempt_timeout_s=5.0, deadline_s=5.0)


def model(stub, *, native=True, tool=True, eyes=True):
    """A server that obeys, as far as it can."""

    def reply(body):
        if "response_format" in body and body["response_format"]["type"] == "json_schema" and not native:
            return stub.error(500, "json_schema is not supported")
        if "tools" in body and not tool:
            return stub.completion("I would call a tool if I had one")
        content = body["messages"][-1]["content"]
        parts = [{"type": "text", "text": content}] if isinstance(content, str) else content
        images = [p for p in parts if p["type"] == "image_url"]
        color = "none"
        if images:
            if not eyes:
                return stub.error(400, "this model takes no images")
            data = np.frombuffer(base64.b64decode(images[0]["image_url"]["url"].split(",")[1]), np.uint8)
            color = ["blue", "green", "red"][int(np.argmax(cv2.imdecode(data, cv2.IMREAD_COLOR)[0, 0]))]
        number = int(parts[0]["text"].split("which is ")[1][0])
        text = json.dumps({"number": number, "color": color})
        return stub.completion(None, tool=text) if "tools" in body else stub.completion(text)

    return reply


def look(stub, **abilities):
    return probe(f"local:{stub(model(stub, **abilities)).url}#m", CFG)


def test_able_endpoint(stub):
    report = look(stub)
    assert {mode: finding.says for mode, finding in report.modes.items()} == dict.fromkeys(
        ("native", "tool", "prompted", "plain"), "ok"
    )
    assert report.pictures.says == "named 3 colours of 3"
    assert report.lines()[-1] == f"  use it with: --advisor '{report.advisor}' --model.output native"


def test_endpoint_with_gaps(stub):
    report = look(stub, native=False, tool=False, eyes=False)
    assert "http-500" in report.modes["native"].says
    assert "not-json" in report.modes["tool"].says
    assert report.recommended == "prompted"
    assert "takes no images" in report.pictures.says
    assert report.lines()[-1].endswith("--model.output prompted --model.no-pictures")


def test_endpoint_that_refuses_the_key_is_asked_once(stub):
    server = stub(stub.error(401))
    report = probe(f"local:{server.url}#m", CFG)
    assert len(server.requests) == 1
    assert report.recommended is None
    assert report.lines()[-1] == "  no output mode works"


def test_only_real_models_are_probed():
    with pytest.raises(InputError, match="a real model"):
        probe("heuristic")
