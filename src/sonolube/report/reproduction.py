"""Reproduction report: published numbers beside computed ones as a page with figures, as JSON and as lines."""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sonolube import __version__
from sonolube.files import write_atomically
from sonolube.published import errata
from sonolube.report.page import Advance, Drawing, drawn, embedded, html
from sonolube.reproduce import Reproduction, Row, Verdict


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
        contents = drawn(Drawing(draw=figure.draw), forms=("png", "svg"))
        figures |= {f"figures/{figure.name}.{form}": content for form, content in contents.items()}
        pictures[figure.name] = embedded(contents["png"])
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
    """Rows of a reproduction and their number by verdict, for JSON."""
    return {
        "version": __version__,
        "count": len(result.rows),
        "verdicts": _counts(result.rows),
        "rows": [_row_object(row) for row in result.rows],
    }


def summary_lines(result: Reproduction) -> list[str]:
    """Number of rows by verdict, and every row whose model disagrees, as lines of text."""
    counts = _counts(result.rows)
    width = max(map(len, counts))
    return [
        f"{len(result.rows)} published numbers beside computed ones",
        *[f"  {verdict:<{width}}  {count:4d}" for verdict, count in counts.items()],
        *[
            f"  {row.source}: {row.id}: {row.published:.4g} published, {row.computed:.4g} computed"
            for row in result.rows
            if row.verdict is Verdict.MODEL_DISAGREES
        ],
    ]


def _counts(rows: Sequence[Row]) -> dict[str, int]:
    """Number of rows of each verdict, verdicts without rows included."""
    counted = Counter(row.verdict for row in rows)
    return {verdict.value: counted[verdict] for verdict in Verdict}


def _row_object(row: Row) -> dict[str, Any]:
    """Row with its relative error and verdict, for JSON."""
    entry = asdict(row) | {"relative_error": row.relative_error, "verdict": row.verdict.value}
    order = (*(name for name in asdict(row) if name not in ("verdict", "note")), "relative_error", "verdict", "note")
    return {name: entry[name] for name in order}


def _page(result: Reproduction, pictures: dict[str, str]) -> str:
    """HTML of the report, figures and rows by chapter."""
    chapters = sorted({row.chapter for row in result.rows})
    return html(
        "reproduction.html",
        version=__version__,
        result=result,
        counts=_counts(result.rows),
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
    )
