import asyncio
import gzip

import httpx2
import pytest

from coral.advisor.wire import ReplyTooLarge, caused_by, http_client


def fetched(server, limit):
    async def get():
        async with http_client(limit, 5.0) as client:
            return (await client.post(server.url, json={})).content

    return asyncio.run(get())


def test_a_reply_of_the_limit_is_read_and_one_byte_more_is_cut_off(stub):
    server = stub((200, {}, b"x" * 1000))
    assert fetched(server, 1000) == b"x" * 1000
    with pytest.raises(ReplyTooLarge, match="more than 999 bytes"):
        fetched(server, 999)


def test_no_compression_is_asked_for_and_a_compressed_reply_gets_a_twentieth(stub):
    packed = gzip.compress(b"x" * 5000, mtime=0)
    server = stub((200, {"Content-Encoding": "gzip"}, packed))
    assert fetched(server, 20 * len(packed)) == b"x" * 5000
    assert server.requests[0]["headers"]["accept-encoding"] == "identity"
    with pytest.raises(ReplyTooLarge):
        fetched(server, 20 * len(packed) - 20)


def test_the_cause_of_an_error_is_found_however_deep_it_lies():
    outer = RuntimeError()
    outer.__cause__ = ValueError()
    outer.__cause__.__context__ = ReplyTooLarge("x")
    assert caused_by(outer, ReplyTooLarge)
    assert caused_by(outer, httpx2.TransportError)
    assert not caused_by(outer, KeyError)
    outer.__cause__.__context__ = outer  # a circle ends too
    assert not caused_by(outer, KeyError)


def test_a_connection_is_waited_for_three_seconds_at_most():
    for timeout_s, connect_s in ((45.0, 3.0), (2.0, 2.0)):
        timeout = http_client(1000, timeout_s).timeout
        assert (timeout.connect, timeout.read) == (connect_s, timeout_s)
