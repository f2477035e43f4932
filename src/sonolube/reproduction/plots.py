"""Axes, styles and error bars of the reproduction's figures; matplotlib is imported when a figure is drawn."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from sonolube.facts.published import PrintedNumber
from sonolube.figure import COLOURS, LINES, MARKERS, subplots
from sonolube.validation.published_tests import FrictionTest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def single_axes(figsize: tuple[float, float] = (4.8, 3.6)) -> "tuple[Figure, Axes]":
    """Return a figure with one pair of axes, its width and height in inches."""
    return subplots(figsize=figsize)


def axes_row(count: int, figsize: tuple[float, float], **options: Any) -> "tuple[Figure, list[Axes]]":
    """Return a figure with several axes side by side.

    Parameters
    ----------
    count : int
        Number of axes.
    figsize : tuple of float
        Width and height of the figure in inches.
    **options
        Options of `sonolube.figure.subplots`, such as ``sharey=True``.

    Returns
    -------
    Figure, list of Axes
    """
    figure, panels = subplots(1, count, figsize=figsize, **options)
    return figure, list(panels)


def line_style(index: int) -> dict[str, Any]:
    """Return colour and line style of the curve of an index."""
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": LINES[index % len(LINES)]}


def curve_style(index: int) -> dict[str, Any]:
    """Return colour, line style and marker of the curve of an index."""
    return line_style(index) | {"marker": MARKERS[index % len(MARKERS)]}


def point_style(index: int) -> dict[str, Any]:
    """Return colour and marker of the points of an index, without a line."""
    return curve_style(index) | {"linestyle": "none"}


def draw_measured(
    axes: "Axes",
    tests: tuple[FrictionTest, ...],
    abscissa: Callable[[FrictionTest], float],
    label: str,
    *,
    fmt: str = "o",
    color: str = "black",
) -> None:
    """Draw measured friction ratios with their uncertainties as points.

    Parameters
    ----------
    axes : Axes
    tests : tuple of FrictionTest
    abscissa : callable
        Function of a test that returns its abscissa.
    label : str
        Label in the legend.
    fmt, color : str
        Marker and colour.
    """
    x, ratios = [abscissa(test) for test in tests], [test.friction_ratio for test in tests]
    errors = [test.uncertainty or 0.0 for test in tests]
    axes.errorbar(x, ratios, yerr=errors, fmt=fmt, color=color, capsize=3, zorder=5, label=label)


def draw_printed(
    axes: "Axes", x: ArrayLike, numbers: Iterable[PrintedNumber], factor: float = 1.0, **style: Any
) -> None:
    """Draw printed numbers times a factor as points with the error bars of their intervals.

    Parameters
    ----------
    axes : Axes
    x : array_like
        Abscissae.
    numbers : iterable of PrintedNumber
    factor : float
        Factor of numbers and error bars.
    **style
        Options of `matplotlib.axes.Axes.errorbar`.
    """
    printed = list(numbers)
    low = [factor * (number.value - number.low) for number in printed]
    high = [factor * (number.high - number.value) for number in printed]
    axes.errorbar(x, [factor * number.value for number in printed], yerr=[low, high], **{"capsize": 3} | style)
