"""The desk for agents: its tools, over a connection in memory and over HTTP."""

import asyncio
import base64
import threading
from contextlib import asynccontextmanager

import pytest

from coral.access import Access
from coral.desk.inbox import Inbox
from coral.errors import InputError

pytest.importorskip("mcp")
from mcp import Client

from coral.desk.mcp_server import PATH, McpDesk, guarded

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


@pytest.mark.parametrize(
    ("headers", "path", "status"),
    [
        ({"host": "127.0.0.1:80"}, PATH, 401),
        ({"host": "127.0.0.1:80", "authorization": "Bearer a-token-of-others"}, PATH, 401),
        ({"host": "evil.com:80", "authorization": f"Bearer {TOKEN}"}, PATH, 421),
        ({"host": "127.0.0.1:80", "origin": "http://evil.com", "authorization": f"Bearer {TOKEN}"}, PATH, 403),
        ({"host": "127.0.0.1:80", "authorization": f"Bearer {TOKEN}"}, "/", 404),
        ({"host": "127.0.0.1:80", "authorization": f"Bearer {TOKEN}"}, PATH, 200),
    ],
)
def test_http_follows_the_rules_of_the_page(headers, path, status):
    sent = []

    async def app(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def send(message):
        sent.append(message)

    scope = {
        "type": "http",
        "method": "POST",
        "path": path,
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
    }
    asyncio.run(guarded(app, Access("127.0.0.1", 80, TOKEN))(scope, None, send))
    assert sent[0]["status"] == status


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
    asking, opened, places = ask(), threading.Event(), []

    def tell(access):
        places.append(access)
        opened.set()

    async def listed():
        async with connected(f"http://127.0.0.1:{places[0].port}{PATH}") as client:
            return await client.call_tool("list_questions", {})

    thread = threading.Thread(target=desk.serve_http, args=("127.0.0.1", 0, TOKEN, tell))
    thread.start()
    try:
        assert opened.wait(30)
        found = asyncio.run(listed()).structured_content["result"]
    finally:
        desk.stop()
        thread.join()
    assert [entry["id"] for entry in found] == [asking.id]


def test_a_port_in_use_and_a_poor_token_are_one_line(desk, server):
    with pytest.raises(InputError, match=r"--port: found port \d+ in use"):
        desk.serve_http("127.0.0.1", server.access.port, "", print)
    with pytest.raises(InputError, match="--token"):
        desk.serve_http("127.0.0.1", 0, "short", print)
