"""Reproduction report: published numbers beside computed ones and the claims, as a page, JSON and text."""

import base64
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from textwrap import wrap
from typing import Any, Final

from dong2015 import Finding, Reproduction, Row, RowKind, Verdict
from dong2015.counterparts import figures_of_d
from sonolube import __version__
from sonolube.facts.published import errata, erratum
from sonolube.report import Drawing, rendered_files
from sonolube.storage.files import write_atomically
from sonolube.studies import Advance
from sonolube.text.plain_text import printable

KIND_NAMES: Final = {
    RowKind.PUBLISHED_FORMULA: "published formula, on published numbers",
    RowKind.PUBLISHED_MODEL: "published model, against published test",
    RowKind.DEFAULT_MODEL: "our default model, against published test",
}
"""Classes of rows in words."""

_KIND_COLUMNS: Final = {
    RowKind.PUBLISHED_FORMULA: "formula",
    RowKind.PUBLISHED_MODEL: "its model",
    RowKind.DEFAULT_MODEL: "our model",
}
_HEADING: Final = ("", "claim of the dissertation", "claimed", "found", "verdict")
_WIDTHS: Final = (2, 27, 15, 14, 17)  # of the columns of the scorecard, 79 together with a space between
_NO_BREAK: Final = "\N{NO-BREAK SPACE}"


def summary_lines(result: Reproduction) -> list[str]:
    """Scorecard of the claims, and the number of rows by class and verdict, in at most 80 columns.

    Parameters
    ----------
    result : Reproduction

    Returns
    -------
    list of str
    """
    return [*_scorecard(result), *([""] if result.findings else []), *_table_of_counts(result.rows)]


def counts(rows: Sequence[Row]) -> dict[str, int]:
    """Number of rows of each verdict, verdicts without rows included."""
    counted = Counter(row.verdict for row in rows)
    return {verdict.value: counted[verdict] for verdict in Verdict}


def rows_by_erratum(rows: Sequence[Row]) -> dict[str, list[str]]:
    """Ids of the rows that are misprints or of other averaging by each erratum, in the order of the errata."""
    return {each.id: found for each in errata() if (found := [row.id for row in rows if each.id in row.errata])}


def counts_by_kind(rows: Sequence[Row]) -> dict[str, dict[str, int]]:
    """Number of rows of each verdict by class, classes and verdicts without rows included."""
    return {kind.value: counts([row for row in rows if row.kind is kind]) for kind in RowKind}


def _scorecard(result: Reproduction) -> list[str]:
    """Claims with what was claimed and found, and the verdict; cells are wrapped within their columns."""
    if not result.findings:
        return []
    lines = _wrapped(_HEADING)
    for number, one in enumerate(result.findings, start=1):
        lines += _wrapped((f"{number:2d}", one.claim.statement, one.claimed, one.found, one.verdict.value))
    return lines


def _wrapped(cells: Sequence[str]) -> list[str]:
    """Cells of one row as lines, each cell wrapped in its column."""
    columns = [
        wrap(cell.replace(" %", f"{_NO_BREAK}%"), width) or [""] for cell, width in zip(cells, _WIDTHS, strict=True)
    ]
    height = max(map(len, columns))
    padded = [column + [""] * (height - len(column)) for column in columns]
    return [
        " ".join(f"{cell:<{width}}" for cell, width in zip(line, _WIDTHS, strict=True)).replace(_NO_BREAK, " ").rstrip()
        for line in zip(*padded, strict=True)
    ]


def _table_of_counts(rows: Sequence[Row]) -> list[str]:
    """Number of rows by verdict and class, and the number of alternatives beside them."""
    by_kind = counts_by_kind(rows)
    heading = (f"{len(rows)} published numbers", *_KIND_COLUMNS.values(), "all")
    table = [heading, *_count_cells(by_kind, counts(rows))]
    lines = [f"{name:<24}" + "".join(f"{cell:>12}" for cell in cells) for name, *cells in table]
    if by_erratum := rows_by_erratum(rows):
        misprints = sum(erratum(name).kind == "misprint" for name in by_erratum)
        others = len(by_erratum) - misprints
        lines.append(f"The misprints are of {misprints} errata, numbers of other averaging of {others}.")
    alternatives = [alternative for row in rows for alternative in row.alternatives.values()]
    if alternatives:
        agree = sum(alternative.reproduced for alternative in alternatives)
        lines.append(f"Not counted: {len(alternatives)} numbers of alternative models, of which {agree} agree.")
    return lines


def _count_cells(by_kind: dict[str, dict[str, int]], totals: dict[str, int]) -> list[tuple[str, ...]]:
    """Verdicts that occur, each with its number in every class and in all."""
    return [
        (f"  {verdict.replace('_', ' ')}", *(str(by_kind[kind.value][verdict]) for kind in _KIND_COLUMNS), str(total))
        for verdict, total in totals.items()
        if total
    ]


def reproduction_files(
    result: Reproduction, *, advance: Advance = lambda name, done, total: None
) -> dict[str, str | bytes]:
    """Content of `reproduction.html`, of `validation.json` and of every figure as PNG and SVG.

    Parameters
    ----------
    result : Reproduction
    advance : callable
        Called after each figure with its title, the number done and their total.

    Returns
    -------
    dict of str to str or bytes
        By file name, the page first; figures are below `figures/`.
    """
    figures: dict[str, str | bytes] = {}
    pictures: dict[str, str] = {}
    for done, figure in enumerate(result.figures, start=1):
        contents = rendered_files({figure.name: Drawing(draw=figure.draw)})
        figures |= {f"figures/{name}": content for name, content in contents.items()}
        png = contents[f"{figure.name}.png"]
        assert isinstance(png, bytes)
        pictures[figure.name] = base64.b64encode(png).decode()
        advance(figure.title, done, len(result.figures))
    return {
        "reproduction.html": _page(result, pictures),
        "validation.json": json.dumps(validation_object(result), indent=2) + "\n",
        **figures,
    }


def write_report(
    result: Reproduction, *, folder: Path, advance: Advance = lambda name, done, total: None
) -> list[Path]:
    """Write the files of a reproduction report.

    Parameters
    ----------
    result : Reproduction
    folder : Path
        Made where it is missing.
    advance : callable
        As in `reproduction_files`.

    Returns
    -------
    list of Path
        The files, the page first.

    Raises
    ------
    InvalidInput
        If the folder cannot be written to.
    """
    files = reproduction_files(result, advance=advance)
    return [write_atomically(folder / name, content) for name, content in files.items()]


def validation_object(result: Reproduction) -> dict[str, Any]:
    """Claims with their findings, rows, and the number of rows by verdict and class, for JSON."""
    return {
        "version": __version__,
        "claims": [_claim_object(one) for one in result.findings],
        "count": len(result.rows),
        "verdicts": counts(result.rows),
        "verdicts_by_kind": counts_by_kind(result.rows),
        "errata": rows_by_erratum(result.rows),
        "rows": [_row_object(row) for row in result.rows],
        "caveats": list(result.caveats),
    }


def _claim_object(one: Finding) -> dict[str, Any]:
    """Claim with its finding and the ids of its rows, for JSON."""
    claim = one.claim
    return {
        **{name: getattr(claim, name) for name in ("id", "statement", "source")},
        **{name: getattr(one, name) for name in ("claimed", "found")},
        "verdict": one.verdict.value,
        "judged": claim.judged,
        "decisive_rows": list(claim.decisive),
        "supporting_rows": list(claim.supporting),
    }


def _row_object(row: Row) -> dict[str, Any]:
    """Row with its relative error and verdict, for JSON."""
    last = ("verdict", "note", "errata", "alternatives")
    entry = asdict(row) | {"relative_error": row.relative_error, "kind": row.kind.value, "verdict": row.verdict.value}
    order = (*(name for name in asdict(row) if name not in last), "relative_error", *last)
    return {name: entry[name] for name in order}


def _page(result: Reproduction, pictures: dict[str, str]) -> str:
    """HTML of the report: scorecard and counts, then figures and rows by chapter."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    chapters = sorted({row.chapter for row in result.rows})
    environment = Environment(
        loader=PackageLoader("dong2015"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    page = environment.get_template("reproduction.html").render(
        version=__version__,
        result=result,
        counts=counts(result.rows),
        counts_by_kind=counts_by_kind(result.rows),
        kind_names={kind.value: name for kind, name in KIND_NAMES.items()},
        row_ids={row.id for row in result.rows},
        chapters=[
            (
                chapter,
                [figure for figure in result.figures if figure.chapter == chapter],
                [row for row in result.rows if row.chapter == chapter],
            )
            for chapter in chapters
        ],
        pictures=pictures,
        errata=errata(),
        rows_by_erratum=rows_by_erratum(result.rows),
        figures_of_d=figures_of_d(),
        figure_names={figure.name for figure in result.figures},
    )
    return printable(page)
