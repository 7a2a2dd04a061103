import itertools
import json
import math

import numpy as np
import pytest

from coral.reef.mission.outcome import (
    DEFINITIONS,
    area_under,
    driven_back,
    excursions,
    outcome_metrics,
    share_at,
    time_to,
)


def test_times_and_area_of_a_curve_by_hand():
    t, share = np.array([0.0, 100.0, 200.0]), np.array([0.0, 0.5, 1.0])
    assert [time_to(t, share, s) for s in (0.5, 0.8, 1.0)] == [100.0, 200.0, 200.0]
    assert time_to(t, share * 0.9, 1.0) is None
    # 100 s at 0, 100 s at a half, then 1 held until 600 s.
    assert area_under(t, share) == round((50 + 400) / 600, 4)
    assert area_under(t, share, horizon_s=150.0) == round(25 / 150, 4)
    assert area_under(np.zeros(0), np.zeros(0)) is None


def test_leaving_the_reef_counts_once_until_it_is_back():
    assert excursions(np.array([0.0, 2.9, 3.1, 2.8, 3.2, 2.4, 3.1])) == 2
    assert excursions(np.zeros(0)) == 0


def line(*corners):
    parts = [np.linspace(a, b, round(20 * math.dist(a, b)) + 1) for a, b in itertools.pairwise(corners)]
    return np.concatenate(parts)


def test_driving_back_along_its_own_path_is_noticed():
    assert driven_back(line((0, 0), (10, 0), (10, 0.4), (2, 0.4))) == 1


@pytest.mark.parametrize(
    "path",
    [
        line((0, 0), (20, 0)),
        line((0, 0), (10, 0), (10, 5), (0, 5)),  # a lane 5 m off is another way
        line((0, 0), (10, 0), (10, 5), (5, 5), (5, -5)),  # crossing is not driving back
        np.zeros((5, 2)),
        np.zeros((0, 2)),
    ],
)
def test_other_paths_are_not_driven_back(path):
    assert driven_back(path) == 0


def rows(true, believed, speeds):
    """Make rows in which the odometry alone is 1 m farther off along y."""
    names = ("x", "y", "est_x", "est_y", "odo_x", "odo_y", "u", "v")
    return [
        dict(zip(names, map(str, (*a, *b, b[0], b[1] + 1.0, s, 0.0)), strict=True))
        for a, b, s in zip(true, believed, speeds, strict=True)
    ]


def write(folder, lines):
    text = "step,t,imaged,inspected,reef_m\n" + "".join(",".join(map(str, one)) + "\n" for one in lines)
    (folder / "judge.csv").write_text(text)


def test_figures_of_a_small_run_by_hand(tmp_path):
    write(
        tmp_path, [(0, 0.0, 0.2, 0.0, 0.0), (1, 0.1, 0.9, 0.5, 3.5), (2, 0.2, 1.0, 0.9, 0.0), (3, 0.3, 1.0, 0.9, 0.0)]
    )
    # The estimate of a row is of where the row before ended.
    table = rows([(0, 0), (1, 0), (2, 0)], [(9, 9), (0, 0.3), (1, 0.1)], [0.0, 0.2, 0.04])
    events = [
        {"event": "start", "clusters_total": 2},
        {"event": "cluster_covered", "t": 0.1},
        {"event": "cluster_covered", "t": 0.2},
        {"event": "judged", "phantoms": 3, "oracle_time_to_90_s": 0.1},
        {"event": "end", "t": 0.3, "reason": "time limit"},
    ]
    found = outcome_metrics(tmp_path, events, table)
    assert found == {
        "imaged": 1.0,
        "inspected": 0.9,
        "time_to_50_s": 0.1,
        "time_to_80_s": 0.2,
        "time_to_90_s": 0.2,
        "time_to_100_s": None,
        "inspected_at_45_s": 0.9,
        "inspected_at_60_s": 0.9,
        "inspected_at_90_s": 0.9,
        "inspected_auc": area_under(np.array([0, 0.1, 0.2, 0.3]), np.array([0, 0.5, 0.9, 0.9])),
        "oracle_ratio_90": 2.0,
        "idle_fraction": round(2 / 3, 4),
        "path_deviations": 1,
        "phantom_clusters": 3,
        "position_error_m": 0.1,
        "odometry_error_m": 1.1,
        "corrected_m": 1.0,
        "all_covered_s": 0.2,
        "late_calls": None,
    }
    assert set(found) == set(DEFINITIONS)


def test_questions_after_everything_was_inspected_are_counted(tmp_path):
    write(tmp_path, [(0, 0.0, 0.2, 0.0, 0.0), (1, 0.1, 1.0, 1.0, 0.0)])
    events = [{"event": "question", "t": t} for t in (0.0, 0.1, 0.2, 0.3)]
    assert outcome_metrics(tmp_path, events, [])["late_calls"] == 2


def test_a_run_cut_off_in_a_line_or_without_a_judge_is_told_as_far_as_it_goes(tmp_path):
    (tmp_path / "judge.csv").write_text("step,t,imaged,inspected,reef_m\n0,0,0.2,0.1,0\n1,0.1,0.5,0.")
    found = outcome_metrics(tmp_path, [{"event": "start", "clusters_total": 2}], [])
    assert (found["imaged"], found["phantom_clusters"], found["oracle_ratio_90"]) == (0.2, None, None)
    (tmp_path / "judge.csv").unlink()
    found = outcome_metrics(tmp_path, [], rows([(0, 0)], [(0, 0)], [0.3]))
    assert (found["inspected"], found["time_to_50_s"], found["idle_fraction"]) == (None, None, 0.0)
    json.dumps(found, allow_nan=False)


def test_the_share_at_a_budget_is_the_last_one_before_it():
    t, share = np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.4, 0.7])
    assert [share_at(t, share, at) for at in (0.0, 1.5, 2.0, 9.0)] == [0.0, 0.4, 0.7, 0.7]
    assert share_at(np.array([]), np.array([]), 9.0) is None
