import json
import re
import shutil

import pytest
import yaml

from coral.errors import InputError
from coral.reef.mission.metrics import OWN_MAP
from coral.view.report import write_report


def page(folder):
    return write_report(folder).read_text("utf-8")


@pytest.fixture(scope="module")
def told(finished, tmp_path_factory):
    """The page of the finished run as it is."""
    return page(shutil.copytree(finished, tmp_path_factory.mktemp("told") / "run"))


def script_data(html):
    return json.loads(re.search(r"const RUN = (\{.*?\});\n", html, re.S).group(1))


def test_a_finished_run_is_told_in_full(told):
    assert "covered 2 of 3 oyster clusters" in told
    assert "1 collision" in told
    assert "far not reached" in told
    assert "north ✓" in told
    assert "The chosen centroid is behind the robot." in told
    assert "at least 60 %" in told  # the paper's definition beside the number
    for word in ("heuristic", "abc123", "test, 2 cores", "time limit", "Complete configuration"):
        assert word in told
    assert "interrupted" not in told
    assert told.count('<details class="decision"') == 3
    assert told.count('class="decision good"') + told.count('class="decision again"') == 2
    assert told.count("data:image/webp") == 15  # five questions of three pictures


def test_the_page_loads_nothing(told):
    assert not re.search(r"https?://", told)
    assert not re.search(r"@import|<link|<iframe|fetch\(|XMLHttpRequest|url\((?!#)", told)
    for address in re.findall(r'(?:src|href)="([^"]*)"', told):
        assert address.startswith(("data:", "#")) or address == "mission.mp4"


def test_no_id_is_given_twice(told):
    ids = re.findall(r'<[^<>]* id="([^"]*)"', told)
    assert len(ids) == len(set(ids))


def test_text_from_the_run_is_never_markup(told):
    assert "<reef>" not in told
    assert "<the>" not in told
    assert "made-up &lt;reef&gt;" in told


def test_a_hostile_answer_cannot_end_the_script(fresh):
    lines = (fresh / "events.jsonl").read_text().replace("Unexplored water beyond it.", "</script><b>x</b>")
    (fresh / "events.jsonl").write_text(lines)
    html = page(fresh)
    assert html.count("</script>") == 1
    assert any("</script>" in d["why"] for d in script_data(html)["decisions"])


def test_the_slider_has_snapshots_and_positions(told):
    data = script_data(told)
    assert [frame["t"] for frame in data["frames"]] == [2.0 * k for k in range(21)]
    assert all({"map", "seg", "dep"} <= set(frame) for frame in data["frames"])
    assert len({len(data[key]) for key in "txyasck"}) == 1
    assert data["t"][-1] == data["end"] == 40.0
    assert data["gx"][0] is None


def test_snapshots_are_thinned_to_the_budget(fresh, monkeypatch):
    monkeypatch.setattr("coral.view.time_slider.FRAME_BUDGET", 25_000)
    frames = script_data(page(fresh))["frames"]
    assert 1 < len(frames) < 21
    assert frames[-1]["t"] == 40.0
    assert sum(len(v) for f in frames for v in f.values() if isinstance(v, str)) <= 25_000


def test_a_killed_run_is_told_as_far_as_it_went(killed):
    html = page(killed)
    assert "This run was interrupted." in html
    assert "had covered 2 of 3 oyster clusters" in html
    assert "line was cut off" in html or "was cut off while it was written" in html
    assert html.count('<details class="decision"') == 3


def test_a_run_that_recorded_almost_nothing(fresh):
    for name in ("events.jsonl", "trajectory.csv", "attempts.jsonl"):
        (fresh / name).write_text("")
    for name in ("metrics.json", "timing.json", "world.yaml"):
        (fresh / name).unlink()
    for file in (fresh / "frames").iterdir():
        file.unlink()
    html = page(fresh)
    assert "Nothing was recorded" in html
    assert "never asked" in html


def test_a_mapped_cluster_that_is_none_is_told_and_so_is_what_lies_there(fresh):
    metrics = json.loads((fresh / "metrics.json").read_text())
    (fresh / "metrics.json").write_text(json.dumps({**metrics, "phantom_clusters": 1}))
    world = yaml.safe_load((fresh / "world.yaml").read_text())
    net = {"name": "net", "kind": "ghost-net", "x": 4.0, "y": 4.0}
    (fresh / "world.yaml").write_text(yaml.safe_dump({**world, "things": [net]}))
    html = page(fresh)
    assert "One of the clusters that it mapped is no oysters." in html
    assert ">net (ghost net)</text>" in html


def test_a_final_map_alone_is_shown_as_one(fresh):
    for file in (fresh / "frames").iterdir():
        if file.name != "000400_map.png":
            file.unlink()
    html = page(fresh)
    assert "the map shows its final state only" in html
    assert '<image id="cells"' in html
    assert 'id="now-seg"' not in html


def test_broken_pictures_are_left_out(fresh):
    (fresh / "pictures" / "00map.png").write_bytes(b"not a picture")
    (fresh / "pictures" / "10depth.png").unlink()
    (fresh / "frames" / "000400_map.png").write_bytes(b"\x89PNG")
    assert page(fresh).count("picture not kept") == 2


def test_a_report_is_replaced_and_a_missing_run_is_named(fresh, tmp_path):
    assert write_report(fresh) == write_report(fresh) == fresh / "report.html"
    assert not list(fresh.glob("*.part"))
    with pytest.raises(InputError, match="nowhere"):
        write_report(tmp_path / "nowhere")


def test_a_planted_link_leads_no_report_to_another_file(fresh, tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("mine")
    for name in ("report.html", "report.html.part", "map.png", "map.png.part"):
        (fresh / name).unlink(missing_ok=True)
        (fresh / name).symlink_to(precious)
    write_report(fresh)
    assert precious.read_text() == "mine"


def test_a_picture_shown_twice_is_held_once(fresh, told):
    once = told.count("data:image/webp")
    text = (fresh / "events.jsonl").read_text().replace('"10map"', '"00map"')
    (fresh / "events.jsonl").write_text(text)
    html = page(fresh)
    assert html.count("data:image/webp") == once - 1
    assert html.count('data-picture="00map"') == 2


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        (
            {"sim_time_s": 86.0, "clusters_covered": 6, "clusters_total": 6},
            "The robot covered all 6 oyster clusters and surveyed for 1 min 26 s over ",
        ),
        (
            {"sim_time_s": 22.0, "clusters_covered": 1, "clusters_total": 1},
            "The robot covered the only oyster cluster and surveyed for 22 s over ",
        ),
        (
            {"sim_time_s": 22.0, "clusters_covered": 0, "clusters_total": 1},
            "The robot covered 0 of 1 oyster cluster and surveyed for 22 s over ",
        ),
        ({"requeries": 1}, "1 re-query among them<"),
    ],
)
def test_the_headline_tells_the_time_of_the_whole_survey(fresh, changed, said):
    metrics = json.loads((fresh / "metrics.json").read_text())
    (fresh / "metrics.json").write_text(json.dumps({**metrics, **changed}))
    assert said in page(fresh)


def test_the_headline_says_when_someone_else_than_the_advisor_decided(fresh, told):
    metrics = json.loads((fresh / "metrics.json").read_text())
    assert "The advisor decided" not in told
    answers = {"accepted": 1, "refused": 0, "malformed": 0, "missing": 4}
    metrics |= {"decided_by": {"advisor": 1, "memory": 0, "recording": 0, "fallback": 2}, "answers": answers}
    (fresh / "metrics.json").write_text(json.dumps(metrics))
    html = page(fresh)
    assert "The advisor decided 1 of 3 goals, the fallback&#39;s rules 2." in html
    assert "accepted 1, refused 0, malformed 0, missing 4" in html
    config = (fresh / "config.yaml").read_text() + "mission: {pilot: {fallback: hold}}\n"
    (fresh / "config.yaml").write_text(config)
    assert "The advisor decided 1 of 3 goals, nobody 2 (hold)." in page(fresh)


def append(folder, **event):
    with open(folder / "events.jsonl", "a", encoding="utf-8") as log:
        log.write(json.dumps({"step": 1, "t": 0.1, **event}) + "\n")


def test_a_vehicle_that_was_held_has_its_states_listed(fresh):
    append(fresh, event="state", state="surveying", by="guard", reason="sensors good")
    assert "States of the vehicle" not in page(fresh)
    append(fresh, event="state", state="holding", by="guard", reason="camera <blind>, for 0.4 s")
    html = page(fresh)
    assert "States of the vehicle" in html
    assert "camera &lt;blind&gt;, for 0.4 s" in html


def test_what_the_robot_left_is_listed_with_its_reason(fresh, told):
    assert "What is left" not in told
    append(fresh, event="left", clusters=[{"index": 7, "x": 1.5, "y": 2.0, "why": "seen from afar only"}])
    html = page(fresh)
    assert "7 at (1.5, 2.0) m" in html
    assert "seen from afar only" in html


def with_events(folder, *events):
    with (folder / "events.jsonl").open("a") as file:
        file.writelines(json.dumps({"step": 400, "t": 40.0, **event}) + "\n" for event in events)


def test_a_mission_in_words_has_its_instruction_its_answer_and_what_the_judge_found(fresh):
    said = [{"dot": 1, "x": 9.0, "y": 9.0, "label": "<tyre>", "skip": True, "why": "A black ring."}]
    condition = {"condition": "kept_off", "met": False, "found": "1.20 m, 2 m wanted"}
    verdict = {"text": "Find the net.", "met": False, "answer": "one net", "conditions": [condition]}
    told = {"event": "instruction", "text": "Find the net.", "by": "start"}
    with_events(fresh, told, {"event": "held", "said": said}, {"event": "judged", "instruction": verdict})
    html = page(fresh)
    for words in (
        "Mission: not fulfilled",
        "<b>“one net”</b>",
        "1.20 m, 2 m wanted",
        "A black ring.",
        "&lt;tyre&gt;, ruled out",
    ):
        assert words in html
    assert "was changed under way" not in html
    assert 'data-layer="marks"' in html


def test_words_that_were_changed_are_listed_and_said_to_be_judged_by_nobody(fresh):
    first, second = (
        {"event": "instruction", "text": f"Find {n} nets.", "by": by} for n, by in ((1, "start"), (2, "page"))
    )
    verdict = {"text": "Find 2 nets.", "met": None, "answer": None, "conditions": []}
    with_events(fresh, first, second, {"event": "judged", "instruction": verdict})
    html = page(fresh)
    for words in ("Mission: not judged", "<blockquote>Find 2 nets.", "was changed under way", "Find 1 nets."):
        assert words in html
    assert "Nobody judges it: no conditions are known" in html


def test_at_sea_the_answer_stands_alone_and_the_report_says_why(fresh):
    verdict = {"text": "Find the net.", "met": None, "answer": "a net", "conditions": []}
    start = {"event": "start", "judged_by": OWN_MAP}
    with_events(fresh, start, {"event": "judged", "instruction": verdict})
    html = page(fresh)
    assert "<b>“a net”</b>" in html
    assert "Nobody judges it: at sea nobody knows the truth." in html


def test_figures_by_the_vehicles_own_map_are_said_to_be_so(fresh):
    assert "True clusters:" in page(fresh)
    assert "of its own map" not in page(fresh)
    assert "<dt>collisions" in page(fresh)
    with_events(fresh, {"event": "start", "judged_by": OWN_MAP})
    html = page(fresh)
    for words in ("oyster clusters of its own map", "contacts are not judged", "clusters on the vehicle&#39;s own map"):
        assert words in html
    for words in (
        "True clusters:",
        "true oyster clusters of which at least 60 % has",
        "True distance",
        "without touching anything",
        "<dt>collisions",
        'data-layer="truth"',
    ):
        assert words not in html


def test_where_nobody_knows_the_error_the_report_says_what_was_corrected(fresh):
    with_events(fresh, {"event": "start", "judged_by": OWN_MAP})
    found = json.loads((fresh / "metrics.json").read_text())
    known = {"position_error_m": None, "odometry_error_m": None, "corrected_m": 0.8, "position_sigma_m": 0.07}
    (fresh / "metrics.json").write_text(json.dumps({**found, **known}))
    html = page(fresh)
    assert "<dt>position corrected at the end</dt><dd>0.80 m" in html
    assert "nobody knows the error, it reckons with 0.07 m" in html


def test_another_mission_has_no_section_of_its_own(fresh):
    assert 'id="mission"' not in page(fresh)


def test_a_reef_without_oysters_is_told_by_its_mission_alone(fresh):
    lines = [json.loads(line) for line in (fresh / "events.jsonl").read_text().splitlines()]
    lines = [{**e, **({"clusters_total": 0} if e["event"] == "start" else {})} for e in lines]
    lines = [e for e in lines if e["event"] != "cluster_covered"]
    (fresh / "events.jsonl").write_text("".join(json.dumps(e) + "\n" for e in lines))
    world = yaml.safe_load((fresh / "world.yaml").read_text())
    (fresh / "world.yaml").write_text(yaml.safe_dump({**world, "clusters": []}))
    (fresh / "metrics.json").unlink()
    verdict = {"text": "Find the net.", "met": False, "answer": None, "conditions": [{"condition": "a", "met": True}]}
    told = {"event": "instruction", "text": "Find the net.", "by": "start"}
    with_events(fresh, told, {"event": "judged", "clusters": [], "instruction": verdict})
    html = page(fresh)
    assert "1 of 1 conditions met" in html
    for words in ("oyster clusters over", "each mark is one", "0 of 0"):
        assert words not in html


def test_where_a_resumed_survey_was_on_the_saved_map_is_told(fresh):
    assert "Saved map" not in page(fresh)
    for recognised, said in (
        (0, "none of 9 landmarks recognised"),
        (4, "4 of 9 landmarks recognised, odometry off by 0.50 m"),
    ):
        place = {"step": 9, "t": 0.9, "event": "place", "landmarks": 9, "recognised": recognised}
        with open(fresh / "events.jsonl", "a") as events:
            events.write(json.dumps({**place, "x": 0.3, "y": 0.4, "theta": 0.0}) + "\n")
        assert f"Saved map: {said}" in page(fresh)


def test_how_the_advisors_guesses_came_out_is_told(fresh):
    assert "guesses" not in page(fresh)
    with open(fresh / "events.jsonl", "a") as events:
        events.writelines(
            json.dumps({"step": 9, "t": 0.9, "event": "guess", "x": 1.0, "y": 2.0, "hit": hit}) + "\n"
            for hit in (True, False, None, True)
        )
    assert "Of 3 guesses of its advisor that the robot looked at, 2 proved right." in page(fresh)


def test_how_far_eyes_that_doubt_saw_is_told(fresh):
    assert "sea floor up to" not in page(fresh)
    with open(fresh / "events.jsonl", "a") as events:
        events.writelines(
            json.dumps({"step": 9, "t": 0.9, "event": "sight", "reach_m": reach}) + "\n" for reach in (4.8, 2.2, "far")
        )
    assert "By the last pictures, the eyes tell oysters from sea floor up to 2.2 m away." in page(fresh)


def test_a_survey_whose_eyes_judged_nothing_leads_with_it(fresh):
    with open(fresh / "events.jsonl", "a") as events:
        events.write(json.dumps({"step": 9, "t": 0.9, "event": "sight", "reach_m": 0.0}) + "\n")
    text = page(fresh)
    assert text.index("Not judged. By the last pictures, the eyes judge nothing here") < text.index("The robot covered")
