"""Containers that share memory carry common marks, and only those."""

from coral.contact.cost_program.sharing import marks_of, memory, renewed, view
from coral.contact.cost_program.values import DictValue, Seq, Vec


def test_every_container_stands_for_memory_of_its_own_and_keeps_it():
    first, second = Vec((1.0,)), Vec((1.0,))
    assert marks_of(first) == marks_of(first)
    assert not marks_of(first) & marks_of(second)
    assert memory(Seq(())) != memory(DictValue({}))
    assert memory(3.0) == frozenset()


def test_the_memory_of_a_matrix_holds_that_of_its_rows():
    rows = Vec((1.0,)), Vec((2.0,))
    matrix = Vec(rows)
    assert memory(matrix) == marks_of(matrix) | memory(rows[0]) | memory(rows[1])


def test_the_entries_of_a_list_are_not_the_memory_of_the_list():
    entry = Vec((1.0,))
    assert not memory(Seq((entry,))) & memory(entry)


def test_a_view_shares_the_memory_of_its_bases_and_a_renewed_array_none():
    a, b = Vec((1.0,), "wxyz"), Vec((2.0,))
    assert memory(view((1.0, 2.0), a, b)) == memory(a) | memory(b)
    copy = renewed(Vec((a, b)))
    assert not memory(copy) & (memory(a) | memory(b))
    assert [row.items for row in copy.items] == [(1.0,), (2.0,)]
    assert copy.items[0].order == "wxyz"
