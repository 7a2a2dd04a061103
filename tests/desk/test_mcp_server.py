"""The desk for agents: its tools, over a connection in memory and over HTTP."""

import asyncio
import base64
import json
import urllib.error
import urllib.request
from contextlib import asynccontextmanager

import pytest

from coral.desk.inbox import Inbox
from coral.errors import InputError

pytest.importorskip("mcp")
from mcp import Client

from coral.desk.mcp_server import PATH, McpDesk

TOKEN = "a-token-of-our-own"


@pytest.fixture
def desk(tmp_path):
    return McpDesk(Inbox(tmp_path / "inbox"))


def call(desk, name, /, **arguments):
    """The result of one call of a tool."""

    async def called():
        async with Client(desk.server) as client:
            return await client.call_tool(name, arguments)

    return asyncio.run(called())


def refusal(result):
    assert result.is_error
    return result.content[0].text


def test_an_agent_lists_reads_sees_and_answers(desk, ask, case):
    asking = ask(case.reef_question(), case.refused("behind you"))
    (entry,) = call(desk, "list_questions").structured_content["result"]
    assert (entry["id"], entry["kind"], entry["refused_answers"]) == (asking.id, "reef-centroid", 1)
    question = call(desk, "get_question", question_id=asking.id).structured_content
    assert question["rejections"][0]["reason"] == "behind you"
    assert "selected_centroid_index" in question["answer_schema"]["properties"]
    (picture,) = call(desk, "get_picture", question_id=asking.id, name=question["images"][0]).content
    assert base64.b64decode(picture.data) == case.reef_question().pictures[0].png
    answer = {"selected_centroid_index": 7, "reason": ""}
    call(desk, "answer_question", question_id=asking.id, answer=answer, operator=" Ag\nent ")
    assert asking.result().selected_centroid_index == 7
    assert desk.inbox.entries()[0].operator == "Ag ent"
    assert desk.answered == 1
    assert call(desk, "list_questions").structured_content["result"] == []


def test_refusals_say_why(desk, ask):
    asking = ask()
    assert "index" in refusal(call(desk, "answer_question", question_id=asking.id, answer={"index": 9}))
    call(desk, "answer_question", question_id=asking.id, answer={"index": 1}, operator="Ana")
    assert "already answered by Ana" in refusal(
        call(desk, "answer_question", question_id=asking.id, answer={"index": 2})
    )
    assert "no question" in refusal(call(desk, "get_question", question_id="../../etc"))
    assert "no picture" in refusal(call(desk, "get_picture", question_id=asking.id, name="../question.json"))
    assert desk.answered == 1


def test_an_agent_reads_and_changes_the_instruction_of_a_mission(desk):
    folder = desk.inbox.folder
    (folder / "mission-here-1.json").write_text(json.dumps({"state": "running", "instruction": "Find it."}))
    (mission,) = call(desk, "list_missions").structured_content["result"]
    assert (mission["id"], mission["instruction"]) == ("here-1", "Find it.")
    call(desk, "change_instruction", mission_id="here-1", instruction="Find the net.")
    told = json.loads((folder / "instruction-here-1.json").read_text())
    assert told == {"instruction": "Find the net.", "operator": "an agent"}
    assert "no mission" in refusal(call(desk, "change_instruction", mission_id="x", instruction="Find it."))
    assert "some words" in refusal(call(desk, "change_instruction", mission_id="here-1", instruction=" "))


def test_a_wait_ends_with_the_first_question(desk, ask, monkeypatch):
    async def waited():
        waiting = asyncio.create_task(desk.list_questions(60.0))
        monkeypatch.setattr("coral.desk.mcp_server._LOOK_S", 0.0)
        await asyncio.sleep(0)
        assert not waiting.done()
        asking = ask()
        return asking, await waiting

    asking, found = asyncio.run(waited())
    assert [entry["id"] for entry in found] == [asking.id]


@asynccontextmanager
async def connected(url):
    import httpx2
    from mcp.client.streamable_http import streamable_http_client

    async with (
        httpx2.AsyncClient(headers={"Authorization": f"Bearer {TOKEN}"}) as http,
        Client(streamable_http_client(url, http_client=http)) as client,
    ):
        yield client


def test_an_agent_connects_over_http(desk, ask):
    asking = ask()

    async def listed(server):
        async with connected(f"http://127.0.0.1:{server.access.port}{PATH}") as client:
            return await client.call_tool("list_questions", {})

    with desk.serve_http("127.0.0.1", 0, TOKEN) as server:
        found = asyncio.run(listed(server)).structured_content["result"]
        with pytest.raises(urllib.error.HTTPError, match="401"):
            urllib.request.urlopen(f"http://127.0.0.1:{server.access.port}{PATH}")
    assert [entry["id"] for entry in found] == [asking.id]


def test_a_port_in_use_and_a_poor_token_are_one_line(desk, server):
    with pytest.raises(InputError, match=r"--port: found port \d+ in use"):
        desk.serve_http("127.0.0.1", server.access.port, "")
    with pytest.raises(InputError, match="token: found"):
        desk.serve_http("127.0.0.1", 0, "short")
