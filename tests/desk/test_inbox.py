import json
import os
import socket
import subprocess
import sys
import threading

import pytest

from coral.desk.inbox import Inbox, NoSuchQuestion, NotOpen, Unfit
from coral.desk.server import state_json
from coral.errors import InputError
from coral.reef.world.instruction import MOST_CHARACTERS


@pytest.fixture
def inbox(tmp_path):
    return Inbox(tmp_path / "inbox")


def dead_process():
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def test_a_missing_inbox_is_made(tmp_path):
    assert Inbox(tmp_path / "a" / "b").entries() == []
    assert (tmp_path / "a" / "b").is_dir()


def test_a_file_is_no_inbox(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file: INBOX: found a file, expected a folder"):
        Inbox(tmp_path / "file")


def test_a_question_lives_from_open_to_answered(inbox, ask):
    asking = ask()
    (entry,) = inbox.entries()
    assert (entry.id, entry.kind, entry.state, entry.attempt) == ("000001-pick", "pick", "open", 0)
    inbox.answer(asking.id, {"index": 2}, "Ana")
    assert asking.result().index == 2
    (entry,) = inbox.entries()
    assert (entry.state, entry.operator, entry.answer) == ("answered", "Ana", {"index": 2})
    with pytest.raises(NotOpen, match="already answered by Ana"):
        inbox.answer(asking.id, {"index": 3}, "Bo")


def test_an_unfit_answer_leaves_no_trace(inbox, ask):
    asking = ask()
    with pytest.raises(Unfit, match="index does not fit: 9 is greater than the maximum of 3"):
        inbox.answer(asking.id, {"index": 9})
    with pytest.raises(Unfit, match="the answer does not fit"):
        inbox.answer(asking.id, [1])
    assert {p.name for p in (inbox.folder / asking.id).iterdir()} == {"map.png", "question.json"}
    assert inbox.entries()[0].state == "open"


def test_one_of_many_answers_wins(inbox, ask):
    asking = ask()
    start, won, lost = threading.Barrier(8), [], []

    def operator(k):
        other = Inbox(inbox.folder)  # as another process would
        start.wait()
        try:
            other.answer(asking.id, {"index": k % 4}, f"operator {k}")
            won.append(k)
        except NotOpen:
            lost.append(k)

    threads = [threading.Thread(target=operator, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(won) == 1
    assert len(lost) == 7
    assert asking.result().index == won[0] % 4
    assert inbox.entries()[0].operator == f"operator {won[0]}"
    assert not [p.name for p in (inbox.folder / asking.id).iterdir() if p.name.endswith(".part")]


def test_without_hard_links_one_answer_wins_too(inbox, ask, monkeypatch):
    def no_links(*_):
        raise PermissionError("no hard links here")

    monkeypatch.setattr(os, "link", no_links)
    asking = ask()
    inbox.answer(asking.id, {"index": 1}, "Ana")
    assert asking.result().index == 1
    (inbox.folder / asking.id / "closed.json").unlink()
    (inbox.folder / asking.id / "answer.json").unlink()
    with pytest.raises(NotOpen, match="already answered by Ana"):
        Inbox(inbox.folder).answer(asking.id, {"index": 2})


def test_an_answer_of_another_program_counts(inbox, ask):
    asking = ask()
    partial = inbox.folder / asking.id / "answer.part"
    partial.write_text('{"index": 3}')
    os.replace(partial, partial.with_name("answer.json"))
    with pytest.raises(NotOpen, match="already answered by somebody else"):
        inbox.answer(asking.id, {"index": 1})
    assert asking.result().index == 3


def test_withdrawn_and_abandoned_questions_take_no_answer(inbox, ask):
    asking = ask()
    asking.withdraw()
    with pytest.raises(NotOpen, match="withdrew"):
        inbox.answer(asking.id, {"index": 1})
    left = ask()
    file = inbox.folder / left.id / "question.json"
    question = json.loads(file.read_text())
    file.write_text(json.dumps({**question, "asker": {**question["asker"], "pid": dead_process()}}))
    assert [entry.state for entry in inbox.entries()] == ["withdrawn", "abandoned"]
    with pytest.raises(NotOpen, match="stopped"):
        inbox.answer(left.id, {"index": 1})


def test_history_tells_which_answer_was_refused(inbox, ask, case):
    for rejections in ((), case.refused("behind you"), ()):
        asking = ask(case.pick_question(), rejections)
        inbox.answer(asking.id, {"index": 1})
        asking.result()
    assert [entry.refused for entry in inbox.entries()] == ["behind you", "", ""]


@pytest.mark.parametrize(
    "name",
    [
        "..",
        ".",
        "",
        "../inbox/000001-pick",
        "000001-pick/..",
        "1-a/b",
        "%2e%2e",
        "1-..%2f",
        "000002-none",
        "mission-x.json",
        "1-\n",
    ],
)
def test_only_questions_are_found(inbox, ask, name):
    ask()
    with pytest.raises(NoSuchQuestion):
        inbox.question(name)
    with pytest.raises(NoSuchQuestion):
        inbox.picture(name, "map.png")


@pytest.mark.parametrize(
    "name",
    ["question.json", "../000001-pick/map.png", "/etc/hostname", "..", "", "link.png", "text.png", ".hidden.png"],
)
def test_only_listed_pictures_are_found(inbox, ask, tmp_path, name):
    asking = ask()
    folder = inbox.folder / asking.id
    (tmp_path / "secret.png").write_bytes(b"\x89PNG\r\n\x1a\nsecret")
    (folder / "link.png").symlink_to(tmp_path / "secret.png")
    (folder / ".hidden.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    (folder / "text.png").write_text("no picture")
    file = folder / "question.json"
    file.write_text(json.dumps({**json.loads(file.read_text()), "images": ["map.png", name]}))
    assert inbox.picture(asking.id, "map.png").startswith(b"\x89PNG")
    with pytest.raises(NoSuchQuestion):
        inbox.picture(asking.id, name)


def test_a_linked_folder_is_no_question(inbox, ask, tmp_path):
    asking = ask()
    (inbox.folder / "000009-pick").symlink_to(inbox.folder / asking.id)
    assert [entry.id for entry in inbox.entries()] == [asking.id]
    with pytest.raises(NoSuchQuestion):
        inbox.question("000009-pick")


def test_rubbish_in_the_inbox_is_listed_and_harmless(inbox, ask):
    ask()
    (inbox.folder / "000005-broken").mkdir()
    (inbox.folder / "000005-broken" / "question.json").write_text("{")
    (inbox.folder / "notes.txt").write_text("hello")
    (inbox.folder / "mission-x.json").write_text("[]")
    odd = {
        "kind": [],
        "answer_schema": {},
        "images": 3,
        "rejections": [1],
        "asker": {"host": [], "pid": "x"},
        "asked_at": 1e999,
    }
    (inbox.folder / "000006-odd").mkdir()
    (inbox.folder / "000006-odd" / "question.json").write_text(json.dumps(odd))
    (inbox.folder / "000006-odd" / "answer.json").write_text("[" * 900 + "]" * 900)
    assert [(entry.id, entry.state) for entry in inbox.entries()] == [
        ("000001-pick", "open"),
        ("000005-broken", "unreadable"),
        ("000006-odd", "sent"),
    ]
    assert "Infinity" not in state_json(inbox)
    assert inbox.missions() == []


def test_numbers_of_many_digits_in_an_inbox_are_none_at_all(tmp_path):
    folder = tmp_path / "000001-pick"
    folder.mkdir()
    huge = int("9" * 400)
    asked = {
        "answer_schema": {},
        "kind": "pick",
        "asked_at": huge,
        "asker": {"host": socket.gethostname(), "pid": huge},
    }
    (folder / "question.json").write_text(json.dumps(asked))
    (tmp_path / "mission-here-1.json").write_text(json.dumps({"state": "finished", "started_at": huge}))
    inbox = Inbox(tmp_path)
    assert inbox.entries()[0].asked_at is None
    assert inbox.missions()[0]["started_at"] == huge


@pytest.mark.parametrize(
    ("notice", "words", "refused"),
    [
        ({"state": "finished", "instruction": "Find it."}, "Find the net.", NotOpen),
        ({"state": "running", "instruction": ""}, "Find the net.", NotOpen),
        ({"state": "running"}, "Find the net.", NotOpen),
        ({"state": "running", "instruction": "Find it."}, " ", ValueError),
        ({"state": "running", "instruction": "Find it."}, "x" * (MOST_CHARACTERS + 1), ValueError),
        (None, "Find the net.", NoSuchQuestion),
    ],
)
def test_only_a_mission_in_words_under_way_takes_another_instruction(inbox, notice, words, refused):
    if notice is not None:
        (inbox.folder / "mission-here-1.json").write_text(json.dumps(notice))
    with pytest.raises(refused):
        inbox.instruct("here-1", words)
    assert not (inbox.folder / "instruction-here-1.json").exists()


def test_the_last_of_several_instructions_counts(inbox):
    (inbox.folder / "mission-here-1.json").write_text(json.dumps({"state": "running", "instruction": "Find it."}))
    for words in ("Find the net.", "x" * MOST_CHARACTERS):
        inbox.instruct("here-1", words, "Ana")
    told = json.loads((inbox.folder / "instruction-here-1.json").read_text())
    assert told == {"instruction": "x" * MOST_CHARACTERS, "operator": "Ana"}
