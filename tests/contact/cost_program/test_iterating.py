"""What a loop runs through, and iterators that are good for one pass."""

import pytest

from coral.contact.cost_program import CostError
from coral.contact.cost_program.iterating import entries, iterator
from coral.contact.cost_program.sharing import memory
from coral.contact.cost_program.values import DictValue, Seq, Vec


def test_a_loop_over_a_dict_runs_through_its_keys(meter):
    assert entries(meter, DictValue({"a": 1.0, "b": 2.0})) == ("a", "b")


def test_a_list_can_be_run_through_again_but_an_iterator_only_once(meter):
    again, once = Seq((1.0,)), iterator((1.0,))
    assert entries(meter, again) == entries(meter, again) == entries(meter, once)
    with pytest.raises(CostError, match=r"write list\(\.\.\.\)"):
        entries(meter, once)


def test_an_iterator_holds_the_memory_of_its_sources():
    a, b = Vec((1.0,)), Seq((2.0,))
    assert memory(iterator((), a, b)) == memory(a) | memory(b)


def test_a_number_cannot_be_looped_over(refusal):
    assert "a number cannot be looped over" in refusal("for x in self.time:\n    pass\nreturn 1.0").text


def test_a_set_has_no_order_to_loop_over(refusal):
    assert "write a list" in refusal("return sum(1.0 for k in {'a', 'b'})").text


def test_an_iterator_that_is_stored_and_used_once_gives_what_python_gives(agrees):
    agrees("z = zip([1.0, 2.0], self.ee_pos)\nreturn sum(x * y for x, y in z)")


def test_an_iterator_that_is_used_twice_is_refused(refusal):
    found = refusal("z = zip([1.0], [2.0])\na = sum(x for x, y in z)\nreturn a + sum(y for x, y in z)")
    assert (found.code, found.line) == ("wrong_type", 4)
