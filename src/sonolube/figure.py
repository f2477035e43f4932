"""Figures as journals print them: units on every axis, legible, safe for colour-blind eyes and for grey print."""

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The colours of Okabe and Ito, ordered so that neighbours differ in lightness too; each comes with its own marker.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
LINES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)))

_STYLE = {
    "axes.formatter.min_exponent": 4,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "figure.constrained_layout.use": True,
    "figure.dpi": 110,
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "lines.markersize": 5,
    "savefig.dpi": 200,
    "svg.fonttype": "none",
    "svg.hashsalt": "sonolube",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class ReportFigure:
    """A figure of the report.

    Parameters
    ----------
    name : str
        Its file's name, without ending.
    chapter : int
        Chapter of the source it belongs to.
    title : str
        What it shows.
    caption : str
        What to see in it, and where every point comes from.
    draw : callable
        Draws it.
    """

    name: str
    chapter: int
    title: str
    caption: str
    draw: "Callable[[], Figure]"


@contextmanager
def publication_style() -> Iterator[None]:
    """Draw figures inside this context to give them the house's style."""
    import matplotlib as mpl
    from cycler import cycler

    with mpl.rc_context(_STYLE | {"axes.prop_cycle": cycler(color=COLOURS)}):  # type: ignore[arg-type]
        yield


def render_figure(figure: "Figure", form: str) -> bytes:
    """Return the figure as a file's content; `form` is "png", "svg" or "pdf". The same figure gives the same bytes.

    It is laid out by the first file; others have the same layout, and much sooner.
    """
    buffer = io.BytesIO()
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(form)
    with publication_style():
        figure.savefig(buffer, format=form, metadata=metadata)
        figure.set_layout_engine("none")
    return buffer.getvalue()


def write_figure(figure: "Figure", *, folder: Path, name: str, forms: tuple[str, ...] = ("png", "svg")) -> list[Path]:
    """Write the figure once in each form and return the files.

    Raises
    ------
    InvalidInput
        If the folder cannot be written to.
    """
    return [write_atomically(folder / f"{name}.{form}", render_figure(figure, form)) for form in forms]
