"""A contact run as a bag, read by readers that are not ours."""

import json

import pytest

from coral.errors import InputError
from coral.view.contact.bag_export import TOPICS, export_bag, export_mcap, write_bag
from coral.view.run import RunFolder

pytest.importorskip("rosbags")


@pytest.fixture(scope="module")
def messages(recorded, tmp_path_factory):
    """Messages of the run's MCAP file by topic, decoded by the readers of MCAP."""
    make_reader = pytest.importorskip("mcap.reader").make_reader
    factory = pytest.importorskip("mcap_ros2.decoder").DecoderFactory
    path = tmp_path_factory.mktemp("bags") / "poke.mcap"
    counts = export_mcap(recorded, path)
    found = {}
    with open(path, "rb") as stream:
        for _, channel, _, message in make_reader(stream, decoder_factories=[factory()]).iter_decoded_messages():
            found.setdefault(channel.topic, []).append(message)
    assert {topic: len(some) for topic, some in found.items()} == counts
    assert set(found) == set(TOPICS)
    return found


def test_hand_target_and_objects_stand_in_the_world(messages, recorded):
    run = RunFolder.read(recorded)
    assert len(messages["/tf"]) == len(run.column("t"))
    last = {one.child_frame_id: one for one in messages["/tf"][-1].transforms}
    assert set(last) == {"hand", "hand_target", "box"}
    assert {one.header.frame_id for one in last.values()} == {"world"}
    for frame, prefix in (("hand", ""), ("hand_target", "cmd_"), ("box", "box_")):
        place, turn = last[frame].transform.translation, last[frame].transform.rotation
        assert [place.x, place.y, place.z] == pytest.approx([run.column(f"{prefix}{axis}")[-1] for axis in "xyz"])
        assert turn.w == pytest.approx(run.column(f"{prefix}qw")[-1])


def test_the_force_on_the_hand_is_told_on_its_own_axes(messages, recorded):
    run = RunFolder.read(recorded)
    row = int(abs(run.column("fz")).argmax())
    assert abs(run.column("fz")[row]) > 0.1
    force = messages["/hand/wrench"][row].wrench.force
    # The hand points down: its z axis is the world's, turned about.
    assert run.column("qx")[row] == pytest.approx(1.0, abs=0.1)
    assert force.z == pytest.approx(-run.column("fz")[row], abs=0.3 * abs(run.column("fz")[row]))
    assert messages["/hand/wrench"][row].header.frame_id == "hand"


def test_plans_and_events_are_those_of_the_run(messages, recorded):
    run = RunFolder.read(recorded)
    plans = run.select("plan")
    assert [[one.point.x, one.point.y, one.point.z] for one in messages["/plan/aim"]] == [p["aim"] for p in plans]
    assert [one.data for one in messages["/plan/cost"]] == [p["cost"] for p in plans]
    assert [json.loads(one.data) for one in messages["/events"]] == list(run.events)


def test_the_scene_has_the_table_and_the_box_of_this_trial(messages, recorded):
    (scene,) = messages["/scene"]
    marks = {one.ns: one for one in scene.markers}
    size = RunFolder.read(recorded).select("start")[0]["trial"]["box"]["size_m"]
    assert marks["box"].header.frame_id == "box"
    assert [marks["box"].scale.x, marks["box"].scale.y, marks["box"].scale.z] == pytest.approx(size, abs=1e-4)
    assert marks["table"].pose.position.z + marks["table"].scale.z / 2 == pytest.approx(0.0)


def test_a_bag_is_read_by_rosbags(recorded, tmp_path):
    from rosbags.highlevel import AnyReader

    counts = export_bag(recorded, tmp_path / "poke_bag")
    with AnyReader([tmp_path / "poke_bag"]) as reader:
        assert {one.topic: one.msgcount for one in reader.connections} == counts


def test_a_run_without_rows_is_one_line(copy, tmp_path):
    (copy / "trajectory.csv").write_text("step,t\n")
    with pytest.raises(InputError, match=r"trajectory\.csv: found no rows"):
        write_bag(RunFolder.read(copy), tmp_path / "x.mcap", single_file=True)
