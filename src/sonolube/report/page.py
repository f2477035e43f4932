"""Self-contained HTML page of a result, with its figures as files beside it."""

import base64
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from sonolube import __version__
from sonolube.charts import Chart, draw_chart
from sonolube.figure import fit_to_style, publication_style, render_figure
from sonolube.text.plain_text import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Advance = Callable[[str, int, int], None]
Rows = Sequence[tuple[str, str]]

_DEPENDENCIES = ("numpy", "scipy", "numba", "xarray", "matplotlib")  # whose versions decide numbers and figures


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Drawing:
    """A figure that is made when it is shown or written: a chart, or a picture that is no chart.

    Parameters
    ----------
    chart : callable, optional
        Returns the figure as data.
    draw : callable, optional
        Returns the figure, where it has no chart.
    caption : str
        Text under the figure on a page.
    forms : tuple of str
        Formats of its files: "png", "svg" or "pdf"; none for a figure without a file of its own.
    """

    chart: Callable[[], Chart] | None = None
    draw: "Callable[[], Figure] | None" = None
    caption: str = ""
    forms: tuple[str, ...] = ("png", "svg", "pdf")

    def figure(self) -> "Figure":
        """Draw the figure in the style in use, with the width of a column or of the page."""
        with publication_style():
            if self.chart is not None:
                figure = draw_chart(self.chart())
            else:
                assert self.draw is not None
                figure = self.draw()
            fit_to_style(figure)
        return figure


@dataclass(frozen=True, kw_only=True, slots=True)
class PageTable:
    """A table of a page, all cells as text.

    Parameters
    ----------
    title : str
    heads : tuple of str
        Of the columns, each with its unit.
    rows : tuple of tuple of str
        As many cells a row as there are heads.
    """

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Page:
    """Content of a page, figures and caveats apart.

    Parameters
    ----------
    name : str
        Of its file, without `.html`.
    title : str
    settings : sequence of pair of str
        What the result was computed for: rig, operating point, options.
    facts : sequence of pair of str
        What was found, and its value with its unit.
    tables : sequence of PageTable
    """

    name: str
    title: str
    settings: Rows
    facts: Rows
    tables: Sequence[PageTable] = ()


def drawn(drawing: Drawing, *, forms: Sequence[str]) -> dict[str, bytes]:
    """Content of the files of a figure, by format."""
    figure = drawing.figure()
    return {form: render_figure(figure, form) for form in forms}


def rendered_files(
    drawings: Mapping[str, Drawing],
    *,
    page: Page | None = None,
    notes: Sequence[str] = (),
    advance: Advance = lambda name, done, total: None,
) -> dict[str, str | bytes]:
    """Content of the files of figures, preceded by that of the page which shows them.

    Parameters
    ----------
    drawings : mapping of str to Drawing
        By the name of their files, without ending.
    page : Page, optional
        Holds its figures itself; no page where absent.
    notes : sequence of str
        Caveats and assumptions, a line each.
    advance : callable
        Called before each figure with its name, the number done and their total.

    Returns
    -------
    dict of str to str or bytes
        By file name: the page `NAME.html`, then every figure in each of its formats.
    """
    files: dict[str, str | bytes] = {}
    pictures = []
    for done, (name, drawing) in enumerate(drawings.items()):
        advance(name, done, len(drawings))
        forms = drawing.forms if page is None else tuple(dict.fromkeys(("png", *drawing.forms)))
        if not forms:
            continue
        contents = drawn(drawing, forms=forms)
        files |= {f"{name}.{form}": contents[form] for form in drawing.forms}
        if page is not None:
            pictures.append((name, drawing.caption, embedded(contents["png"])))
    if page is None:
        return files
    text = html("page.html", page=page, pictures=pictures, notes=notes, versions=_versions())
    return {f"{page.name}.html": text, **files}


def embedded(png: bytes) -> str:
    """PNG as base64 text, for an image within a page."""
    return base64.b64encode(png).decode()


def html(template: str, **values: Any) -> str:
    """Text of a page from one of the templates of this package, all values escaped and without control characters."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("sonolube.report"), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    return printable(environment.get_template(template).render(**values))


def _versions() -> str:
    """Versions of sonolube, Python and the packages that the numbers depend on."""
    packages = ", ".join(f"{package} {version(package)}" for package in _DEPENDENCIES)
    return f"sonolube {__version__}; Python {platform.python_version()}, {packages}"
