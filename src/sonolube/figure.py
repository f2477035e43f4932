"""Style and output of figures: a colour-blind-safe palette that is legible in grey print, and atomic file writing."""

import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The palette of Okabe and Ito, ordered so that neighbours also differ in lightness; each colour has a marker.
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
    """Figure with title and caption, drawn on demand.

    Parameters
    ----------
    name : str
        Name of its file, without ending.
    title : str
        Content of the figure.
    caption : str
        Explanation, with the source of every data point.
    draw : callable
        Function that draws the figure.
    """

    name: str
    title: str
    caption: str
    draw: "Callable[[], Figure]"


@contextmanager
def publication_style() -> Iterator[None]:
    """Apply the style of sonolube to figures drawn in this context."""
    import matplotlib as mpl
    from cycler import cycler

    with mpl.rc_context(_STYLE | {"axes.prop_cycle": cycler(color=COLOURS)}):  # type: ignore[arg-type]
        yield


def render_figure(figure: "Figure", file_format: str) -> bytes:
    """Return a figure as the content of a file, reproducible byte for byte.

    Parameters
    ----------
    figure : Figure
    file_format : {"png", "svg", "pdf"}

    Returns
    -------
    bytes

    Notes
    -----
    The first call computes the layout; later calls reuse it, and are much faster.
    """
    buffer = io.BytesIO()
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(file_format)
    with publication_style():
        figure.savefig(buffer, format=file_format, metadata=metadata)
        figure.set_layout_engine("none")
    return buffer.getvalue()


def write_figure(
    figure: "Figure", *, folder: Path, name: str, file_formats: tuple[str, ...] = ("png", "svg")
) -> list[Path]:
    """Write a figure once in each file format and return the paths.

    Parameters
    ----------
    figure : Figure
    folder : Path
    name : str
        File name without suffix.
    file_formats : tuple of str

    Returns
    -------
    list of Path

    Raises
    ------
    InvalidInput
        If the folder cannot be written to.
    """
    return [write_atomically(folder / f"{name}.{each}", render_figure(figure, each)) for each in file_formats]
