"""Types of a figure as data: chart, panels, axes and their parts."""

from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass, replace
from typing import Any, Literal, TypeAlias

from sonolube.checks import Floats

Colour: TypeAlias = int | str
"""Number of a colour of the palette, or a shade of grey such as "0.5" from black, "0", to white, "1"."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Axis of a panel.

    Parameters
    ----------
    label : str
        Quantity, with a capital letter and without unit.
    unit : str
        Of all numbers along the axis; empty for pure numbers.
    logarithmic : bool
    lowest, highest : float or None
        Ends, in the unit; those of the parts with a margin where None. Runs downwards where `lowest` is greater.
    ticks : tuple of float
        Places of numbers or words; chosen by the drawing where empty.
    words : tuple of str
        At the ticks in place of numbers; at 0, 1, 2, ... where there are no ticks.
    reciprocal : tuple of (float, str), or None
        Constant c and label of a second axis on the other side, which shows c divided by the value.
    proportional : tuple of (float, str), or None
        Likewise, of one that shows c times the value.
    """

    label: str = ""
    unit: str = ""
    _: KW_ONLY
    logarithmic: bool = False
    lowest: float | None = None
    highest: float | None = None
    ticks: tuple[float, ...] = ()
    words: tuple[str, ...] = ()
    reciprocal: tuple[float, str] | None = None
    proportional: tuple[float, str] | None = None

    @property
    def text(self) -> str:
        """Label with its unit in brackets."""
        return _with_unit(self.label, self.unit)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Line:
    """Curve; x and y of shape (n,), NaN where it is interrupted.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
    label : str
        In the legend; none where empty.
    colour : int or str
    dash : int
        Number of a dash pattern; 0 is solid.
    marker : int or None
        Number of a marker at each value.
    weight : float
        Of the line, relative to the usual one.
    is_stepped : bool
        Whether a value holds until the next.
    has_halo : bool
        Whether the line is edged in white, on a field.
    """

    x: Floats
    y: Floats
    label: str = ""
    colour: Colour = 0
    dash: int = 0
    marker: int | None = None
    weight: float = 1.0
    is_stepped: bool = False
    has_halo: bool = False


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Band:
    """Range between two curves over x, all of shape (n,)."""

    x: Floats
    low: Floats
    high: Floats
    label: str = ""
    colour: Colour = 0
    opacity: float = 0.25


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Points:
    """Single values.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
    x_error, y_error : ndarray, shape (n,) or (2, n), or None
        Half width of the bar, or lengths below and above.
    sources : tuple of str
        Provenance of each value; empty or n.
    texts : tuple of str
        Drawn beside each value; empty or n.
    shades : ndarray, shape (n,), or None
        Values by which each is coloured as the field below is, or on a scale of their own.
    scale_text : str
        Label of that scale, with its unit; the scale is not drawn where empty.
    scale_ends : tuple of (float, float), or None
        Its ends; those of the values where None.
    marker, size : int, float
        Number of a marker, and its size relative to the usual one.
    is_hollow : bool
    is_faint : bool
        Whether there are so many that each is but a dot.
    """

    x: Floats
    y: Floats
    label: str = ""
    colour: Colour = 0
    marker: int = 0
    size: float = 1.0
    x_error: Floats | None = None
    y_error: Floats | None = None
    sources: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    shades: Floats | None = None
    scale_text: str = ""
    scale_ends: tuple[float, float] | None = None
    is_hollow: bool = False
    is_faint: bool = False


@dataclass(frozen=True, kw_only=True, slots=True)
class Rule:
    """Line across the panel at a value of an axis."""

    value: float
    along: Literal["x", "y"] = "x"
    label: str = ""
    colour: Colour = "0.4"
    dash: int = 3


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Zone:
    """Ranges of an axis from `first` to `last`, both of shape (n,), shaded over the whole panel."""

    first: Floats
    last: Floats
    along: Literal["x", "y"] = "x"
    label: str = ""
    colour: Colour = "0.85"
    opacity: float = 1.0


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Field:
    """Quantity over both axes.

    Parameters
    ----------
    x, y : ndarray, shape (m,) and (n,)
    values : ndarray, shape (n, m)
        NaN where it is not known; numbers of `words` where there are such.
    label, unit : str
        Of the scale of colours.
    levels : ndarray, or None
        Edges of filled contours; cells without contours where None.
    lines : ndarray, or None
        Levels drawn as lines with their value.
    lowest, highest : float or None
        Ends of the scale of cells.
    words : tuple of str
        Names of a quantity without order, in the order of its numbers.
    scale : {"cividis", "viridis", "grey"}
    """

    x: Floats
    y: Floats
    values: Floats
    label: str = ""
    unit: str = ""
    levels: Floats | None = None
    lines: Floats | None = None
    lowest: float | None = None
    highest: float | None = None
    words: tuple[str, ...] = ()
    scale: Literal["cividis", "viridis", "grey"] = "cividis"

    @property
    def scale_text(self) -> str:
        """Label of the scale of colours, with its unit in brackets."""
        return _with_unit(self.label, self.unit)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Bars:
    """Bars from zero of length `lengths` at places of the other axis, both of shape (n,).

    Parameters
    ----------
    places, lengths : ndarray, shape (n,)
    breadth : float
        In the unit of the places.
    along : {"x", "y"}
        Axis along which they extend.
    error : ndarray, shape (2, n), or None
        Below and above the end.
    texts : tuple of str
        At the end of each; empty or n.
    """

    places: Floats
    lengths: Floats
    breadth: float = 0.6
    along: Literal["x", "y"] = "x"
    label: str = ""
    colour: Colour = 0
    hatch: str = ""
    error: Floats | None = None
    texts: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, slots=True)
class Note:
    """Text at a place of the axes, `right` or `left` of it."""

    x: float
    y: float
    text: str
    side: Literal["right", "left", "above"] = "right"
    colour: Colour = "0.2"


Part: TypeAlias = Line | Band | Points | Rule | Zone | Field | Bars | Note


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Panel:
    """Two axes with what is drawn between them, in this order; a panel without parts is left empty."""

    x: Axis
    y: Axis
    parts: tuple[Part, ...]
    title: str = ""
    has_equal_scales: bool = False


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Chart:
    """Figure as data.

    Parameters
    ----------
    panels : tuple of Panel
        Row by row.
    size : (float, float)
        Width and height in inches.
    columns : int
    widths, heights : tuple of float
        Relative ones of columns and rows; equal where empty.
    title : str
    legend : {"top", "bottom", "right", "panels", "none"}
        Where the labels of all parts stand, each once; "panels" for those of each panel within it.
    legend_columns : int
    shares_x, shares_y : bool
        Whether panels of a column have one x axis, those of a row one y axis.
    """

    panels: tuple[Panel, ...]
    size: tuple[float, float] = (5.2, 3.6)
    columns: int = 1
    widths: tuple[float, ...] = ()
    heights: tuple[float, ...] = ()
    title: str = ""
    legend: Literal["top", "bottom", "right", "panels", "none"] = "panels"
    legend_columns: int = 3
    legend_title: str = ""
    shares_x: bool = False
    shares_y: bool = False

    def with_parts(self, place: int, *parts: Part) -> "Chart":
        """Chart with further parts in one of its panels."""
        changed = replace(self.panels[place], parts=(*self.panels[place].parts, *parts))
        return replace(self, panels=(*self.panels[:place], changed, *self.panels[place + 1 :]))


def one_panel(x: Axis, y: Axis, parts: Iterable[Part], *, has_equal_scales: bool = False, **layout: Any) -> Chart:
    """Chart with one panel; `layout` is what `Chart` takes beside its panels, such as the size."""
    panel = Panel(x=x, y=y, parts=tuple(parts), has_equal_scales=has_equal_scales)
    return Chart(panels=(panel,), **layout)


def _with_unit(label: str, unit: str) -> str:
    """Label with its unit in brackets; alone for a pure number."""
    return f"{label} [{unit}]" if unit else label
