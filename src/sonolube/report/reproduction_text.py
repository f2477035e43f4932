"""Lines of text on a reproduction: the scorecard of its claims, and its rows counted by class and verdict."""

from collections import Counter
from collections.abc import Sequence
from textwrap import wrap
from typing import Final

from sonolube.reproduction import Reproduction, Row, RowKind, Verdict

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
