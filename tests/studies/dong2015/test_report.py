"""Reproduction report by hand-made rows: counts, the scorecard within its columns, JSON, and figures in the page."""

import json
from dataclasses import replace
from typing import Any

from matplotlib.figure import Figure
from pytest import approx, fixture

from dong2015 import Finding, Reproduction, Row, RowKind, Verdict
from dong2015.chapters import ChapterFigure
from dong2015.claims import Claim, ClaimVerdict
from dong2015.report import (
    counts,
    counts_by_kind,
    reproduction_files,
    rows_by_erratum,
    summary_lines,
    validation_object,
)
from dong2015.row import Alternative
from sonolube import __version__


def row(name: str, verdict: Verdict, kind: RowKind = RowKind.PUBLISHED_FORMULA, **more: Any) -> Row:
    values: dict[str, Any] = {
        "chapter": 2, "source": "2.1", "quantity": "friction_ratio", "unit": "%", "printed": "40", "published": 40.0,
        "published_low": 39.5, "published_high": 40.5, "computed": 42.0, "note": "by hand",
    }  # fmt: skip
    return Row(id=name, kind=kind, verdict=verdict, **(values | more))


OTHER = {
    "b": Alternative(computed=40.0, reproduced=True, note="n"),
    "a": Alternative(computed=9.0, reproduced=False, note="n"),
}
ROWS = (
    row("late", Verdict.REPRODUCED, chapter=3),
    row("first", Verdict.NOT_REPRODUCED, RowKind.DEFAULT_MODEL, alternatives=OTHER),
    row("second", Verdict.REPRODUCED, RowKind.PUBLISHED_MODEL, computed=None),
    row("third", Verdict.REPRODUCED),
)


@fixture
def result() -> Reproduction:
    claim = Claim(
        id="own", statement="Friction falls by a share that takes more than one line to be said here", source="2.1",
        judged="by rows", decisive=("first",), supporting=("third", "gone"),
    )  # fmt: skip
    found = Finding(claim=claim, verdict=ClaimVerdict.PARTLY_REPRODUCED, claimed="40 %", found="42 % of it all")
    figures = tuple(
        ChapterFigure(name=name, title=f"Title {name}", caption="c", draw=Figure, chapter=chapter)
        for name, chapter in (("two", 2), ("three", 3))
    )
    return Reproduction(findings=(found,), rows=ROWS, figures=figures, caveats=("one",))


def test_rows_are_counted_by_verdict_and_class_also_where_there_are_none() -> None:
    assert counts(ROWS) == {verdict.value: 0 for verdict in Verdict} | {"reproduced": 3, "not_reproduced": 1}
    by_kind = counts_by_kind(ROWS)
    assert [by_kind[kind.value]["reproduced"] for kind in RowKind] == [2, 1, 0]
    assert by_kind["default_model"]["not_reproduced"] == 1


def test_the_summary_has_claims_in_columns_counts_and_alternatives(result: Reproduction) -> None:
    lines = summary_lines(result)
    gap = lines.index("")
    card, table = lines[:gap], lines[gap + 1 :]
    # columns of 2, 27, 15, 14 and 17 characters with a space between
    assert card[0] == f"{'':2} {'claim of the dissertation':27} {'claimed':15} {'found':14} verdict"
    assert card[1] == f" 1 {'Friction falls by a share':27} {'40 %':15} {'42 % of it all':14} partly reproduced"
    assert card[2].strip() == "that takes more than one"
    assert [line.split() for line in table] == [
        ["4", "published", "numbers", "formula", "its", "model", "our", "model", "all"],
        ["reproduced", "2", "1", "0", "3"],
        ["not", "reproduced", "0", "0", "1", "1"],
        ["Not", "counted:", "2", "numbers", "of", "alternative", "models,", "of", "which", "1", "agree."],
    ]
    assert table[1] == f"{'  reproduced':24}{2:12}{1:12}{0:12}{3:12}"
    bare = summary_lines(replace(result, findings=(), rows=ROWS[2:]))
    assert bare[0].startswith("2 published numbers")
    assert not any("Not counted" in line for line in bare)


def test_a_percent_sign_is_not_torn_from_its_number(result: Reproduction) -> None:
    finding = replace(result.findings[0], found="about exactly 42 %")  # which would be broken before the sign
    card = summary_lines(replace(result, findings=(finding,)))
    assert any("42 %" in line for line in card)


def test_the_json_has_claims_rows_with_their_errors_and_counts(result: Reproduction) -> None:
    found = validation_object(result)
    assert (found["version"], found["count"], found["caveats"]) == (__version__, 4, ["one"])
    assert found["claims"] == [
        {"id": "own", "statement": result.findings[0].claim.statement, "source": "2.1", "claimed": "40 %",
         "found": "42 % of it all", "verdict": "partly reproduced", "judged": "by rows", "decisive_rows": ["first"],
         "supporting_rows": ["third", "gone"]}
    ]  # fmt: skip
    first = found["rows"][1]
    assert (first["id"], first["kind"], first["verdict"]) == ("first", "default_model", "not_reproduced")
    assert first["relative_error"] == approx(0.05)  # 42 over 40
    assert list(first)[-5:] == ["relative_error", "verdict", "note", "errata", "alternatives"]
    assert first["alternatives"]["b"]["computed"] == approx(40.0)
    assert found["rows"][2]["relative_error"] is None
    assert found["verdicts"]["reproduced"] == 3
    assert found["verdicts_by_kind"]["published_model"]["reproduced"] == 1


def test_the_files_are_page_json_and_figures_with_progress_after_each(result: Reproduction) -> None:
    told: list[tuple[str, int, int]] = []
    files = reproduction_files(result, advance=lambda *each: told.append(each))
    assert told == [("Title two", 1, 2), ("Title three", 2, 2)]
    names = [f"figures/{name}.{form}" for name in ("two", "three") for form in ("png", "svg", "pdf")]
    assert list(files) == ["reproduction.html", "validation.json", *names]
    text = files["validation.json"]
    assert isinstance(text, str)
    assert text.endswith("}\n")
    assert json.loads(text) == json.loads(json.dumps(validation_object(result)))
    page = files["reproduction.html"]
    assert isinstance(page, str)
    second, third = page.index('id="chapter-2"'), page.index('id="chapter-3"')
    assert second < page.index('id="two"') < page.index('id="first"') < page.index('id="third"') < third
    assert third < page.index('id="three"') < page.index('id="late"')
    assert page.count("data:image/png;base64,") == 2
    assert '<a href="#third">' in page
    assert '<a href="#gone">' not in page
    assert "our default model, against published test" in page


def test_errata_are_counted_once_and_list_their_rows() -> None:
    found = rows_by_erratum(
        [
            row("one", Verdict.MISPRINT, errata=("E34",)),
            row("mean", Verdict.OTHER_AVERAGING, errata=("E17",)),
            row("two", Verdict.MISPRINT, errata=("E34",)),
            row("none", Verdict.REPRODUCED),
        ]
    )
    assert found == {"E17": ["mean"], "E34": ["one", "two"]}
