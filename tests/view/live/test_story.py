from coral.view.live.story import Story, told


def event(t, kind, **fields):
    return {"t": t, "step": round(10 * t), "event": kind, **fields}


def test_a_failure_that_lasts_is_one_line():
    story = Story()
    for t in (1.0, 1.1, 1.2):
        story = told(story, event(t, "planner_failure", reason="no way"))
    assert story.log == ("0:01 no way found: no way",)


def test_the_story_counts_and_forgets_what_is_old():
    story = Story()
    for k in range(20):
        story = told(story, event(k, "question", decision=k, attempt=k % 2, mode="centroid"))
        story = told(
            story, event(k, "verdict", verdict="rejected", reason="too far", answer={"selected_centroid_index": k})
        )
    assert (story.calls, story.requeries, story.asked) == (20, 10, None)
    assert (story.answered.said, story.answered.reason) == ("centroid 19", "too far")
    assert len(story.log) == 6
    assert story.log[0].endswith("rejected: centroid 19")
    assert told(story, event(30, "something new")) is story


def test_the_state_of_the_vehicle_and_its_reason_are_told():
    story = told(Story(), event(2.0, "sensor", input="camera", refused="blind", detail=""))
    story = told(story, event(2.3, "state", state="holding", reason="camera blind, for 0.4 s"))
    story = told(story, event(6.0, "sensor", input="camera", refused=""))
    assert story.state == "holding"
    assert story.log == ("0:06 camera is good again", "0:02 holding: camera blind, for 0.4 s", "0:02 camera blind")
