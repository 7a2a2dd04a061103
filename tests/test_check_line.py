from coral.check_line import CheckLine, blocking, level_of, list_text

LINES = [CheckLine("tether", "free"), CheckLine("sonar", "none", "lacking"), CheckLine("leak", "wet", level_of(True))]


def test_each_line_has_the_mark_of_its_level():
    assert list_text(LINES) == "  tether: free\n! sonar: none\nX leak: wet"
    assert list_text([CheckLine("at rest", "still", level_of(False))], {"good": "ok   "}) == "ok   at rest: still"


def test_only_what_blocks_keeps_it_from_moving():
    assert blocking(LINES) == LINES[2:]
