"""Reproduction report: claims, and published numbers beside computed ones, as a page with figures and as JSON."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sonolube import __version__
from sonolube.facts.published import errata
from sonolube.report.page import Advance, Drawing, drawn, embedded, html
from sonolube.report.reproduction_text import KIND_NAMES, counts, counts_by_kind
from sonolube.report.results.record_object import picked
from sonolube.reproduction import Finding, Reproduction, Row
from sonolube.storage.files import write_atomically


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
        contents = drawn(Drawing(draw=figure.draw), forms=("png", "svg", "pdf"))
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
    """Claims with their findings, rows, and the number of rows by verdict and class, for JSON."""
    return {
        "version": __version__,
        "claims": [_claim_object(one) for one in result.findings],
        "count": len(result.rows),
        "verdicts": counts(result.rows),
        "verdicts_by_kind": counts_by_kind(result.rows),
        "rows": [_row_object(row) for row in result.rows],
        "caveats": list(result.caveats),
    }


def _claim_object(one: Finding) -> dict[str, Any]:
    """Claim with its finding and the ids of its rows, for JSON."""
    claim = one.claim
    return {
        **picked(claim, "id", "statement", "source"),
        **picked(one, "claimed", "found"),
        "verdict": one.verdict.value,
        "judged": claim.judged,
        "decisive_rows": list(claim.decisive),
        "supporting_rows": list(claim.supporting),
    }


def _row_object(row: Row) -> dict[str, Any]:
    """Row with its relative error and verdict, for JSON."""
    last = ("verdict", "note", "alternatives")
    entry = asdict(row) | {"relative_error": row.relative_error, "kind": row.kind.value, "verdict": row.verdict.value}
    order = (*(name for name in asdict(row) if name not in last), "relative_error", *last)
    return {name: entry[name] for name in order}


def _page(result: Reproduction, pictures: dict[str, str]) -> str:
    """HTML of the report: scorecard and counts, then figures and rows by chapter."""
    chapters = sorted({row.chapter for row in result.rows})
    return html(
        "reproduction.html",
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
    )
