import pytest

from coral.campaign.table import Table, document, overview, table_json, to_markdown

TABLE = Table(
    "Table X",
    "What & why (100 %).",
    ("variant", "Δ cov. (%)"),
    (("a|b_c", "−3.1 [−5.0, +1.2]"), ("<full>", "≈ 0.0")),
    ("n = 3; † see x_1.",),
)

MARKDOWN = """\
**Table X.** What & why (100 %).

| variant |        Δ cov. (%) |
| ------- | ----------------: |
| a\\|b_c  | −3.1 [−5.0, +1.2] |
| <full>  |             ≈ 0.0 |

- n = 3; † see x_1.
"""


def test_markdown_is_padded_text():
    assert to_markdown(TABLE) == MARKDOWN


def test_a_page_of_tables_escapes_every_text():
    page = document([TABLE], "html", "A <b>")
    assert "<h1>A &lt;b&gt;</h1>" in page
    assert '<th scope="row">&lt;full&gt;</th>' in page
    assert "<td>≈ 0.0</td>" in page


@pytest.mark.parametrize("form", ["md", "html"])
def test_a_document_holds_every_table(form):
    text = document([TABLE, TABLE], form, "Reef")
    assert text.count("Table X") == 2
    assert "Reef" in text


def test_a_ragged_table_is_a_mistake():
    with pytest.raises(ValueError, match="2 cells under a header of 1"):
        Table("T", "", ("a",), (("b", "c"),))


def sheet(name, *notes):
    return Table(name, "c", ("a", "b"), (("x", "1"),), notes)


def test_a_terminal_shows_two_tables_and_their_common_notes_once():
    tables = [sheet("One", "same", "own"), sheet("Two", "same"), sheet("Three", "far")]
    text = overview(tables, ("Two", "One", "Three"))
    assert text.index("**Two.**") < text.index("**One.**")
    assert "Three" not in text
    assert text.count("- same") == text.count("- own") == 1
    assert "(1 more in the files below)" in text
    assert overview(tables[:1], ("None",)) == "(1 more in the files below)"


@pytest.mark.parametrize("form", ["md", "html"])
def test_notes_of_several_tables_are_written_once(form):
    tables = [
        sheet("One", "for all", "for two"),
        sheet("Two", "for all", "for two"),
        sheet("Three", "for all", "its own remark"),
    ]
    text = document(tables, form, "Title")
    assert text.count("for all") == text.count("for two") == text.count("its own remark") == 1
    assert "for two (One, Two)" in text
    assert text.index("its own remark") < text.index("for all")


def test_a_column_of_the_papers_numbers_is_named_after_its_neighbour():
    table = Table(
        "T", "c", ("variant", "coverage", "paper", "steps", "paper"), (("full", "97", "96", "10", "12"),), ("n",)
    )
    assert table_json(table) == {
        "name": "T",
        "caption": "c",
        "rows": [{"variant": "full", "coverage": "97", "coverage, paper": "96", "steps": "10", "steps, paper": "12"}],
        "notes": ["n"],
    }
