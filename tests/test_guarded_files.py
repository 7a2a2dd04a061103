"""The finder: files go through `coral.foreign_file` and `coral.file_writer`, or the reason stands here."""

import ast
import re
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src/coral"
GUARDED = {"foreign_file.py", "file_writer.py"}
"""The opener and the writer themselves."""
EXCEPTIONS = {
    "advisor/parse.py": "a model's reply, whose brackets it has counted; strict=False takes line ends inside texts",
    "campaign/cluster.py": "a run folder that a worker of the same campaign packed, unpacked with filter='data'",
    "campaign/episode.py": "no file: makes its own result plain",
    "contact/cost_program/sandbox.py": "the confined process: a request of its parent; its own memory in /proc",
    "contact/libero/object_model.py": "text of read_text; expat itself bounds what entities expand to",
    "contact/perception/foundationpose_server.py": "runs alone on another machine, without this package; has its bound",
    "contact/franka/shared_block.py": "no file: memory of processes that this program started, as their pipes are",
    "contact/franka/double_scene.py": "no file: XML that MuJoCo has just written",
    "interface/result.py": "copies the caller's own run to a new or empty folder",
    "reef/recordings/recorded_pictures.py": "a temporary folder of its own",
    "reef/sea/saved_survey.py": "writes into memory",
    "yaml_file.py": "text of read_text, counted before anything is built of it",
}
"""Modules that touch files or parse bytes otherwise, each with its reason."""
METHODS = {"read_text", "read_bytes", "write_text", "write_bytes", "open"}
NOT_FILES = {"store", "gate", "reader"}
"""Names of values that are opened and are no paths."""
CALLS = {
    "np": {"load", "save", "savez", "savez_compressed", "loadtxt", "genfromtxt", "fromfile", "memmap", "savetxt"},
    "cv2": {"imread", "imwrite", "imdecode", "imreadmulti", "FileStorage"},
    "json": {"load", "loads", "dump"},
    "json_text": {"load", "loads", "dump"},
    "yaml": {"load", "safe_load", "full_load", "unsafe_load", "load_all", "safe_load_all", "parse", "compose"},
    "gzip": {"open", "decompress"},
    "bz2": {"open", "decompress"},
    "lzma": {"open", "decompress"},
    "zlib": {"decompress"},
    "zipfile": {"ZipFile"},
    "tarfile": {"open"},
    "sqlite3": {"connect"},
    "pickle": {"load", "loads"},
    "shutil": {"copyfile", "copy", "copy2", "copytree", "copyfileobj", "move", "unpack_archive"},
    "os": {"open", "fdopen"},
    "ElementTree": {"parse", "fromstring"},
    "ET": {"parse", "fromstring"},
    "Image": {"open"},
    "tomllib": {"load", "loads"},
}


ANY = re.compile(rf"\b({'|'.join(sorted({'open', *METHODS, *set().union(*CALLS.values())}))})\(")


def test_every_file_goes_through_the_opener_or_the_writer():
    found = {}
    for path in sorted(SOURCE.rglob("*.py")):
        name = str(path.relative_to(SOURCE))
        if name not in GUARDED and (lines := unguarded(path)):
            found[name] = lines
    assert {name: lines for name, lines in found.items() if name not in EXCEPTIONS} == {}
    assert set(EXCEPTIONS) - set(found) == set()


def unguarded(path):
    """Return `line: call` of what reads or writes files by itself."""
    found = []
    text = path.read_text(encoding="utf-8")
    for node in ast.walk(ast.parse(text)) if ANY.search(text) else ():
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        if isinstance(called, ast.Name) and called.id == "open":
            found.append(f"{node.lineno}: open")
        elif isinstance(called, ast.Attribute):
            owner = called.value.id if isinstance(called.value, ast.Name) else ""
            if owner not in NOT_FILES and called.attr in CALLS.get(owner, METHODS):
                found.append(f"{node.lineno}: {owner or '...'}.{called.attr}")
    return found
