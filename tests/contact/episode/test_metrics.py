import pytest

from coral.contact.episode.metrics import DEFINITIONS, compute_metrics, metrics_of
from coral.errors import InputError

EVENTS = [
    {"step": 0, "t": 0.0, "event": "start", "poses": "ground-truth", "trial": {"box": {}}},
    {"step": 0, "t": 0.0, "event": "strategy", "name": "pick"},
    {"step": 0, "t": 0.0, "event": "stage", "before": None, "stage": "reach"},
    {"step": 0, "t": 0.0, "event": "contact", "first": "box", "second": "table"},
    {"step": 0, "t": 0.0, "event": "plan", "ess": 2.0, "diverged": 1, "stage": "reach", "cost": 4.0},
    {"step": 2, "t": 0.04, "event": "plan", "ess": 4.0, "diverged": 0, "stage": "reach", "cost": 3.0},
    {"step": 2, "t": 0.04, "event": "policy", "call": 1},
    {"step": 2, "t": 0.04, "event": "contact", "first": "box", "second": "left"},
    {"step": 2, "t": 0.04, "event": "stage", "before": "reach", "stage": "close"},
    {
        "step": 4,
        "t": 0.08,
        "event": "end",
        "reason": "success",
        "advisor_calls": 3,
        "repairs": 1,
        "memory_hit": True,
    },
]
ROWS = [
    {"step": str(k), "t": str(0.02 * k), "x": "0", "y": str(0.01 * k), "z": "0.1", "box_hand_force": str(force)}
    for k, force in enumerate((0.0, 0.0, 0.0, 3.0, 5.0))
]


def test_metrics_of_a_finished_episode():
    found = metrics_of(EVENTS, ROWS)
    assert found == {
        "success": True,
        "end_reason": "success",
        "end_detail": "",
        "sim_time_s": 0.08,
        "time_with_thinking_s": 0.08,
        "decided_by": {"advisor": 0, "memory": 0, "recording": 0, "fallback": 0},
        "answers": {"accepted": 0, "refused": 0, "malformed": 0, "missing": 0},
        "tokens_in": 0,
        "tokens_out": 0,
        "cost_usd": 0.0,
        "thinking_s": 0.0,
        "steps": 4,
        "plans": 2,
        "policy_calls": 1,
        "stages": 1,
        "strategy": "pick",
        "advisor_calls": 3,
        "repairs": 1,
        "interventions": 0,
        "memory_hit": True,
        "path_length_m": 0.04,
        "peak_hand_force_n": 5.0,
        "mean_hand_force_n": 4.0,
        "contact_time_s": 0.04,
        "contacts": 1,
        "first_touch_s": 0.04,
        "plan_cost": 3.5,
        "plan_cost_jump": 1.0,
        "plan_late_ms_median": 0.0,
        "effective_samples": 3.0,
        "diverged_rollouts": 1,
        "track_lost": 0,
        "track_recovered": 0,
        "track_lost_s": 0.0,
        "pose_error_mm": None,
        "pose_error_deg": None,
        "judged_by": "truth",
        "poses": "ground-truth",
        "tracker": "",
    }
    assert set(found) == set(DEFINITIONS)


def test_the_tracker_is_named_where_there_is_one():
    start = {**EVENTS[0], "event": "start", "poses": "tracked"}
    assert metrics_of([{**start, "tracker": "foundationpose"}], [])["tracker"] == "foundationpose"
    assert metrics_of([{**start, "poses": "guessed"}], [])["tracker"] == ""


def test_a_killed_episode_is_no_success():
    found = metrics_of(EVENTS[:-1], ROWS[:3])
    assert (found["success"], found["end_reason"], found["mean_hand_force_n"]) == (False, "killed", None)


def test_half_a_last_line_is_left_out(tmp_path):
    (tmp_path / "events.jsonl").write_text('{"step": 0, "t": 0, "event": "start", "poses": "x"}\n{"step": 1, "t"')
    (tmp_path / "trajectory.csv").write_text("step,t,x,y,z,box_hand_force\n0,0,0,0,0,0\n1,0.02,0,0,0.01,0\n2,0.04,9")
    assert compute_metrics(tmp_path)["steps"] == 1


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"events\.jsonl"):
        compute_metrics(tmp_path)


def test_losses_and_errors_of_tracked_poses_are_counted():
    events = [{"event": "track", "step": 1, "lost": True}, {"event": "track", "step": 2, "lost": False}]
    rows = [
        {
            "step": str(k),
            "t": str(0.1 * k),
            "x": "0",
            "y": "0",
            "z": "0",
            "box_off_m": str(0.001 * k),
            "box_off_rad": "0.1",
            "box_lost": str(int(k == 2)),
        }
        for k in range(1, 4)
    ]
    found = metrics_of(events, rows)
    assert (found["track_lost"], found["track_recovered"], found["track_lost_s"]) == (1, 1, 0.1)
    assert (found["pose_error_mm"], found["pose_error_deg"]) == (2.0, 5.73)


def test_time_in_which_an_advisor_was_thinking_is_told_apart():
    passed = [
        {"event": "thinking", "t": 0.0, "seconds": 2.3, "meanwhile": "before"},
        {"event": "thinking", "t": 0.06, "seconds": 0.04, "meanwhile": "holding still"},
    ]
    found = metrics_of([*passed, *EVENTS], ROWS)
    assert (found["sim_time_s"], found["time_with_thinking_s"]) == (0.04, 2.38)


def test_without_truth_contacts_and_forces_are_unknown_not_zero():
    start = {**EVENTS[0], "judged_by": "operator"}
    found = metrics_of([start, *EVENTS[1:3], EVENTS[-1]], [{**row, "box_hand_force": ""} for row in ROWS])
    assert found["judged_by"] == "operator"
    unknown = ("peak_hand_force_n", "mean_hand_force_n", "contact_time_s", "contacts", "first_touch_s")
    assert [found[name] for name in unknown] == [None] * 5
