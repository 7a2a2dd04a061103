"""An OpenAI-compatible chat server on 127.0.0.1 that fails in every way a real one does, in the order told."""

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer


def completion(text, finish="stop", tool=None, refusal=None):
    message = {"role": "assistant", "content": text}
    if tool is not None:
        message = {
            "role": "assistant",
            "content": None,
            "tool_calls": [{"id": "1", "type": "function", "function": {"name": "answer", "arguments": tool}}],
        }
    if refusal is not None:
        message = {"role": "assistant", "content": None, "refusal": refusal}
    return (
        200,
        {},
        json.dumps(
            {
                "id": "1",
                "object": "chat.completion",
                "created": 1,
                "model": "stub",
                "choices": [
                    {"index": 0, "finish_reason": "tool_calls" if tool is not None else finish, "message": message}
                ],
                "usage": {"prompt_tokens": 100, "completion_tokens": 10, "total_tokens": 110},
            }
        ).encode(),
    )


def error(status, message="no", **headers):
    return (
        status,
        {k.replace("_", "-"): v for k, v in headers.items()},
        json.dumps({"error": {"message": message, "type": "x"}}).encode(),
    )


DROP = "drop"
SILENCE = "silence"


class Stub:
    def __init__(self, *replies):
        self.replies = list(replies)
        self.requests = []
        self.hung_up = threading.Event()
        self.release = threading.Event()
        stub = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def do_POST(self):
                body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                headers = {key.lower(): value for key, value in self.headers.items()}
                stub.requests.append({"body": body, "headers": headers, "path": self.path})
                reply = stub.replies.pop(0) if len(stub.replies) > 1 else stub.replies[0]
                if callable(reply):
                    reply = reply(body)
                if reply == DROP:
                    self.close_connection = True
                    self.connection.close()
                    return
                if reply == SILENCE:
                    # The client is expected to hang up; the read then returns nothing.
                    self.connection.settimeout(20)
                    try:
                        if not self.connection.recv(1):
                            stub.hung_up.set()
                    except OSError:
                        pass
                    self.close_connection = True
                    return
                status, headers, data = reply
                try:
                    self.send_response(status)
                    for key, value in {"Content-Type": "application/json", **headers}.items():
                        self.send_header(key, value)
                    self.send_header("Content-Length", str(len(data)))
                    self.end_headers()
                    self.wfile.write(data)
                except OSError:
                    stub.hung_up.set()
                    self.close_connection = True

            def log_message(self, *_):
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_port}/v1"
        self.thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
        self.thread.start()

    def close(self):
        self.server.shutdown()
        self.server.server_close()
