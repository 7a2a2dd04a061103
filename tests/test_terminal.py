"""What is told while a command works does not mix with its result."""

from coral.terminal import tell


def test_what_is_told_goes_to_standard_error(capsys):
    tell("the mission begins")
    assert capsys.readouterr() == ("", "the mission begins\n")
