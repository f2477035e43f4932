"""Texts, axes, styles and error bars of the reproduction's figures; matplotlib is imported when a figure is drawn."""

import tomllib
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from numpy.typing import ArrayLike

from sonolube.facts.published import PrintedNumber
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure, subplots
from sonolube.validation.published_tests import FrictionTest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class FigureText(NamedTuple):
    """Title and caption of a figure in the file of this room, the caption with fields for numbers and notes."""

    title: str
    caption: str


@cache
def figure_texts() -> Mapping[str, FigureText]:
    """Titles and captions by the names of the figures."""
    content = tomllib.loads(Path(__file__).with_name("figures.toml").read_text(encoding="utf-8"))
    return {name: FigureText(**entry) for name, entry in content.items()}


def report_figure(name: str, draw: "Callable[[], Figure]", **fields: float | str) -> ReportFigure:
    """Figure with the title and caption of its name, numbers and notes put into the fields of the caption."""
    text = figure_texts()[name]
    return ReportFigure(name=name, title=text.title, caption=text.caption.format(**fields), draw=draw)


def single_axes(figsize: tuple[float, float] = (4.8, 3.6)) -> "tuple[Figure, Axes]":
    """Figure with one pair of axes, its width and height in inches."""
    return subplots(figsize=figsize)


def axes_row(count: int, figsize: tuple[float, float], **options: Any) -> "tuple[Figure, list[Axes]]":
    """Figure with several axes side by side."""
    figure, panels = subplots(1, count, figsize=figsize, **options)
    return figure, list(panels)


def line_style(index: int) -> dict[str, Any]:
    """Colour and line style of the curve of an index."""
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": LINES[index % len(LINES)]}


def curve_style(index: int) -> dict[str, Any]:
    """Colour, line style and marker of the curve of an index."""
    return line_style(index) | {"marker": MARKERS[index % len(MARKERS)]}


def point_style(index: int) -> dict[str, Any]:
    """Colour and marker of the points of an index, without a line."""
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
    """Draw measured friction ratios with their uncertainties as points."""
    x, ratios = [abscissa(test) for test in tests], [test.friction_ratio for test in tests]
    errors = [test.uncertainty or 0.0 for test in tests]
    axes.errorbar(x, ratios, yerr=errors, fmt=fmt, color=color, capsize=3, zorder=5, label=label)


def draw_printed(
    axes: "Axes", x: ArrayLike, numbers: Iterable[PrintedNumber], factor: float = 1.0, **style: Any
) -> None:
    """Draw printed numbers times a factor as points with the error bars of their intervals."""
    printed = list(numbers)
    low = [factor * (number.value - number.low) for number in printed]
    high = [factor * (number.high - number.value) for number in printed]
    axes.errorbar(x, [factor * number.value for number in printed], yerr=[low, high], **{"capsize": 3} | style)
