"""The reproduction report: a self-contained page, its figures, and the same rows as JSON."""

import base64
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sonolube import __version__
from sonolube.figure import publication_style, render_figure
from sonolube.files import write_atomically
from sonolube.published import errata
from sonolube.reproduce import ReportFigure, Reproduction, Row, Verdict

Advance = Callable[[str, int, int], None]


def write_report(
    result: Reproduction, *, folder: Path, advance: Advance = lambda what, done, total: None
) -> list[Path]:
    """Write `reproduction.html`, `validation.json` and every figure as PNG and SVG.

    Parameters
    ----------
    result : Reproduction
        What to report.
    folder : Path
        Where to; made where it is missing.
    advance : callable
        Told after each figure what was done, how many are done, and of how many.

    Returns
    -------
    list of Path
        The files, the page first.

    Raises
    ------
    InvalidInput
        If the folder cannot be written to.
    """
    files = [write_atomically(folder / "validation.json", json.dumps(validation_object(result), indent=2) + "\n")]
    pictures: dict[str, str] = {}
    for done, figure in enumerate(result.figures, start=1):
        png, svg = _draw(figure)
        files.append(write_atomically(folder / "figures" / f"{figure.name}.png", png))
        files.append(write_atomically(folder / "figures" / f"{figure.name}.svg", svg))
        pictures[figure.name] = base64.b64encode(png).decode()
        advance(figure.title, done, len(result.figures))
    return [write_atomically(folder / "reproduction.html", _page(result, pictures)), *files]


def validation_object(result: Reproduction) -> dict[str, Any]:
    """Return the rows and their count by verdict as one JSON object."""
    return {
        "version": __version__,
        "count": len(result.rows),
        "verdicts": _counts(result.rows),
        "rows": [_row_object(row) for row in result.rows],
    }


def summary(result: Reproduction, *, written: Sequence[Path]) -> str:
    """Return what a person reads after the report was written."""
    counts = _counts(result.rows)
    width = max(map(len, counts))
    disagreeing = [row for row in result.rows if row.verdict is Verdict.MODEL_DISAGREES]
    return "\n".join(
        [
            f"{len(result.rows)} published numbers beside computed ones",
            *[f"  {verdict:<{width}}  {count:4d}" for verdict, count in counts.items()],
            *[
                f"  {row.source}: {row.id}: {row.published:.4g} published, {row.computed:.4g} computed"
                for row in disagreeing
            ],
            f"report: {written[0]}",
        ]
    )


def _counts(rows: Sequence[Row]) -> dict[str, int]:
    counted = Counter(row.verdict for row in rows)
    return {verdict.value: counted[verdict] for verdict in Verdict}


def _row_object(row: Row) -> dict[str, Any]:
    entry = asdict(row) | {"relative_error": row.relative_error, "verdict": row.verdict.value}
    order = (*(name for name in asdict(row) if name not in ("verdict", "note")), "relative_error", "verdict", "note")
    return {name: entry[name] for name in order}


def _draw(figure: ReportFigure) -> tuple[bytes, bytes]:
    import matplotlib.pyplot as plt

    with publication_style():
        drawn = figure.draw()
        try:
            return render_figure(drawn, "png"), render_figure(drawn, "svg")
        finally:
            plt.close(drawn)


def _page(result: Reproduction, pictures: dict[str, str]) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("sonolube.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    chapters = sorted({row.chapter for row in result.rows})
    return environment.get_template("reproduction.html").render(
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
