"""The page in a real browser."""

import json
import re
import threading

import pytest
from playwright.sync_api import expect
from pydantic import BaseModel, Field, RootModel

from coral.advisor.question import Question
from coral.desk.notice import mission_notice
from coral.reef.world.geometry import Pose, to_world

pytestmark = pytest.mark.browser
# Only a page that never gets there waits this long; a busy machine may need more than the usual 5 s.
expect.set_options(timeout=30_000)


class Object(BaseModel):
    label: str = Field(min_length=1, max_length=20)
    mass: float = Field(gt=0)


class Contact(BaseModel):
    count: int = Field(ge=0, le=30)
    direction: tuple[float, float, float]
    objects: list[Object] = Field(min_length=1)
    note: str | None


class Mass(BaseModel):
    mass: float = Field(gt=0)


class Masses(RootModel[dict[str, Mass]]):
    pass


class Program(BaseModel):
    code: str = ""


@pytest.fixture
def visit(browser, server):
    """Opens pages as operators of their own; afterwards, none of them may have complained."""
    contexts, complaints = [], []

    def one(operator="", width=1280, height=800, stale=None):
        contexts.append(browser.new_context(viewport={"width": width, "height": height}))
        page = contexts[-1].new_page()
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on(
            "console",
            lambda line: (
                line.type == "error"
                and "409" not in line.text
                and "422" not in line.text
                and complaints.append(line.text)
            ),
        )
        page.on(
            "request", lambda r: r.url.startswith((server.url.partition("?")[0], "data:")) or complaints.append(r.url)
        )
        if stale is not None:
            page.route("**/api/state", lambda route: route.fulfill(json=stale, headers={"ETag": "stale"}))
        page.goto(server.url)
        page.get_by_label("Operator").fill(operator)
        page.get_by_label("Operator").press("Enter")
        return page

    yield one
    for context in contexts:
        context.close()
    assert complaints == []


def click_map(page, case, x, y):
    """Click on a point of the world (m)."""
    expect(page.locator("#canvas")).to_be_visible()
    drawn = case.drawn_map()
    column, row = drawn.to_pixels([x, y])
    expect(page.locator("#picture")).not_to_have_js_property("naturalWidth", 0)
    box = page.locator("#picture").bounding_box()
    scale = box["width"] / drawn.rgb.shape[1]
    page.mouse.click(box["x"] + scale * column, box["y"] + scale * row)


def test_an_operator_clicks_a_dot_and_the_second_is_refused(visit, client, ask, case):
    asking = ask(case.reef_question(), case.refused("The chosen dot is behind the robot."))
    _, before = client("GET", "/api/state")
    ana, bo = visit("Ana"), visit("Bo", stale=before)
    for page in (ana, bo):
        expect(page.get_by_role("heading", name="Which oyster cluster next?")).to_be_visible()
        expect(page.locator("#refusal")).to_contain_text("The chosen dot is behind the robot.")
    x, y = case.dots[7]
    click_map(ana, case, x + 0.15, y - 0.1)
    expect(ana.get_by_role("radio", name="7")).to_be_checked()
    x, y = case.dots[4]
    click_map(bo, case, x, y)
    expect(bo.get_by_role("radio", name="4")).to_be_checked()
    ana.get_by_role("button", name="Submit").click()
    assert asking.result().selected_centroid_index == 7
    expect(ana.locator("#status")).to_contain_text("Sent")
    bo.get_by_role("button", name="Submit").click()
    expect(bo.locator("#send-fault")).to_have_text("This question is already answered by Ana.")
    expect(ana.locator("#history li")).to_have_count(1)


def test_questions_come_and_go_without_a_reload(visit, ask, case):
    page, watcher = visit("Ana"), visit("Bo")
    expect(page.get_by_role("heading", name="No question yet")).to_be_visible()
    first = ask(case.reef_question())
    expect(page.get_by_role("heading", name="Which oyster cluster next?")).to_be_visible()
    expect(watcher.get_by_role("heading", name="Which oyster cluster next?")).to_be_visible()
    page.locator("body").press("1")
    page.locator("body").press("2")
    expect(page.get_by_role("radio", name="12")).to_be_checked()
    page.locator("body").press("Enter")
    assert first.result().selected_centroid_index == 12
    expect(watcher.locator("#toast")).to_have_text("Question 1 was answered by Ana.")
    second = ask(case.reef_question("reef-waypoint"), case.refused("Dot 12 has been visited."))
    expect(watcher.get_by_role("heading", name="Where to next?")).to_be_visible()
    expect(watcher.locator("#history .why")).to_have_text("Dot 12 has been visited.")
    second.withdraw()
    expect(watcher.locator("#status")).to_contain_text("Withdrawn")


def test_who_answered_is_told_although_it_is_recorded_after_the_answer(visit, ask, case, tmp_path):
    asking, watcher = ask(case.reef_question()), visit("Bo")
    expect(watcher.get_by_role("heading", name="Which oyster cluster next?")).to_be_visible()
    folder = tmp_path / "inbox" / asking.id
    (folder / ".mine").write_text('{"selected_centroid_index": 12, "multi_step_plan": [], "reason": "next"}')
    (folder / ".mine").rename(folder / "answer.json")
    expect(watcher.get_by_role("heading", name="Answered", exact=False)).to_be_visible()
    (folder / ".by").write_text('{"operator": "Cleo", "answered_at": 1.0}')
    (folder / ".by").rename(folder / "operator.json")
    expect(watcher.locator("#toast")).to_have_text("Question 1 was answered by Cleo.")


def test_a_point_on_the_map_becomes_whole_metres_as_seen_on_arrival(visit, ask, case):
    asking = ask(case.reef_question("reef-waypoint"))
    page = visit()
    expect(page.get_by_role("heading", name="Where to next?")).to_be_visible()
    pose = case.reef_question().facts["arrival"]["pose"]
    x, y = to_world(Pose(**pose), 3.2, 1.7)
    click_map(page, case, x, y)
    expect(page.get_by_label("Forward (m)")).to_have_value("3")
    expect(page.get_by_label("Left (m)")).to_have_value("2")
    page.locator("body").press("ArrowUp")
    page.locator("body").press("ArrowRight")
    page.get_by_role("button", name="Zoom in").click()
    page.get_by_label("Reason").fill("Open water.")
    page.get_by_label("Reason").press("Enter")
    answer = asking.result()
    assert (answer.forward_m, answer.left_m, answer.reason) == (4, 1, "Open water.")


def test_bounds_are_checked_before_anything_is_sent_to_the_robot(visit, ask, case):
    asking = ask(case.reef_question("reef-waypoint"))
    page = visit()
    page.get_by_role("button", name="Submit").click()
    expect(page.locator("#send-fault")).to_have_text("Forward (m) is missing, and 1 more.")
    page.get_by_label("Forward (m)").fill("9")
    page.get_by_label("Left (m)").fill("0")
    page.get_by_role("button", name="Submit").click()
    expect(page.locator(".field.bad .fault")).to_have_text("does not fit: 9 is greater than the maximum of 6")
    page.get_by_label("Forward (m)").fill("-2")
    page.get_by_role("button", name="Submit").click()
    assert asking.result().forward_m == -2


def test_a_waypoint_answers_a_question_of_dots_and_a_dot_one_of_waypoints(visit, ask, case):
    dots, page = ask(case.reef_question()), visit()
    expect(page.get_by_role("heading", name="Which oyster cluster next?")).to_be_visible()
    page.get_by_role("radio", name="none").click()
    page.locator(".field", has_text="Waypoint").get_by_label("none (null)").uncheck()
    page.get_by_label("Forward (m)").fill("2")
    page.get_by_label("Left (m)").fill("-1")
    page.get_by_role("button", name="Submit").click()
    answer = dots.result()
    assert (answer.selected_centroid_index, answer.waypoint.forward_m, answer.waypoint.left_m) == (None, 2, -1)
    assert (answer.expect, answer.end_survey) == (None, False)
    waypoints = ask(case.reef_question("reef-waypoint"))
    expect(page.get_by_role("heading", name="Where to next?")).to_be_visible()
    page.get_by_label("Forward (m)").fill("0")
    page.get_by_label("Left (m)").fill("0")
    page.get_by_role("radio", name="7").click()
    page.get_by_label("none (null)").last.uncheck()
    page.get_by_label("What").fill("the line goes on")
    page.get_by_role("button", name="Submit").click()
    answer = waypoints.result()
    assert (answer.dot, answer.expect.what, answer.expect.forward_m) == (7, "the line goes on", None)


def test_nested_answers_have_a_form_and_a_text(visit, ask):
    asking = ask(Question(kind="some-contacts", prompt="Where?", answer_type=Contact, facts={}))
    page = visit()
    expect(page.get_by_role("heading", name="Some contacts")).to_be_visible()
    page.get_by_label("Count").fill("12")
    for k, value in enumerate(("0", "0.5", "-1")):
        page.get_by_label(f"entry {k + 1}").fill(value)
    page.get_by_role("button", name="Add an entry").click()
    page.get_by_label("Label").fill("mug")
    page.get_by_label("Mass").fill("0")
    page.get_by_label("none (null)").check()
    page.get_by_role("button", name="Submit").click()
    expect(page.locator(".nested .field.bad .fault")).to_have_text(
        "does not fit: 0 is less than or equal to the minimum of 0"
    )
    page.get_by_role("button", name="Edit as JSON").click()
    text = page.get_by_label("Answer as JSON")
    assert json.loads(text.input_value()) == {
        "count": 12,
        "direction": [0, 0.5, -1],
        "objects": [{"label": "mug", "mass": 0}],
        "note": None,
    }
    text.fill("{")
    page.get_by_role("button", name="Submit").click()
    expect(page.locator("#send-fault")).to_contain_text("is not valid JSON")
    text.fill('{"count": 3, "direction": [1, 0, 0], "objects": [{"label": "mug", "mass": 0.4}], "note": "so"}')
    page.get_by_role("button", name="Submit").click()
    answer = asking.result()
    assert (answer.count, answer.direction, answer.objects[0].mass, answer.note) == (3, (1, 0, 0), 0.4, "so")


def test_an_answer_by_object_has_an_entry_for_each_of_them(visit, ask):
    asking = ask(
        Question(
            kind="physical-parameters",
            prompt="How heavy?",
            answer_type=Masses,
            facts={"objects": {"mug": {}, "can": {}}},
        )
    )
    page = visit()
    expect(page.get_by_role("heading", name="How heavy, how rough?")).to_be_visible()
    names = page.get_by_label("name")
    expect(names).to_have_count(2)
    page.get_by_label("Mass").first.fill("0.4")
    page.get_by_role("button", name="Remove").nth(1).click()
    page.get_by_role("button", name="Add a name").click()
    names.nth(1).fill("mug")
    page.get_by_label("Mass").nth(1).fill("0.1")
    page.get_by_role("button", name="Submit").click()
    expect(page.locator("#send-fault")).to_contain_text("appears twice")
    names.nth(1).fill("lid")
    page.get_by_role("button", name="Submit").click()
    assert asking.result().model_dump() == {"mug": {"mass": 0.4}, "lid": {"mass": 0.1}}


def test_a_program_is_typed_like_one(visit, ask):
    asking = ask(Question(kind="cost-function", prompt="What is wanted?", answer_type=Program, facts={}))
    page = visit()
    expect(page.get_by_role("article", name="The question")).to_have_text("What is wanted?")
    code = page.get_by_label("Code")
    code.press_sequentially("def state_cost(self):")
    code.press("Enter")
    code.press("Tab")
    code.press_sequentially("return 1")
    page.get_by_role("button", name="Submit").click()
    assert asking.result().code == "def state_cost(self):\n    return 1"


def test_the_end_of_a_mission_is_shown(visit, ask, case, tmp_path):
    page = visit()
    with mission_notice(tmp_path / "inbox", world="s1", run="runs/s1-001") as notice:
        expect(page.locator("#mission")).to_have_text("s1 · under way · runs/s1-001")
        asking = ask()
        expect(page.get_by_role("heading", name="Pick")).to_be_visible()
        page.get_by_role("radio", name="3").click()
        page.get_by_role("button", name="Submit").click()
        assert asking.result().index == 3
        notice.finished("8 of 8 oyster clusters covered")
    expect(page.get_by_role("heading", name="Mission finished")).to_be_visible()
    expect(page.get_by_text("8 of 8 oyster clusters covered")).to_be_visible()
    page.locator("#history button").click()
    expect(page.locator("#status")).to_contain_text("Answered")
    expect(page.get_by_role("button", name="Submit")).to_be_hidden()


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (820, 1180), (1180, 820)])
def test_picture_and_submit_are_in_reach_on_desks_and_tablets(visit, ask, case, width, height):
    ask(case.reef_question())
    page = visit(width=width, height=height)
    expect(page.get_by_role("tab", name=re.compile("map"))).to_be_visible()
    expect(page.locator("#picture")).not_to_have_js_property("naturalWidth", 0)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    view = page.locator("#view").bounding_box()
    submit = page.get_by_role("button", name="Submit").bounding_box()
    assert min(view["width"], view["height"]) > 400
    assert submit["y"] + submit["height"] <= height


def test_text_from_an_inbox_is_never_markup(visit, ask):
    evil = "<img src=x onerror=document.title='owned'><script>document.title='owned'</script>"
    ask(Question(kind="pick", prompt=evil, answer_type=Object, facts={"x": evil}))
    page = visit()
    expect(page.get_by_role("article", name="The question")).to_have_text(evil)
    assert "owned" not in page.title()


def test_the_page_is_for_all_eyes(visit, ask, case, check_for_all_eyes):
    page = visit("Ana")
    expect(page.get_by_role("heading", name="No question yet")).to_be_visible()
    check_for_all_eyes(page)
    ask(case.reef_question(), case.refused("The chosen dot is behind the robot."))
    expect(page.get_by_role("heading", name="Which oyster cluster next?")).to_be_visible()
    check_for_all_eyes(page)


def test_the_instruction_of_a_mission_in_words_is_shown_and_changed(visit, tmp_path):
    told, heard = [], threading.Event()

    def instruct(words, by):
        told.append((words, by))
        notice.hear({"event": "instruction", "text": words})
        heard.set()
        return True

    with mission_notice(tmp_path / "inbox", instruct, world="a-net", instruction="Find the net.") as notice:
        page = visit("Ana")
        expect(page.locator("#instruction")).to_have_text("Find the net.")
        page.once("dialog", lambda dialog: dialog.accept("Find the tyre."))
        page.get_by_role("button", name="Change").click()
        expect(page.locator("#instruction")).to_have_text("Find the tyre.")
        assert heard.wait(60.0)
        expect(page.locator("#toast")).to_contain_text("Sent.")
    expect(page.locator("#told")).to_be_hidden()
    assert told == [("Find the tyre.", "Ana at the desk")]


def test_a_dot_of_a_mission_in_words_is_clicked_or_looked_at(visit, ask, case):
    asking, page = ask(case.reef_question("reef-mission")), visit("Ana")
    expect(page.get_by_role("heading", name="What next, for the instruction?")).to_be_visible()
    click_map(page, case, *case.dots[7])
    expect(page.get_by_role("radio", name="7")).to_be_checked()
    page.get_by_role("radio", name="none").first.click()
    look = page.locator(".field", has=page.get_by_text("Look", exact=True)).last
    look.get_by_label("none (null)").uncheck()
    look.get_by_role("radio", name="4").click()
    look.get_by_role("radio", name="far").click()
    page.get_by_role("button", name="Submit").click()
    answer = asking.result()
    assert (answer.selected_centroid_index, answer.look.dot, answer.look.side) == (None, 4, "far")
