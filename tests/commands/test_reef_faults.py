"""`coral reef faults`."""

import pytest

from coral.reef.simulation.faults import FAULTS


def test_the_list_names_every_fault(told):
    code, result, _ = told("reef", "faults", "--list", "--json")
    assert code == 0
    assert [one["fault"] for one in result["faults"]] == [*FAULTS]


def test_a_blind_camera_stops_the_vehicle_within_a_second_and_the_table_says_so(told, tmp_path):
    flags = ("--only", "blind-camera", "--at", "4", "--duration", "2", "--out", tmp_path / "kept")
    code, result, _ = told("reef", "faults", "o1", *flags, "--json")
    assert code == 0
    (one,) = result["faults"]
    assert one["said"].startswith("camera blind")
    assert one["stopped_after_s"] <= 1.0
    assert one["back_after_s"] == pytest.approx(1.0)
    assert (tmp_path / "kept" / "blind-camera" / "trajectory.csv").is_file()


@pytest.mark.parametrize("flags", [("--only", "blind-cam"), ("--at", "-1"), ("--duration", "nan")])
def test_wrong_flags_are_one_line(told, flags):
    code, _, err = told("reef", "faults", *flags)
    assert code == 2
    assert err.count("\n") == 1
    assert flags[0] in err
