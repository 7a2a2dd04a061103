import json

import pytest


def test_the_page_is_one_file_that_loads_nothing_from_elsewhere(client):
    response, page = client("GET", "/", raw=True)
    assert response.status == 200
    assert response.headers["Content-Type"].startswith("text/html")
    assert "default-src 'none'" in response.headers["Content-Security-Policy"]
    assert "'unsafe" not in response.headers["Content-Security-Policy"]
    text = page.decode().replace("http://www.w3.org/2000/svg", "")
    assert "http://" not in text
    assert "https://" not in text
    assert '<link rel="stylesheet' not in text
    assert "<script src" not in text


def test_a_question_is_asked_shown_and_answered(client, ask, case):
    asking = ask(case.reef_question(), case.refused("behind you"))
    status, question = client("GET", f"/api/questions/{asking.id}")
    assert status == 200
    assert question["rejections"][0]["reason"] == "behind you"
    assert question["picture_frames"]["map.png"]["pixel_from_world"][0][0] > 0
    response, png = client("GET", f"/pictures/{asking.id}/map.png", raw=True)
    assert response.headers["Content-Type"] == "image/png"
    assert response.headers["X-Content-Type-Options"] == "nosniff"
    assert png == case.reef_question().pictures[0].png
    assert client.answer(asking.id, {"selected_centroid_index": 7, "reason": ""}, "  Ana\n B.") == (200, {"ok": True})
    assert asking.result().selected_centroid_index == 7
    _, state = client("GET", "/api/state")
    assert state["questions"][0]["operator"] == "Ana B."


def test_the_second_operator_is_told_who_was_first(client, ask):
    asking = ask()
    assert client.answer(asking.id, {"index": 1}, "Ana")[0] == 200
    status, reply = client.answer(asking.id, {"index": 2}, "Bo")
    assert (status, reply["error"]) == (409, "This question is already answered by Ana.")
    assert asking.result().index == 1


def test_an_unfit_answer_is_refused_with_reasons(client, ask):
    asking = ask()
    status, reply = client.answer(asking.id, {"index": 9, "reason": "x" * 41})
    assert status == 422
    assert [fault["place"] for fault in reply["faults"]] == ["index", "reason"]
    assert client.answer(asking.id, {"index": 0})[0] == 200


def test_a_page_gets_the_state_only_when_it_has_changed(client, ask):
    response, _ = client("GET", "/api/state", raw=True)
    seen = {"If-None-Match": response.headers["ETag"]}
    assert client("GET", "/api/state", headers=seen) == (304, None)
    asking = ask()
    status, state = client("GET", "/api/state", headers=seen)
    assert (status, [q["state"] for q in state["questions"]]) == (200, ["open"])
    client.answer(asking.id, {"index": 1})
    assert client("GET", "/api/state")[1]["questions"][0]["answer"] == {"index": 1}


def test_only_the_latest_questions_are_listed(client, ask, monkeypatch):
    monkeypatch.setattr("coral.desk.server.RECENT", 2)
    asked = [ask() for _ in range(3)]
    assert [q["id"] for q in client("GET", "/api/state")[1]["questions"]] == [one.id for one in asked[1:]]


def test_the_instruction_of_a_mission_in_words_is_shown_and_changed(client, server):
    folder = server.inbox.folder
    (folder / "mission-here-1.json").write_text(json.dumps({"state": "running", "instruction": "Find it."}))
    (mission,) = client("GET", "/api/state")[1]["missions"]
    assert (mission["id"], mission["instruction"]) == ("here-1", "Find it.")
    path = f"/api/missions/{mission['id']}/instruction"
    assert client.post(path, {"instruction": "Find the net.", "operator": " Ana\n"}) == (200, {"ok": True})
    told = json.loads((folder / "instruction-here-1.json").read_text())
    assert told == {"instruction": "Find the net.", "operator": "Ana"}
    assert client.post(path, {"instruction": " "})[0] == 422
    assert client.post(path, {"instruction": 7})[0] == 400
    assert client.post("/api/missions/..%2fhere-1/instruction", {"instruction": "Find it."})[0] == 404
    (folder / "mission-here-1.json").write_text(json.dumps({"state": "finished", "instruction": "Find it."}))
    assert client.post(path, {"instruction": "Find it."}) == (409, {"error": "The mission has ended."})


@pytest.mark.parametrize(
    "path",
    [
        "/pictures/../../etc/passwd",
        "/pictures/000001-pick/..%2f..%2fsecret.png",
        "/pictures/..%2f/map.png",
        "/pictures/000001-pick/question.json",
        "/pictures/000001-pick/%2e%2e",
        "/pictures/%00/map.png",
        "//etc/passwd",
        "/api/questions/..",
        "/api/questions/..%2f..",
        "/api/questions/000002-pick",
        "/favicon.ico",
        "/page.html",
        "/api",
    ],
)
def test_there_is_no_way_out_of_the_inbox(client, ask, tmp_path, path):
    ask()
    (tmp_path / "secret.png").write_bytes(b"\x89PNG\r\n\x1a\nsecret")
    status, reply = client("GET", path)
    assert status == 404
    assert set(reply) == {"error"}


def test_other_sites_cannot_answer(client, ask):
    asking = ask()
    path, body = f"/api/questions/{asking.id}/answer", json.dumps({"answer": {"index": 1}})
    # What a page elsewhere can send without asking first: a form, or text without headers of its own.
    for kind in ("text/plain", "application/x-www-form-urlencoded", "application/json"):
        assert client("POST", path, body, {"Content-Type": kind})[0] == 403
    assert client.answer(asking.id, {"index": 1}, Origin="http://evil.example")[0] == 403
    assert client.answer(asking.id, {"index": 1}, Origin="null")[0] == 403
    assert client("OPTIONS", path, raw=True)[0].status == 405
    assert client("GET", "/api/state")[1]["questions"][0]["state"] == "open"
    assert client.answer(asking.id, {"index": 1}, Origin=f"http://127.0.0.1:{client.port}")[0] == 200


@pytest.mark.parametrize("body", ["{}", '{"answer": 1, "operator": 2}'])
def test_a_request_without_an_answer_is_refused(client, ask, body):
    asking = ask()
    sent = {"X-Coral": "1", "Content-Type": "application/json"}
    found, reply = client("POST", f"/api/questions/{asking.id}/answer", body, sent)
    assert found == 400
    assert reply["error"]
    assert client("GET", "/api/state")[1]["questions"][0]["state"] == "open"


def test_posting_elsewhere_is_refused(client):
    for path in ("/", "/api/questions/000001-pick", "/api/questions/a/b/answer"):
        assert client("POST", path, "{}", {"X-Coral": "1", "Content-Type": "application/json"})[0] in (404, 405)
    assert client.answer("000001-pick", {})[0] == 404


@pytest.mark.parametrize("digits", [400, 4000])
def test_a_number_of_many_digits_is_refused_with_a_reason(client, ask, digits):
    asking = ask()
    status, reply = client.answer(asking.id, {"index": int("9" * digits)})
    assert status == 422
    assert reply["faults"][0]["place"] == "index"
    assert client.answer(asking.id, {"index": 1})[0] == 200
