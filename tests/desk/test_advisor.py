import asyncio
import dataclasses
import json
import os
import re
from pathlib import Path

import pytest
from pydantic import BaseModel, Field

from coral.advisor.question import BadAnswer, Picture, Question, Rejection
from coral.desk import advisor as desk_module
from coral.desk.advisor import DeskAdvisor, read_answer
from coral.reef.decide.answers import CentroidChoice
from reference import texts


class Pick(BaseModel):
    index: int = Field(ge=0, le=3)


QUESTION = Question(
    kind="pick",
    prompt="Which?",
    answer_type=Pick,
    facts={"n": 3},
    prompt_version="7",
    pictures=(Picture(name="map", png=b"png", caption="from above"),),
)


def submit(folder, text):
    (folder / "answer.part").write_text(text)
    os.replace(folder / "answer.part", folder / "answer.json")


async def open_questions(inbox, n):
    while len(found := sorted(p for p in inbox.iterdir() if not p.name.startswith("."))) < n:
        await asyncio.sleep(0)
    return found


def test_question_is_posted_whole_and_answered(tmp_path):
    async def run():
        task = asyncio.create_task(
            DeskAdvisor(tmp_path, poll_s=0.0).answer(
                QUESTION, [Rejection(code="backward", reason="behind", details={"index": 1})]
            )
        )
        (folder,) = await open_questions(tmp_path, 1)
        question = json.loads((folder / "question.json").read_text())
        assert not (folder / "closed.json").exists()
        submit(folder, '{"index": 2}')
        return folder, question, await task

    folder, question, reply = asyncio.run(run())
    assert reply.value == Pick(index=2)
    assert question["id"] == folder.name == "000001-pick"
    assert question["images"] == ["map.png"]
    assert set(question) == set(" ".join(texts.QUESTION_KEYS).split())
    assert (folder / "map.png").read_bytes() == b"png"
    assert question["rejections"] == [{"code": "backward", "reason": "behind", "details": {"index": 1}, "listing": ""}]
    assert question["answer_schema"]["properties"]["index"]["maximum"] == 3
    assert json.loads((folder / "closed.json").read_text()) == {"state": "answered"}


@pytest.mark.parametrize(("text", "code"), [('{"index": 9}', "out-of-range"), ("two", "not-json"), ("", "empty")])
def test_operators_err_too(tmp_path, text, code):
    async def run():
        task = asyncio.create_task(DeskAdvisor(tmp_path, poll_s=0.0).answer(QUESTION, ()))
        (folder,) = await open_questions(tmp_path, 1)
        submit(folder, text)
        await task

    with pytest.raises(BadAnswer) as bad:
        asyncio.run(run())
    assert bad.value.rejection.code == code


def test_the_folders_are_private_and_an_answer_of_somebody_else_does_not_count(tmp_path, monkeypatch):
    async def run():
        task = asyncio.create_task(DeskAdvisor(tmp_path / "inbox", poll_s=0.0).answer(QUESTION, ()))
        while not (tmp_path / "inbox").exists():
            await asyncio.sleep(0)
        (folder,) = await open_questions(tmp_path / "inbox", 1)
        assert [path.stat().st_mode & 0o777 for path in (tmp_path / "inbox", folder)] == [0o700, 0o700]
        monkeypatch.setattr(desk_module.os, "geteuid", lambda: 1234)
        monkeypatch.setattr(desk_module, "ROOT", 1235)
        submit(folder, '{"index": 1}')
        await task

    with pytest.raises(BadAnswer) as bad:
        asyncio.run(run())
    assert bad.value.rejection.code == "not-yours"


def test_an_answer_is_a_regular_file(tmp_path):
    (tmp_path / "file").write_text("{}")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("file")
    assert [read_answer(tmp_path / name) for name in ("file", "pipe", "link")] == ["{}", None, None]


def test_withdrawn_question_is_closed(tmp_path):
    async def run():
        task = asyncio.create_task(DeskAdvisor(tmp_path, poll_s=0.0).answer(QUESTION, ()))
        (folder,) = await open_questions(tmp_path, 1)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        return json.loads((folder / "closed.json").read_text())

    assert asyncio.run(run()) == {"state": "withdrawn"}


def test_two_missions_share_an_inbox(tmp_path):
    async def run():
        tasks = [asyncio.create_task(DeskAdvisor(tmp_path, poll_s=0.0).answer(QUESTION, ())) for _ in range(2)]
        for number, folder in enumerate(await open_questions(tmp_path, 2)):
            assert json.loads((folder / "question.json").read_text())["id"] == folder.name
            submit(folder, json.dumps({"index": number}))
        return [reply.value.index for reply in await asyncio.gather(*tasks)]

    assert sorted(asyncio.run(run())) == [0, 1]


def test_the_documented_program_never_sees_a_question_that_is_being_written(tmp_path, monkeypatch):
    """It runs at the moment before the folder gets its name, and again afterwards."""
    page = (Path(__file__).parents[2] / "docs" / "guide" / "the-desk.md").read_text()
    (program,) = [code for code in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "question.json" in code]
    monkeypatch.chdir(tmp_path)
    inbox = tmp_path / "inbox"
    inbox.mkdir()
    question = dataclasses.replace(
        QUESTION,
        kind="reef-centroid",
        facts={"centroids": [{"index": 3, "visited": False}]},
        answer_type=CentroidChoice,
    )
    seen, rename = [], os.rename

    def watched(source, target):
        monkeypatch.setattr(desk_module.os, "rename", rename)
        exec(compile(program, "the-desk.md", "exec"), {})
        seen.append([path.name for path in inbox.glob("*/question.json")])
        rename(source, target)

    async def run():
        monkeypatch.setattr(desk_module.os, "rename", watched)
        task = asyncio.create_task(DeskAdvisor(inbox, poll_s=0.0).answer(question, ()))
        await open_questions(inbox, 1)
        exec(compile(program, "the-desk.md", "exec"), {})
        return await task

    assert asyncio.run(run()).value.selected_centroid_index == 3
    assert seen == [[]]


def test_a_question_that_a_killed_mission_did_not_finish_is_in_nobodys_way(tmp_path):
    async def run():
        advisor = DeskAdvisor(tmp_path, poll_s=0.0)
        left = advisor._post(QUESTION, ())
        for k in range(3):
            (tmp_path / ".writing" / f"00000{k}-pick.{os.getpid()}").mkdir(parents=True)
        return left.name, advisor._post(QUESTION, ()).name

    assert asyncio.run(run()) == ("000001-pick", "000002-pick")


def test_a_number_of_many_digits_is_an_answer_like_any_other(tmp_path):
    async def run(digits):
        question = dataclasses.replace(QUESTION, answer_type=CentroidChoice)
        (tmp_path / f"{digits}").mkdir()
        task = asyncio.create_task(DeskAdvisor(tmp_path / f"{digits}", poll_s=0.0).answer(question, ()))
        (folder,) = await open_questions(tmp_path / f"{digits}", 1)
        submit(folder, f'{{"selected_centroid_index": {"9" * digits}}}')
        return (await task).value.selected_centroid_index

    assert asyncio.run(run(400)) == int("9" * 400)
    with pytest.raises(BadAnswer):
        asyncio.run(run(5000))
