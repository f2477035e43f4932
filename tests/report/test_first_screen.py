"""First screens of long answers: their lines by hand, caveats whole, and what is left out said."""

from pathlib import Path

import pytest

from sonolube.report.blocks import Bar, Bars, Rows, Table
from sonolube.report.first_screen import MAX_LINES, LongAnswer, file_lines, short_file_line, shortened

ENDS = (0.1, 0.3, 0.5, 0.7, 0.9)


@pytest.mark.parametrize(
    ("ends", "drawn"),
    [
        (ENDS, "[ --==|==-- ]"),  # of eleven places 1, 3, 5, 7 and 9
        ((-0.2, 0.0, 0.2, 0.4, 0.5), "[<=|==-     ]"),
        ((0.5, 0.8, 0.9, 1.0, 1.3), "[     ---=|>]"),
        ((), ""),
    ],
)
def test_a_bar_has_its_marks_at_the_rounded_shares_of_its_width(ends: tuple[float, ...], drawn: str) -> None:
    assert Bar(name="friction", text="", ends=ends).drawn(11) == drawn


def test_bars_of_one_scale_stand_below_its_words_and_a_text_stands_in_place_of_one() -> None:
    bars = Bars(("none", "half", "all"), [Bar(name="friction", text="-50 %", ends=ENDS), Bar(name="power", text="4 W")])
    # 44 less 8 and 5 characters of words and 8 of marks and gaps are 23, in the middle of which the word is centred
    assert bars.lines(44) == [
        "             none     half       all",
        "  friction  [  -----====|====-----  ]  -50 %",
        "  power     4 W",
    ]


@pytest.mark.parametrize(
    ("text", "room", "short"),
    [
        ("short", 10, "short"),
        ("measured by a vibrometer, under no load", 32, "measured by a vibrometer ..."),
        ("a pause, then words without another one", 30, "a pause, then words ..."),  # the pause leaves too little
        ("x" * 40, 20, f"{'x' * 16} ..."),
    ],
)
def test_a_long_text_ends_at_a_pause_or_after_a_word(text: str, room: int, short: str) -> None:
    assert shortened(text, room) == short
    assert len(shortened(text, room)) <= room


def long_answer(rows: int, caveats: int = 1, assumptions: int = 2) -> LongAnswer:
    return LongAnswer(
        blocks=["Title", Rows([(f"name {place}", "value " * 20) for place in range(rows)])],
        leading_caveats=["far beyond"],
        caveats=["rough " * 30] * caveats,
        assumptions={f"key.{place}": "typical, of its kind" * 5 for place in range(assumptions)},
        files=["  out/a.png .svg"],
    )


@pytest.mark.parametrize("rows", [3, 12, 40])
def test_a_first_screen_has_at_most_24_lines_of_its_width_and_whole_caveats(rows: int) -> None:
    lines = long_answer(rows).lines(line_length=80, rest="--full")
    assert len(lines) <= MAX_LINES == 24
    assert max(map(len, lines)) <= 80
    assert lines[:2] == ["Title", "  caveat: far beyond"]
    caveat = " ".join(" ".join(lines).split())
    assert "caveat: " + ("rough " * 30).strip() in caveat
    assert lines[-2:-1] == ["  out/a.png .svg"]


def test_first_rows_stay_whole_and_the_last_are_shortened_before_any_is_left_out() -> None:
    # 24 lines less title, leading caveat, caveat of three, two assumptions, files and last line leave 15: four rows
    # of two lines, and seven shortened ones
    lines = long_answer(11).lines(line_length=80, rest="--full")
    assert [line[:8].strip() for line in lines[2:10]] == ["name 0", "", "name 1", "", "name 2", "", "name 3", ""]
    assert [line[2:9].strip() for line in lines[10:17]] == [f"name {place}" for place in range(4, 11)]
    assert all(line.endswith(" ...") for line in lines[10:17])
    assert lines[-1] == "  in full by --full"
    assert (
        long_answer(40).lines(line_length=80, rest="--full")[-1] == "  29 more lines, and the rest in full, by --full"
    )


def test_many_caveats_leave_some_content_and_of_many_assumptions_three_are_named() -> None:
    lines = long_answer(40, caveats=10).lines(line_length=80, rest="--full")
    assert sum(line.startswith("  name ") for line in lines) == 4  # of two lines each
    assert sum("caveat: rough" in line for line in lines) == 10
    named = long_answer(1, assumptions=7).lines(line_length=80, rest="--full")
    assert sum(line.startswith("  assumed ") for line in named) == 3
    assert "  and 4 more assumptions" in named
    assert (
        sum(line.startswith("  assumed ") for line in long_answer(1, assumptions=6).lines(line_length=80, rest="")) == 6
    )


def test_tables_and_bars_are_cut_at_the_width() -> None:
    answer = LongAnswer(
        blocks=["Title", Table(("a", "b"), [("x " * 60, "y")]), Bars(("0", "1", "2"), [Bar(name="n", text="t")])],
        assumptions={},
    )
    lines = answer.lines(line_length=80, rest="--full")
    assert max(map(len, lines)) <= 80
    assert "  n  t" in lines


def test_files_are_said_in_one_line_each_or_all_in_one() -> None:
    out = Path("out")
    same = [out / "a.png", out / "a.svg"]
    assert file_lines(same, folder=out) == ["  out/a.png", "  out/a.svg"]
    assert file_lines([out / "b" / "1.csv", out / "b" / "2.csv"], folder=out) == ["  out/b: 2 files"]
    assert short_file_line(same) == ["  out/a.png .svg"]
    assert short_file_line([*same, out / "b.nc"]) == ["  out/a.png and 2 more files"]
    assert short_file_line([]) == []
