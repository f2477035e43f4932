"""A self-contained page of findings: what was asked, the numbers found, the figures."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube import __version__
from sonolube.figure import rendered
from sonolube.files import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Finding:
    """A figure of a page.

    Parameters
    ----------
    name : str
        Of its files.
    caption : str
        What it shows.
    figure : Figure
    """

    name: str
    caption: str
    figure: "Figure"


def write_findings(
    *,
    title: str,
    facts: Sequence[tuple[str, str]],
    figures: Sequence[Finding],
    notes: Sequence[str],
    folder: Path,
    name: str,
) -> list[Path]:
    """Write a page and its figures as PNG and SVG.

    Parameters
    ----------
    title : str
    facts : sequence of pair of str
        What was found, and its value with its unit.
    figures : sequence of Finding
    notes : sequence of str
        Assumptions and doubts, a line each.
    folder : Path
        Where to; made where it is missing.
    name : str
        Of the page's file, without `.html`.

    Returns
    -------
    list of Path
        The files, the page first.

    Raises
    ------
    InvalidInput
        If the folder cannot be written to.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    files: list[Path] = []
    pictures = []
    for finding in figures:
        png = rendered(finding.figure, "png")
        files.append(write_whole(folder / f"{finding.name}.png", png))
        files.append(write_whole(folder / f"{finding.name}.svg", rendered(finding.figure, "svg")))
        pictures.append((finding, base64.b64encode(png).decode()))
    environment = Environment(
        loader=PackageLoader("sonolube.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    page = environment.get_template("findings.html").render(
        version=__version__, title=title, facts=facts, pictures=pictures, notes=notes
    )
    return [write_whole(folder / f"{name}.html", page), *files]
