import os

import pytest

from coral.campaign import store as store_module
from coral.campaign.store import Store
from coral.errors import InputError


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "out")


def test_a_finished_episode_is_there_with_what_it_wrote(store, specs_of):
    specs = specs_of()
    store.open(specs, {"code": "1"})
    store.scratch(specs[0]).mkdir(parents=True)
    (store.scratch(specs[0]) / "log.txt").write_text("hello")
    assert store.finish(specs[0], {"score": 1}, {"host": "a"})
    assert store.pending(specs) == specs[1:]
    assert (store.run_folder(specs[0]) / "log.txt").read_text() == "hello"
    assert store.records() == [
        {"spec": specs[0].to_json(), "status": "done", "result": {"score": 1}, "about": {"host": "a"}}
    ]


def test_the_first_result_of_an_episode_stays(store, specs_of):
    spec = specs_of()[0]
    store.open([spec], {})
    assert store.finish(spec, {"score": 1}, {})
    assert not store.finish(spec, {"score": 2}, {})
    assert store.records()[0]["result"] == {"score": 1}


@pytest.mark.parametrize("at", ["before the rename", "between folder and record"])
def test_killed_while_recording_the_episode_is_not_there_and_runs_again(store, specs_of, monkeypatch, at):
    spec = specs_of()[0]
    store.open([spec], {})
    store.scratch(spec).mkdir(parents=True)
    (store.scratch(spec) / "log.txt").write_text("first")
    real = os.replace

    def dies(source, target):
        if at == "between folder and record" and str(source) == str(store.scratch(spec)):
            return real(source, target)
        raise KeyboardInterrupt

    monkeypatch.setattr(store_module.os, "replace", dies)
    with pytest.raises(KeyboardInterrupt):
        store.finish(spec, {"score": 1}, {})
    monkeypatch.undo()
    again = Store(store.folder)
    again.open([spec], {})
    assert again.pending([spec]) == (spec,)
    assert not list(again.folder.rglob("*.part"))
    assert not list(again.folder.glob("runs/.*"))
    again.scratch(spec).mkdir(parents=True)
    (again.scratch(spec) / "log.txt").write_text("second")
    assert again.finish(spec, {"score": 2}, {})
    assert (again.run_folder(spec) / "log.txt").read_text() == "second"
    assert [record["result"]["score"] for record in again.records()] == [2]


def test_a_truncated_record_counts_as_none(store, specs_of):
    spec = specs_of()[0]
    store.open([spec], {})
    store.finish(spec, {"score": 1}, {})
    path = store.folder / "episodes" / f"{spec.key}.json"
    path.write_text(path.read_text()[:40])
    assert store.records() == []
    assert store.pending([spec]) == (spec,)
    assert store.finish(spec, {"score": 3}, {})
    assert store.records()[0]["result"] == {"score": 3}


def test_a_half_written_temporary_file_disturbs_nothing(store, specs_of):
    specs = specs_of()
    store.open(specs, {})
    store.finish(specs[0], {"score": 1}, {})
    for name in (f"episodes/{specs[1].key}.json.part", "manifest.json.part"):
        (store.folder / name).write_text('{"spec": ')
    assert len(store.records()) == 1
    store.open(specs, {})
    assert not list(store.folder.rglob("*.part"))
    assert store.pending(specs) == specs[1:]


def test_failures_are_kept_with_their_message_and_retried_on_request(store, specs_of):
    specs = specs_of()
    store.open(specs, {})
    store.fail(specs[0], "ValueError: no", "Traceback", {})
    assert store.pending(specs) == specs[1:]
    assert store.pending(specs, retry_failed=True) == specs
    assert store.records()[0]["message"] == "ValueError: no"
    assert store.finish(specs[0], {"score": 5}, {})
    assert [record["status"] for record in store.records()] == ["done"]


def test_a_larger_grid_extends_the_campaign(store, specs_of):
    small, large = specs_of(seeds=(0, 1)), specs_of(seeds=(1, 2, 3))
    store.open(small, {"code": "1", "world a": "x"}, command="first")
    store.finish(small[1], {}, {})
    store.open(large, {"code": "1", "world b": "y"}, command="second")
    assert store.specs() == (*small, *large[1:])
    assert store.pending(large) == large[1:]
    manifest = store.manifest()
    assert manifest["conditions"] == {"code": "1", "world a": "x", "world b": "y"}
    assert manifest["commands"] == ["first", "second"]


def test_changed_conditions_are_refused_in_one_line_unless_mixed(store, specs_of):
    store.open(specs_of(), {"code version": "1"})
    with pytest.raises(InputError, match=r"code version: found results made with 1 \(now: 2\).*--mix"):
        store.open(specs_of(), {"code version": "2"})
    assert store.manifest()["conditions"] == {"code version": "1"}
    store.open(specs_of(), {"code version": "2"}, mix=True)


def test_only_one_process_writes(store):
    with store.lock(), pytest.raises(InputError, match="still running"), Store(store.folder).lock():
        pass
    with store.lock():
        pass


def test_a_folder_with_other_things_in_it_is_left_alone(store):
    store.folder.mkdir()
    (store.folder / "thesis.tex").write_text("mine")
    with pytest.raises(InputError, match=r"thesis\.tex"), store.lock():
        pass
    assert [p.name for p in store.folder.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize("content", ["", "[]", '{"format": "coral-campaign/9"}'])
def test_a_folder_that_is_no_campaign_is_refused(store, content):
    store.folder.mkdir()
    store.manifest_path.write_text(content)
    with pytest.raises(InputError, match=r"manifest\.json"):
        store.records()
