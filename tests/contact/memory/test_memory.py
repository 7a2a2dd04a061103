import json
import signal
import sqlite3
import subprocess
import sys

import pytest
from experiences import experience

from coral.contact.memory.memory import Memory
from coral.errors import InputError


@pytest.fixture
def memory(place):
    return Memory(place("m"))


def test_what_succeeded_is_found_again(scene, memory):
    one = scene("pick-box")
    number = memory.add(experience(one))
    found = memory.find(one.facts)
    assert [match.stored.id for match in found] == [number]
    assert found[0].similarity == pytest.approx(1.0, abs=1e-5)
    assert found[0].distance == 0


@pytest.mark.parametrize("provenance", [{"success": False}, {"success": None}, {"world": ""}])
def test_only_verified_successes_are_stored(scene, memory, provenance):
    with pytest.raises(InputError, match="success"):
        memory.add(experience(scene("pick-box"), **provenance))
    assert memory.all() == []


def differing(facts, change):
    other = json.loads(json.dumps(facts))
    change(other)
    return other


def scale_size(factor):
    def change(facts):
        facts["objects"]["box"]["size_m"] = [factor * side for side in facts["objects"]["box"]["size_m"]]

    return change


def lift_higher(facts):
    facts["goals"][0].update(height_m=0.2, most_m=0.3)


def say_otherwise(facts):
    facts["instruction"] = "Take the parcel and bring it up."


def add_a_shelf(facts):
    facts["fixtures"]["shelf"] = {"position": [0.3, 0.3, 0.1], "size_m": [0.1, 0.1, 0.2], "yaw_deg": 0.0}
    facts["objects"]["mug"] = {**facts["objects"]["box"], "label": "mug"}
    facts["goals"].append({"object": "mug", "kind": "undisturbed", "tolerance_m": 0.02, "tolerance_deg": 10.0})


@pytest.mark.parametrize("change", [scale_size(0.6), lift_higher, say_otherwise, add_a_shelf])
def test_another_size_height_wording_or_thing_does_not_hide_a_plan(scene, memory, change):
    one = scene("pick-box")
    number = memory.add(experience(one))
    assert [match.stored.id for match in memory.find(differing(one.facts, change))] == [number]


def much_heavier(facts):
    facts["objects"]["box"]["mass_kg"] *= 20


def lie_on_its_side(facts):
    facts["objects"]["box"]["pose"][3:] = [0.7071, 0.7071, 0.0, 0.0]


def push_instead(facts):
    facts["instruction"] = "Push the box."


@pytest.mark.parametrize("change", [scale_size(1.5), much_heavier, lie_on_its_side, push_instead])
def test_what_the_plan_cannot_do_is_not_offered(scene, memory, change):
    one = scene("pick-box")
    memory.add(experience(one))
    assert memory.find(differing(one.facts, change)) == []


def test_other_goals_do_not_match_however_near_the_words(scene, memory):
    one = scene("flip-wall")
    memory.add(experience(one))
    away = json.loads(json.dumps(one.facts))
    away["goals"] = [goal for goal in away["goals"] if goal["kind"] != "touched-while-turning"]
    assert memory.find(away) == []


def test_an_experience_that_did_not_help_ranks_lower(scene, memory):
    one = scene("pick-box")
    first, second = memory.add(experience(one)), memory.add(experience(one, seed=1))
    memory.used(second, helped=False)
    assert [match.stored.id for match in memory.find(one.facts)] == [first, second]


def test_a_plan_that_failed_comes_last_however_near_its_words(scene, memory):
    one = scene("pick-box")
    first = memory.add(experience(one))
    second = memory.add(experience(one).model_copy(update={"instruction": "Fetch it."}))
    assert [match.stored.id for match in memory.find(one.facts)] == [first, second]
    memory.used(first, helped=False)
    assert [match.stored.id for match in memory.find(one.facts)] == [second, first]


def test_a_plan_that_only_fails_is_no_longer_offered(scene, memory):
    one = scene("pick-box")
    number = memory.add(experience(one))
    for times in range(1, 4):
        memory.used(number, helped=False)
        assert len(memory.find(one.facts)) == (times < 3)
    memory.used(number, helped=True)
    assert len(memory.find(one.facts)) == 1


def test_the_rate_of_success_counts_the_success_that_was_stored(scene, memory):
    one = scene("pick-box")
    number = memory.add(experience(one))
    rates = [memory.get(number).success_rate]
    for helped in (True, False, False):
        memory.used(number, helped)
        rates.append(memory.get(number).success_rate)
    assert rates == pytest.approx([2 / 3, 3 / 4, 3 / 5, 3 / 6])


def test_what_is_forgotten_is_gone(scene, memory):
    number = memory.add(experience(scene("pick-box")))
    memory.forget(number)
    assert memory.all() == []
    with pytest.raises(InputError, match="none"):
        memory.forget(number)


def test_a_file_that_is_no_memory_is_refused(tmp_path):
    path = tmp_path / "x.sqlite"
    path.write_text("not a database, but long enough to be looked at as one" * 20)
    with pytest.raises(InputError, match="SQLite"):
        Memory(path).all()


WRITER = """
import sys, json
from pathlib import Path
from coral.contact.memory.memory import Experience, Memory
memory = Memory(sys.argv[1])
one = Experience.model_validate_json(Path(sys.argv[2]).read_text())
while True:
    print(memory.add(one), flush=True)
"""


def test_a_killed_writer_loses_nothing_it_has_acknowledged(scene, memory, tmp_path):
    (tmp_path / "one.json").write_text(experience(scene("pick-box")).model_dump_json())
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, memory.where, str(tmp_path / "one.json")], stdout=subprocess.PIPE, text=True
    ) as writer:
        told = [int(writer.stdout.readline()) for _ in range(20)]
        writer.send_signal(signal.SIGKILL)
        told += [int(line) for line in writer.stdout.read().split("\n")[:-1]]
    assert set(told) <= {stored.id for stored in memory.all()}
    assert memory.add(experience(scene("pick-box"))) > max(told)


@pytest.mark.parametrize(
    "wrong",
    [
        {"goals": [{"kind": "lifted"}]},
        {"goals": [{"object": "box"}]},
        {"goals": [{"kind": "lifted", "object": ["box"]}]},
        {"numbers": {"object0.size.0": float("nan")}},
        {"numbers": {"object0.size.0": float("inf")}},
        {"provenance": {"success": False, "world": "hand"}},
        {"provenance": {"success": True}},
        {"provenance": {"success": True, "world": "hand", "deep": json.loads("[" * 900 + "]" * 900)}},
    ],
)
def test_a_stored_row_that_says_nonsense_or_is_no_success_is_passed_over(scene, memory, wrong):
    one = scene("pick-box")
    made = json.loads(experience(one).model_dump_json())
    memory.store.insert(
        "now",
        json.dumps({**made, **wrong}),
    )
    assert memory.all() == []
    assert memory.find(one.facts) == []


ADDER = """
import sys
from pathlib import Path
from coral.contact.memory.memory import Experience, Memory
memory = Memory(sys.argv[1])
one = Experience.model_validate_json(Path(sys.argv[2]).read_text())
print("ready", flush=True)
sys.stdin.readline()
for seed in range(10):
    memory.add(one.model_copy(update={"provenance": {**one.provenance, "seed": 10 * int(sys.argv[3]) + seed}}))
"""


@pytest.fixture
def adding(tmp_path):
    """Processes that are all there, and that all add ten episodes to one memory once they are told to."""
    started = []

    def start(path, one, count):
        (tmp_path / "one.json").write_text(one.model_dump_json())
        started.extend(
            subprocess.Popen(
                [sys.executable, "-c", ADDER, path, tmp_path / "one.json", str(number)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
            )
            for number in range(count)
        )
        assert [writer.stdout.readline() for writer in started] == [b"ready\n"] * count
        return started

    yield start
    for writer in started:
        writer.kill()
        writer.communicate()


@pytest.mark.slow
def test_many_processes_write_into_a_new_memory_at_once_and_nothing_is_lost(scene, memory, adding):
    writers = adding(memory.where, experience(scene("pick-box")), 4)
    for writer in writers:
        writer.stdin.write(b"\n")
        writer.stdin.flush()
    assert [writer.wait() for writer in writers] == [0] * 4
    stored = memory.all()
    assert sorted(one.experience.provenance["seed"] for one in stored) == list(range(40))
    assert len({one.id for one in stored}) == 40


def test_a_file_that_another_process_is_just_making_is_waited_for(scene, tmp_path, monkeypatch):
    memory = Memory(tmp_path / "m.sqlite")
    other = sqlite3.connect(tmp_path / "m.sqlite", isolation_level=None)
    other.execute("BEGIN IMMEDIATE")
    waited = []

    def wait(seconds):
        waited.append(seconds)
        other.execute("COMMIT")

    monkeypatch.setattr("coral.contact.memory.store_sqlite.time.sleep", wait)
    assert memory.add(experience(scene("pick-box"))) == 1
    assert len(waited) == 1
    other.close()
