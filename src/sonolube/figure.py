"""Style and output of figures: a colour-blind-safe palette that is legible in grey print, and atomic file writing."""

import io
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from sonolube.errors import UnknownName
from sonolube.storage.files import write_atomically
from sonolube.text.plain_text import printable, with_micro_sign

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.ticker import FuncFormatter

# The palette of Okabe and Ito, ordered so that neighbours also differ in lightness; each colour has a marker.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">", "*")
LINES = ("-", "--", "-.", ":", (0, (5, 1)), (0, (3, 1, 1, 1)), (0, (1, 1)))

_AXES = ("xaxis", "yaxis", "zaxis")
_INCH = 25.4  # mm
_NARROW = 4.7  # inches: a figure drawn no wider fits one column
_OUTLINES = frozenset({"glyf", "loca", "head", "hhea", "hmtx", "maxp", "cvt ", "fpgm", "prep"})  # tables of a font


@dataclass(frozen=True, kw_only=True, slots=True)
class FigureStyle:
    """Sizes of figures for one use.

    Parameters
    ----------
    column_width, page_width : float
        Widths in mm of a figure of one column and of the whole page.
    largest_height : float
        Greatest height, in mm.
    smallest_text : float
        Least size of any text, in points.
    settings : mapping
        Of matplotlib, beside those that all styles share.
    """

    column_width: float
    page_width: float
    largest_height: float
    smallest_text: float
    settings: Mapping[str, float]


_FILE = tomllib.loads(Path(__file__).with_name("figure_styles.toml").read_text(encoding="utf-8"))
FIGURE_STYLES: Mapping[str, FigureStyle] = MappingProxyType(
    {name: FigureStyle(**entry) for name, entry in _FILE["styles"].items()}
)
"""Styles by name: widths and sizes of text for the columns of a journal, or for slides of 16:9."""

_in_use = "journal"


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
def figure_style(style: str | None) -> Iterator[None]:
    """Draw all figures of this context in a style."""
    global _in_use
    if style is None:
        style = _in_use
    if style not in FIGURE_STYLES:
        raise UnknownName.among(FIGURE_STYLES, kind="style of figures", name=style)
    before, _in_use = _in_use, style
    try:
        yield
    finally:
        _in_use = before


@contextmanager
def publication_style(style: str | None = None) -> Iterator[None]:
    """Apply the style of sonolube to figures drawn in this context."""
    import matplotlib as mpl
    from cycler import cycler

    with figure_style(style):
        settings = _FILE["settings"] | FIGURE_STYLES[_in_use].settings | {"axes.prop_cycle": cycler(color=COLOURS)}
        with mpl.rc_context(settings):
            yield


def subplots(rows: int = 1, columns: int = 1, *, figsize: tuple[float, float], **options: Any) -> tuple["Figure", Any]:
    """New figure with axes, which no state of matplotlib keeps."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=figsize)
    return figure, figure.subplots(rows, columns, **options)


def shown_in_notebooks(figure: "Figure") -> "Figure":
    """Figure, which a notebook shows as a picture where it is the value of a cell."""
    figure._repr_png_ = partial(render_figure, figure, "png")  # type: ignore[attr-defined]
    return figure


def fit_to_style(figure: "Figure") -> None:
    """Fit a figure to the width of a column or of the page of the style in use, with no text below its least size."""
    from matplotlib.text import Text

    style = FIGURE_STYLES[_in_use]
    width, height = figure.get_size_inches()
    target = (style.column_width if width <= _NARROW else style.page_width) / _INCH
    enlarged = style.page_width / FIGURE_STYLES["journal"].page_width
    height *= enlarged * min(target / (enlarged * width), 1.0) ** 0.5
    figure.set_size_inches(target, min(height, style.largest_height / _INCH))
    for text in figure.findobj(Text):
        text.set_fontsize(max(text.get_fontsize(), style.smallest_text))


def inches_in_print(inches: float) -> float:
    """Width that a figure of a width in inches gets in a journal: that of a column or of the page."""
    style = FIGURE_STYLES["journal"]
    return (style.column_width if inches <= _NARROW else style.page_width) / _INCH


def render_figure(figure: "Figure", file_format: str, *, resolution: float | None = None) -> bytes:
    """Figure as the content of a file, reproducible byte for byte.

    The first call computes the layout; later calls reuse it, and are much faster. Text is drawn as it is written,
    without formulas, and control characters as escapes.
    """
    buffer = io.BytesIO()
    metadata = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(file_format)
    _take_as_text(figure)
    with publication_style(), _embedded_outlines(file_format), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")  # a title may be in any script
        if file_format == "png":
            _lay_out(figure, resolution)
        figure.savefig(buffer, format=file_format, metadata=metadata, dpi=resolution)
        _keep_layout(figure)
    return buffer.getvalue()


def _lay_out(figure: "Figure", resolution: float | None) -> None:
    """Compute the layout of a figure that has none yet; `savefig` would draw the whole figure for it once more."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    engine, own = figure.get_layout_engine(), figure.dpi
    if engine is None or not figure.axes:
        return
    FigureCanvasAgg(figure)
    figure.dpi = mpl.rcParams["savefig.dpi"] if resolution is None else resolution
    engine.execute(figure)
    _keep_layout(figure)
    figure.dpi = own


def _keep_layout(figure: "Figure") -> None:
    """Draw a figure while it is laid out: under any engine, also that named "none", `savefig` draws it twice."""
    import matplotlib as mpl

    with mpl.rc_context({"figure.constrained_layout.use": False, "figure.autolayout": False}):
        figure.set_layout_engine(None)


@contextmanager
def _embedded_outlines(file_format: str) -> Iterator[None]:
    """Embed fonts in a PDF without the tables by which programs lay out text, for it holds placed outlines.

    Without them and without names of characters, a font is reduced to the characters of a figure in a third of the
    time.
    """
    if file_format != "pdf":
        yield
        return
    from fontTools import subset  # type: ignore[import-untyped]

    load = subset.load_font

    def load_outlines(*arguments: Any) -> Any:
        font = load(*arguments)
        if "glyf" in font:
            font.setGlyphOrder([f"glyph{number}" for number in range(font["maxp"].numGlyphs)])
            for table in set(font.keys()) - _OUTLINES - {"GlyphOrder"}:
                del font[table]
        return font

    subset.load_font = load_outlines
    try:
        yield
    finally:
        subset.load_font = load


def _take_as_text(figure: "Figure") -> None:
    """Draw titles, labels and legends as they are written, without reading formulas between dollar signs.

    They hold names of users and of their files. Numbers at ticks are left to matplotlib, which writes them as formulas
    on logarithmic axes; names at ticks are text too.
    """
    from matplotlib.text import Text
    from matplotlib.ticker import FuncFormatter

    texts = figure.findobj(Text)
    numbers: set[int] = set()
    for axis in (getattr(axes, name) for axes in figure.axes for name in _AXES if hasattr(axes, name)):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, FuncFormatter):  # also of names given to set_xticks
            axis.set_major_formatter(FuncFormatter(partial(_printable_name, formatter)))
        else:
            ticks = (*axis.majorTicks, *axis.minorTicks)
            numbers |= {id(axis.offsetText), *(id(text) for tick in ticks for text in (tick.label1, tick.label2))}
    for text in texts:
        if id(text) not in numbers:
            text.set_parse_math(False)
            text.set_text(with_micro_sign(printable(text.get_text())))


def _printable_name(formatter: "FuncFormatter", value: float, place: int | None = None) -> str:
    """Name at a tick, without control characters."""
    return with_micro_sign(printable(formatter(value, place)))


def write_figure(
    figure: "Figure", *, folder: Path, name: str, file_formats: tuple[str, ...] = ("png", "svg")
) -> list[Path]:
    """Write a figure once in each file format and return the paths."""
    return [write_atomically(folder / f"{name}.{each}", render_figure(figure, each)) for each in file_formats]
