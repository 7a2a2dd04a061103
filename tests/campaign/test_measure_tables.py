from coral.campaign.measure_tables import differences_table, means_table
from coral.campaign.measures import field

COVERAGE = field("coverage", "coverage (%)", "coverage", 100.0)


def missions(*coverages):
    return [{"world": f"w{k}", "seed": 0, "coverage": value} for k, value in enumerate(coverages)]


FULL = missions(1.0, 1.0)
GROUPS = {"slow": missions(0.5, 0.5), "same": FULL, "not run": []}


def test_groups_that_ran_have_a_line_of_means():
    table = means_table("Means", "Of all.", "variant", GROUPS, (COVERAGE,), ("From where.",))
    assert table.header == ("variant", "missions", "coverage (%)")
    assert table.rows == (("slow", "2", "50.0"), ("same", "2", "100.0"))


def test_differences_are_paired_and_groups_without_one_are_named():
    table = differences_table("Apart", "", "variant", GROUPS, FULL, (COVERAGE,), ("What.", "From where."))
    assert table.rows == (("slow", "2", "−50.0 [−50.0, −50.0]"), ("same", "2", "≈ 0.0 [0.0, 0.0]"))
    assert table.notes == ("What.", "No difference in any of these numbers could be shown for: same.", "From where.")


def test_without_a_reference_there_is_no_difference():
    assert differences_table("Apart", "", "variant", GROUPS, (), (COVERAGE,), ("What.",)).rows == ()
