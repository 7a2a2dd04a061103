"""Runs `coral` commands in forks of one process that has imported the program, so that they share the imports' time.

The words, the folder, the environment, the three streams and the exit code are the caller's own; only the imports are
done before. As a program: `fork_server.py N`, where N is the descriptor of a listening Unix socket.
"""

import gc
import importlib
import json
import os
import pkgutil
import signal
import socket
import sys


def import_the_program() -> None:
    """Import every command, and what most of them import late."""
    importlib.import_module("coral.cli")  # first, as in the installed command: it limits the libraries' threads
    import coral.commands

    for module in pkgutil.iter_modules(coral.commands.__path__, "coral.commands."):
        importlib.import_module(module.name)
    for name in ("matplotlib.figure", "matplotlib.backends.backend_agg", "coral.view.report", "coral.view.video"):
        importlib.import_module(name)


def serve(listening: socket.socket) -> int:
    """Fork for every client, forever; return the exit code in the fork only."""
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    import_the_program()
    assert len(os.listdir("/proc/self/task")) == 1, "a fork would lose a thread"
    gc.freeze()
    while True:
        line, _ = listening.accept()
        if os.fork() == 0:
            listening.close()
            return answer(line)
        line.close()


def answer(line: socket.socket) -> int:
    """Be the program for one client, in a process of its own."""
    from coral.cli import main

    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    _, streams, _, _ = socket.recv_fds(line, 1, 3)
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
        os.close(stream)
    words, folder, environment = json.loads(line.makefile("rb").readline())
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    sys.argv[:] = ["coral", *words]
    code = 1
    try:
        code = main(words)
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(bool(end.code))
    finally:
        os.write(line.detach(), b"%d\n" % code)  # left open: the client waits until this process has ended
    return code


if __name__ == "__main__":
    sys.exit(serve(socket.socket(fileno=int(sys.argv[1]))))
