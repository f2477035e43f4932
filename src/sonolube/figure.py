"""Style and output of figures: a colour-blind-safe palette that is legible in grey print, and atomic file writing."""

import io
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from sonolube.files import write_atomically
from sonolube.printable_text import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter

# The palette of Okabe and Ito, ordered so that neighbours also differ in lightness; each colour has a marker.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
LINES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)))

_AXES = ("xaxis", "yaxis", "zaxis")
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


def render_figure(figure: "Figure", file_format: str, *, resolution: float | None = None) -> bytes:
    """Return a figure as the content of a file, reproducible byte for byte.

    Parameters
    ----------
    figure : Figure
    file_format : {"png", "svg", "pdf"}
    resolution : float, optional
        Dots per inch, instead of those of the style.

    Returns
    -------
    bytes

    Notes
    -----
    The first call computes the layout; later calls reuse it, and are much faster. Text is drawn as it is written,
    without formulas, and control characters as escapes.
    """
    buffer = io.BytesIO()
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(file_format)
    _take_as_text(figure)
    with publication_style(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # a title may be in any script
        figure.savefig(buffer, format=file_format, metadata=metadata, dpi=resolution)
        figure.set_layout_engine("none")
    return buffer.getvalue()


def _take_as_text(figure: "Figure") -> None:
    """Have titles, labels and legends drawn as they are written, without reading formulas between dollar signs.

    They hold names of users and of their files. Numbers at ticks are left to matplotlib, which writes them as formulas
    on logarithmic axes; names at ticks are text too.
    """
    from matplotlib.text import Text
    from matplotlib.ticker import FuncFormatter

    numbers: set[int] = set()
    for axis in (getattr(axes, name) for axes in figure.axes for name in _AXES if hasattr(axes, name)):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, FuncFormatter):  # also of names given to set_xticks
            axis.set_major_formatter(FuncFormatter(partial(_printable_name, formatter)))
        else:
            numbers |= {id(text) for text in axis.findobj(Text) if text is not axis.label}
    for text in figure.findobj(Text):
        if id(text) not in numbers:
            text.set_parse_math(False)
            text.set_text(printable(text.get_text()))


def _printable_name(formatter: "FuncFormatter", value: float, place: int | None = None) -> str:
    """Name at a tick, without control characters."""
    return printable(formatter(value, place))


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
