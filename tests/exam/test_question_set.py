import json
import zipfile
from importlib.resources import files
from pathlib import Path

import pytest

from coral.errors import InputError
from coral.exam.item import ANSWERS
from coral.exam.question_set import load_set, save_set

PUBLIC = Path(str(files("coral.exam"))) / "sets" / "public.zip"


def entries(name):
    with zipfile.ZipFile(PUBLIC) as folder:
        return [json.loads(line) for line in folder.read(name).splitlines()]


def test_shipped_set_has_all_kinds_from_many_worlds():
    shown = entries("questions.jsonl")
    assert len(shown) >= 300
    assert {one["kind"] for one in shown} == set(ANSWERS) - {"reef-mission"}  # of missions in words another set asks
    assert len({one["group"] for one in shown if one["kind"].startswith("reef")}) >= 20
    assert len({one["id"] for one in shown}) == len(shown)


def test_shipped_set_is_small():
    assert PUBLIC.stat().st_size < 10_000_000


def test_pictures_go_with_questions_that_need_eyes(few):
    for item in few.items:
        names = [picture.name for picture in item.pictures]
        if item.kind.startswith("reef"):
            assert names == ["map", "segmentation", "depth"]
            assert item.pictures[0].pixel_from_world is not None
        assert all(picture.png.startswith(b"\x89PNG") for picture in item.pictures)
        assert bool(names) == (item.kind != "parameter-repair")


def test_a_set_comes_back_from_its_file(tmp_path):
    few = load_set("public", ["object-poses", "parameter-repair"], 1)
    save_set(tmp_path / "a.zip", few)
    save_set(tmp_path / "b.zip", few)
    again = load_set(str(tmp_path / "a.zip"))
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
    assert [(i.id, i.prompt, i.facts, i.key) for i in again.items] == [
        (i.id, i.prompt, i.facts, i.key) for i in few.items
    ]
    assert [p.png for i in again.items for p in i.pictures] == [p.png for i in few.items for p in i.pictures]


def test_limit_takes_some_of_each_kind_spread_over_the_set():
    of_kind = [one["id"] for one in entries("questions.jsonl") if one["kind"] == "object-poses"]
    some = [item.id for item in load_set("public", ["object-poses"], 3).items]
    assert some == [of_kind[k * len(of_kind) // 3] for k in range(3)]


def test_no_such_set_or_kind(tmp_path):
    with pytest.raises(InputError, match="public"):
        load_set("pubic")
    (tmp_path / "broken.zip").write_bytes(b"no zip")
    with pytest.raises(InputError, match="no set of questions"):
        load_set(str(tmp_path / "broken.zip"))
    with pytest.raises(InputError, match="reef-centroid"):
        load_set("public", ["reef-centroids"])
