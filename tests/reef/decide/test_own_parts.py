import pytest

from coral.advisor.question import Rejection
from coral.errors import InputError
from coral.reef.decide.own_parts import find_trigger, find_verifier


def test_a_text_becomes_a_refusal_and_none_passes():
    verify = find_verifier(lambda question, answer: "too deep" if answer > 3 else None)
    assert verify(None, 4) == Rejection(code="own", reason="too deep")
    assert verify(None, 3) is None


def test_a_rejection_keeps_its_code():
    mine = Rejection(code="mine", reason="no")
    assert find_verifier(lambda question, answer: mine)(None, 0) is mine


@pytest.mark.parametrize("find", [find_trigger, find_verifier])
@pytest.mark.parametrize("given", ["no-such-part", 3])
def test_what_is_no_function_is_refused(find, given):
    assert find(None) is None
    with pytest.raises(InputError, match=f"--{find.__name__.removeprefix('find_')}: found"):
        find(given)
