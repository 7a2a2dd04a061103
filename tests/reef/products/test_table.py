from coral.reef.products.table import write_table


def test_rows_come_in_the_order_of_the_columns_and_what_is_not_known_is_empty(tmp_path):
    write_table(tmp_path / "t.csv", ("a", "b"), [{"b": 1.5, "a": "x, y"}, {"a": 2, "b": None}])
    assert (tmp_path / "t.csv").read_text() == 'a,b\n"x, y",1.5\n2,\n'
