"""Text of answers: columns aligned, lines wrapped to a width, tables that are too wide one cell below the other."""

from hypothesis import given, strategies as st
from pytest import mark

from sonolube.report.blocks import Block, Rows, Table, Verbatim, block_html, text_lines
from sonolube.text.plain_text import aligned, grid

WORD = st.text("abcdefgh", min_size=1, max_size=9)
CELL = st.lists(WORD, min_size=1, max_size=12).map(" ".join)


@mark.parametrize("rows", [[("a", "1"), ("long", "2")], [("x", "")]])
def test_values_stand_one_under_the_other(rows: list[tuple[str, str]]) -> None:
    width = 2 + max(len(name) for name, _ in rows) + 2
    assert [line[width:] for line in aligned(rows)] == [value for _, value in rows]


def test_columns_of_a_grid_begin_one_under_the_other() -> None:
    assert grid([("a", "bb", "c"), ("aaa", "b", "cc")]) == ["  a    bb  c", "  aaa  b   cc"]


def test_the_widest_column_is_wrapped_and_the_others_stay() -> None:
    assert text_lines([Table(("name", "reason"), [("a", "one two three four")])], line_length=20) == [
        "  name  reason",
        "  a     one two",
        "        three four",
    ]


def test_a_table_that_is_too_wide_is_written_one_cell_below_the_other() -> None:
    heads = [f"quantity{number}" for number in range(9)]
    lines = text_lines([Table(heads, [[f"{number}" for number in range(9)]] * 2)], line_length=40)
    assert lines[:2] == ["  quantity0  0", "  quantity1  1"]
    assert lines.count("") == 1
    assert len(lines) == 2 * 9 + 1


def test_a_sentence_is_wrapped_with_its_rest_indented() -> None:
    assert text_lines(["  caveat: one two three"], line_length=18) == ["  caveat: one two", "    three"]


@given(st.lists(st.lists(CELL, min_size=3, max_size=3), min_size=1, max_size=4))
def test_no_line_is_wider_than_asked_for_and_no_word_is_lost(rows: list[list[str]]) -> None:
    lines = text_lines([Table(("one", "two", "three"), rows), Rows([(row[0], row[1]) for row in rows])], line_length=60)
    assert max(map(len, lines)) <= 60
    words = " ".join(lines).split()
    assert all(word in words for row in rows for cell in row for word in cell.split())


BLOCKS: list[Block] = [
    " <lead> ",
    Rows([("a<b", "1 & 2")]),
    Table((" head ", "x>y"), [(" 1 ", "<2>")]),
    Verbatim("<a>\n  b"),
]


def test_every_kind_of_block_is_escaped_in_html_and_stripped_but_for_texts_of_files() -> None:
    assert "".join(map(block_html, BLOCKS)) == (
        "<p>&lt;lead&gt;</p>"
        "<table><tbody><tr><th>a&lt;b</th><td>1 &amp; 2</td></tr></tbody></table>"
        "<table><thead><tr><th>head</th><th>x&gt;y</th></tr></thead>"
        "<tbody><tr><td>1</td><td>&lt;2&gt;</td></tr></tbody></table>"
        "<pre>&lt;a&gt;\n  b</pre>"
    )


def test_every_kind_of_block_has_its_lines_in_their_order_and_a_table_without_heads_has_none() -> None:
    table = Table(("", ""), [("1", "22")])
    assert text_lines([*BLOCKS[1:2], table, BLOCKS[3], "end"]) == ["  a<b  1 & 2", "  1  22", "<a>", "  b", "end"]
    assert text_lines([Table(("h", ""), [("1", "22")])]) == ["  h", "  1  22"]
