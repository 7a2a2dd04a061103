"""The sandboxed process: it reads requests, evaluates programs over arrays in shared memory, and can do nothing else.

Messages are JSON with a length prefix, never pickles. `worker.py` starts it with pipes as standard input and output;
the arrays lie in an unnamed file whose descriptor it inherits. A text becomes a program in `parse.py` and `program.py`.
"""

from __future__ import annotations

import json
import math
import mmap
import os
import resource
import signal
import struct
import sys
import unicodedata  # noqa: F401  (Python's parser needs it for names such as α, and could not load it once confined)
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coral.contact.cost.context import Context, Quantity
from coral.contact.cost_program import seccomp
from coral.contact.cost_program.errors import CostError
from coral.contact.cost_program.program import CostProgram

HEADER = struct.Struct("<I")
LONGEST_MESSAGE = 1 << 20
KEPT = 64
"""Maximum number of loaded programs: a plan's costs and conditions, and those of the plans checked before it."""
Request = dict[str, Any]
Reply = dict[str, Any]

WARM_UP = """
def state_cost(self):
    d = np.linalg.norm(self.ee_pos) + math.acos(2.0 + self.time)
    cost = 0.0
    if d > 0.1:
        cost += d  # away
    return cost
"""


def read_message(descriptor: int) -> Request | None:
    """Read the next message; None at the end of the stream."""
    head = _read(descriptor, HEADER.size)
    if head is None:
        return None
    size = HEADER.unpack(head)[0]
    body = _read(descriptor, size) if size <= LONGEST_MESSAGE else None
    return None if body is None else json.loads(body)


def _read(descriptor: int, size: int) -> bytes | None:
    found = b""
    while len(found) < size:
        piece = os.read(descriptor, size - len(found))
        if not piece:
            return None
        found += piece
    return found


def write_message(descriptor: int, message: Reply) -> None:
    """Write one message."""
    body = json.dumps(message).encode()
    body = HEADER.pack(len(body)) + body
    while body:
        body = body[os.write(descriptor, body) :]


def quantities(schema: dict[str, list[Any]]) -> dict[str, Quantity]:
    """Decode a schema from its message."""
    return {
        name: Quantity(int(size), "", "", bool(truth), bool(constant))
        for name, (size, truth, constant) in schema.items()
    }


class Sandbox:
    """The loaded programs, and the memory shared with the parent."""

    def __init__(self, memory: NDArray[np.float64]) -> None:
        self.memory = memory
        self.programs: dict[int, CostProgram] = {}

    def answer(self, request: Request) -> Reply:
        """Answer one request; an error is an answer too."""
        try:
            if request["op"] == "load":
                return self._load(request)
            return self._run(request)
        except CostError as error:
            return {"error": [error.code, error.text, error.line, error.shown]}
        except MemoryError:
            return {"error": ["memory", "the program needs too much memory", 0, ""]}
        except Exception as error:
            return {"error": ["internal", f"the interpreter failed with {type(error).__name__}", 0, ""]}

    def _load(self, request: Request) -> Reply:
        program = CostProgram(request["source"], quantities(request["schema"]))
        dropped = list(self.programs)[: max(0, len(self.programs) + 1 - KEPT)]  # least recently used
        for number in dropped:
            del self.programs[number]
        self.programs[int(request["id"])] = program
        return {"reads": program.reads, "source": program.source, "dropped": dropped}

    def _run(self, request: Request) -> Reply:
        number = int(request["id"])
        program = self.programs[number] = self.programs.pop(number)  # most recently used
        values = {
            name: self._view(offset, [*([size] if size else []), *shape], bool(size))
            for name, offset, shape, size in request["inputs"]
        }
        k, h = request["shape"]
        terms = program(Context(values, (k, h)))
        end = int(request["output"])
        for term in terms.values():
            end = self._put(end, term)
        return {"terms": list(terms)}

    def _view(self, offset: int, shape: list[int], vector: bool) -> NDArray[np.float64]:
        view = self.memory[offset : offset + math.prod(shape)].reshape(shape)
        view.flags.writeable = False
        return np.moveaxis(view, 0, -1) if vector else view

    def _put(self, offset: int, values: NDArray[np.float64]) -> int:
        end = offset + values.size
        if end > self.memory.size:
            raise CostError("memory", "the terms of this batch do not fit into the shared memory")
        self.memory[offset:end] = values.ravel()
        return end


def _refuse_files(event: str, _: tuple[object, ...]) -> None:
    """Raise a Python error on file access, before the filter would kill the process.

    Python's parser opens the file of a faulty program to quote its line, and ignores this error.
    """
    if event in ("open", "import"):
        raise PermissionError(f"a cost may not {event} anything")


def confine(headroom_bytes: int) -> bool:
    """Drop all privileges that costs do not need; return whether system calls are filtered too."""
    filters = seccomp.available()
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    limits = {
        resource.RLIMIT_AS: used + headroom_bytes,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_FSIZE: 0,
        resource.RLIMIT_NPROC: 0,
        resource.RLIMIT_NOFILE: 0,
    }
    for which, value in limits.items():
        resource.setrlimit(which, (value, value))
    sys.addaudithook(_refuse_files)
    return filters and seccomp.install()


def serve(answer: Callable[[Request], Reply]) -> None:
    """Answer requests until the parent closes the pipe. Each may take `cpu_s` of processor time."""
    while (request := read_message(0)) is not None:
        signal.setitimer(signal.ITIMER_PROF, float(request["cpu_s"]))  # its signal ends the process
        reply = answer(request)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        write_message(1, reply)


def main() -> None:
    """Run the process; its arguments are the descriptor and size of the shared memory, and the bytes it may use."""
    descriptor, size, headroom = (int(argument) for argument in sys.argv[1:4])
    shared = mmap.mmap(descriptor, size)
    os.close(descriptor)
    sandbox = Sandbox(np.frombuffer(shared, dtype=np.float64))
    warm = {"op": "load", "id": 0, "source": WARM_UP, "schema": {"ee_pos": [3, 0, 0], "time": [0, 0, 0]}}
    sandbox.answer(warm)
    sandbox.answer(
        {
            "op": "run",
            "id": 0,
            "shape": [1, 1],
            "output": 16,
            "inputs": [["ee_pos", 0, [1, 1], 3], ["time", 8, [1, 1], 0]],
        }
    )
    sandbox.programs.clear()
    filtered = confine(headroom) if sys.platform.startswith("linux") else False
    write_message(1, {"ready": True, "filtered": filtered})
    serve(sandbox.answer)


if __name__ == "__main__":
    main()
