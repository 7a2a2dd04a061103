"""Bytes from elsewhere: each bomb is one line, within 500 MB of memory and 5 s of processor time."""

import io
import json
import os
import re
import sqlite3
import struct
import subprocess
import sys
import textwrap
import zipfile
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from coral.errors import InputError
from coral.foreign_file import (
    check_tables,
    decode_picture,
    parse_json,
    picture_size,
    read_arrays,
    read_bytes,
    read_json,
    read_log_lines,
    read_picture_file,
    read_text,
)

GUARD = textwrap.dedent("""
    import resource, sys
    from pathlib import Path
    import cv2, numpy, PIL.Image
    from PIL import PngImagePlugin, JpegImagePlugin, WebPImagePlugin, TiffImagePlugin, BmpImagePlugin
    from coral.errors import InputError
    {imports}
    size = 1024 * int(next(l for l in open("/proc/self/status") if l.startswith("VmSize")).split()[1])
    used = resource.getrusage(resource.RUSAGE_SELF)
    resource.setrlimit(resource.RLIMIT_AS, (size + 500_000_000,) * 2)
    resource.setrlimit(resource.RLIMIT_CPU, (int(used.ru_utime + used.ru_stime) + 5,) * 2)
    path = Path(sys.argv[1])
    try:
        found = {call}
    except (InputError, ValueError) as error:
        print(error)
    else:
        print("read:", type(found).__name__, found is None)
""")


def within_limits(path, imports, call):
    """Run `call` on `path` in a process with 500 MB and 5 s besides what the imports take; return what it printed."""
    program = GUARD.format(imports=imports, call=call)
    done = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 0, done.stderr[-1500:]
    assert done.stdout.count("\n") == 1
    return done.stdout.replace(str(path), path.name)


def png_of(width, height):
    """A valid PNG file of some kilobytes, however large the picture."""
    size, piece = (3 * width + 1) * height, 1_000_000
    packer, last = zlib.compressobj(9, wbits=-15), zlib.compressobj(9, wbits=-15)
    part = packer.compress(bytes(piece)) + packer.flush(zlib.Z_FULL_FLUSH)  # stands alone, so it can be repeated
    end = last.compress(bytes(size % piece)) + last.flush()
    adler = size % 65521 << 16 | 1  # of zeros
    data = b"\x78\xda" + part * (size // piece) + end + struct.pack(">I", adler)

    def chunk(kind, content):
        body = kind + content
        return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def npz_bomb(path):
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "|u1", "fortran_order": False, "shape": (300_000_000,)})
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("map.npy", "w") as out,
    ):
        out.write(head.getvalue())
        for _ in range(300):
            out.write(bytes(1_000_000))


def npz_claim(path):
    """An array that says it is larger than it is."""
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)})
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("map.npy", head.getvalue() + bytes(80))


def long_line(path):
    path.write_bytes(b" " * 20_000_000)


def sparse(path):
    with path.open("wb") as out:
        out.truncate(50_000_000_000)


def wide_png(path):
    path.write_bytes(png_of(30_000, 20_000))


BOMBS = {
    "arrays.npz": (npz_bomb, "read_arrays(path)", "more than 200 MB when unpacked"),
    "claim.npz": (npz_claim, "read_arrays(path)", "map.npy: no array"),
    "events.jsonl": (long_line, "list(read_log_lines(path))", "found a line of more than 16000000 characters"),
    "sparse.json": (sparse, "read_json(path, 'a memory')", "found more than 100 MB"),
    "sparse.yaml": (sparse, "read_text(path, 'a world')", "found more than 20 MB"),
    "wide.png": (wide_png, "decode_picture(path.read_bytes())", "30000 x 20000 pixels, where 64 million are the most"),
    "wide2.png": (wide_png, "read_picture_file(path)", "read: NoneType True"),
    "deep.json": (
        lambda path: path.write_text("[" * 1_000_000 + "]" * 1_000_000),
        "read_json(path, 'a file')",
        "found broken JSON (values nested more than 60 deep)",
    ),
    "small.log": (lambda path: path.write_text("a\n" * 10), "regular_bytes(path, 10**12)", "read: bytes False"),
}


@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_one_line(name, tmp_path):
    make, call, told = BOMBS[name]
    make(tmp_path / name)
    assert told in within_limits(tmp_path / name, "from coral.foreign_file import *", call)


READERS = {
    "bytes": lambda path: read_bytes(path, "a file", 100),
    "json": lambda path: read_json(path, "a file"),
    "log": lambda path: list(read_log_lines(path)),
    "tables": lambda path: check_tables(path, "experience"),
}


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("what", ["pipe", "device", "folder"])
def test_only_regular_files_are_read(read, what, tmp_path):
    path = tmp_path / "odd"
    if what == "pipe":
        os.mkfifo(path)
    elif what == "device":
        path.symlink_to("/dev/zero")
    else:
        path.mkdir()
    with pytest.raises(InputError, match=r"odd: found (a named pipe|a device|a folder|is a directory|Is a directory)"):
        READERS[read](path)


def test_a_picture_is_decoded_as_opencv_does(tmp_path):
    image = np.arange(60, dtype=np.uint8).reshape(4, 5, 3)
    for suffix in (".png", ".jpg", ".webp", ".tiff", ".bmp"):
        content = cv2.imencode(suffix, image)[1].tobytes()
        assert picture_size(content) == (5, 4)
        assert np.array_equal(decode_picture(content), cv2.imdecode(np.frombuffer(content, np.uint8), -1))
        (tmp_path / f"x{suffix}").write_bytes(content)
        assert read_picture_file(tmp_path / f"x{suffix}").shape == (4, 5, 3)
    assert decode_picture(b"") is decode_picture(b"no picture") is None
    assert read_picture_file(tmp_path / "missing.png") is None


def test_a_picture_of_colours_has_no_values(tmp_path):
    cv2.imwrite(str(tmp_path / "map.png"), np.zeros((4, 5, 3), np.uint8))
    cv2.imwrite(str(tmp_path / "depth.png"), np.zeros((4, 5), np.uint16))
    assert read_picture_file(tmp_path / "map.png", channels=1) is None
    assert read_picture_file(tmp_path / "map.png", channels=3).shape == (4, 5, 3)
    assert read_picture_file(tmp_path / "depth.png", channels=1).dtype == np.uint16


def test_damaged_tags_of_a_picture_are_passed_over_in_silence(recwarn):
    whole = cv2.imencode(".tiff", np.zeros((24, 32, 3), np.uint8))[1].tobytes()
    assert picture_size(whole) == (32, 24)
    for end in range(len(whole) - 200, len(whole), 7):
        picture_size(whole[:end])
    assert not recwarn.list


def test_arrays_are_read_as_numpy_does(tmp_path):
    arrays = {"a": np.arange(6.0).reshape(2, 3), "b": np.asfortranarray(np.eye(3, dtype=np.int16)), "c": np.array(5)}
    np.savez_compressed(tmp_path / "x.npz", **arrays)
    found = read_arrays(tmp_path / "x.npz")
    assert found.keys() == arrays.keys()
    for name, value in arrays.items():
        assert np.array_equal(found[name], value)
        assert found[name].dtype == value.dtype
    np.savez(tmp_path / "object.npz", x=np.array([{}], object))
    for content in (b"", b"PK\x03\x04 cut off", (tmp_path / "object.npz").read_bytes()):
        with pytest.raises(ValueError, match=r"no whole \.npz file|no array"):
            read_arrays(content)


@pytest.mark.parametrize("content", ["{", '{"a": [1, 2', "nothing", "\ufeff\ufeff{}"])
def test_broken_json_is_one_line(content, tmp_path):
    (tmp_path / "x.json").write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=r"x\.json: found .*, expected a file"):
        read_json(tmp_path / "x.json", "a file")


def test_a_mark_before_utf_8_is_no_part_of_the_text(tmp_path):
    (tmp_path / "x.json").write_text('\ufeff{"a": 1}', encoding="utf-8")
    assert read_json(tmp_path / "x.json", "a file") == {"a": 1}
    assert parse_json(json.dumps([[1]])) == [[1]]
    (tmp_path / "latin").write_bytes("Großes Riff".encode("latin-1"))
    with pytest.raises(InputError, match="bytes that are not UTF-8 text"):
        read_text(tmp_path / "latin", "a file")


@pytest.mark.parametrize(
    ("schema", "found"),
    [
        ("CREATE TABLE experience (id, record AS (hex(zeroblob(900000000))))", "experience.record: found a generated"),
        ("CREATE VIEW experience AS SELECT 1", "experience: found a view"),
    ],
)
def test_a_table_that_computes_is_refused(schema, found, tmp_path):
    base = sqlite3.connect(tmp_path / "memory.sqlite")
    base.execute(schema)
    base.commit()
    base.close()
    with pytest.raises(InputError, match=re.escape(found)):
        check_tables(Path(tmp_path / "memory.sqlite"), "experience")
