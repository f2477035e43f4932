"""A self-contained page of findings: what was asked, the numbers found, the figures, caveats."""

import base64
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube import __version__
from sonolube.figure import render_figure
from sonolube.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_RESTS_ON = ("numpy", "scipy", "numba", "xarray", "matplotlib")  # what the numbers and the figures are computed with


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


@dataclass(frozen=True, kw_only=True, slots=True)
class FindingTable:
    """A table of numbers of a page.

    Parameters
    ----------
    title : str
    heads : tuple of str
        Of the columns, each with its unit.
    rows : tuple of tuple of str
        As many cells to a row as there are heads.
    """

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def write_findings(
    *,
    title: str,
    facts: Sequence[tuple[str, str]],
    figures: Sequence[Finding],
    notes: Sequence[str],
    folder: Path,
    name: str,
    asked: Sequence[tuple[str, str]] = (),
    tables: Sequence[FindingTable] = (),
    forms: Sequence[str] = ("png", "svg"),
) -> list[Path]:
    """Write a page, and its figures beside it.

    Parameters
    ----------
    title : str
    facts : sequence of pair of str
        What was found, and its value with its unit.
    figures : sequence of Finding
    notes : sequence of str
        Assumptions and caveats, a line each.
    folder : Path
        Where to; made where it is missing.
    name : str
        Of the page's file, without `.html`.
    asked : sequence of pair of str
        What was asked: rig, ranges, settings.
    tables : sequence of FindingTable
    forms : sequence of str
        In which each figure is written beside the page: png, svg or pdf. The page holds its own.

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
        png = render_figure(finding.figure, "png")
        for form in forms:
            content = png if form == "png" else render_figure(finding.figure, form)
            files.append(write_atomically(folder / f"{finding.name}.{form}", content))
        pictures.append((finding, base64.b64encode(png).decode()))
    environment = Environment(
        loader=PackageLoader("sonolube.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    page = environment.get_template("findings.html").render(
        title=title, asked=asked, facts=facts, tables=tables, pictures=pictures, notes=notes, versions=_versions()
    )
    return [write_atomically(folder / f"{name}.html", page), *files]


def _versions() -> str:
    """Return what computed the page."""
    rests_on = ", ".join(f"{package} {version(package)}" for package in _RESTS_ON)
    return f"sonolube {__version__}; Python {platform.python_version()}, {rests_on}"
