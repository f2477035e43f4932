"""Charts drawn by Matplotlib."""

from dataclasses import dataclass
from functools import singledispatch
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.charts.chart import Axis, Band, Bars, Chart, Colour, Field, Line, Note, Part, Points, Rule, Zone
from sonolube.figure import COLOURS, LINES, MARKERS, inches_in_print, subplots

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SCALES = {"cividis": "cividis", "viridis": "viridis", "grey": "Greys"}
_CATEGORIES = ("0.75", "#9ecae1", "#fdd0a2", "#c7e9c0", "#dadaeb")  # of a field of words
_PLACES: dict[str, Any] = {
    "top": "outside upper center",
    "bottom": "outside lower center",
    "right": "outside right upper",
}
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MARKER = 4.5  # points
_NUMBER_WIDTH, _NUMBER_HEIGHT = 0.38, 0.22  # inches that a number at a tick takes
_RATIO = 3.0  # of the ends of a logarithmic axis, below which also 1.2, 1.4, ... are numbered
_MAX_EDGED = 30  # bars
_MAX_WIDE = 70  # characters of a line of a title per 5 inches


def draw_chart(chart: Chart) -> "Figure":
    """Draw a chart.

    Parameters
    ----------
    chart : Chart

    Returns
    -------
    matplotlib.figure.Figure
    """
    rows = -(-len(chart.panels) // chart.columns)
    figure, grid = subplots(
        rows,
        chart.columns,
        figsize=chart.size,
        squeeze=False,
        sharex="col" if chart.shares_x else False,
        sharey="row" if chart.shares_y else False,
        width_ratios=chart.widths or None,
        height_ratios=chart.heights or None,
    )
    scales: list[_Scale] = []
    for place, axes in enumerate(grid.flat):
        if place >= len(chart.panels) or not chart.panels[place].parts:
            axes.set_axis_off()
            continue
        panel = chart.panels[place]
        for part in panel.parts:
            shades = _draw(part, axes)
            if shades is not None and isinstance(part, Field | Points):
                scales.append(_Scale(axes=axes, shades=shades, part=part))
        width, height = _size(chart, place)
        is_lowest, is_first = place + chart.columns >= len(chart.panels), place % chart.columns == 0
        across, up = _wrapped(panel.x.text, width), _wrapped(panel.y.text, 0.85 * height)
        _set_axis(axes, "x", panel.x, text=across if is_lowest or not chart.shares_x else "")
        _set_axis(axes, "y", panel.y, text=up if is_first or not chart.shares_y else "")
        if panel.has_equal_scales:
            axes.set_aspect("equal")
        if panel.title:
            axes.set_title(_wrapped(panel.title, width), fontsize=8)
        if chart.legend == "panels" and axes.get_legend_handles_labels()[1]:
            axes.legend(loc="best")
    _draw_scales(figure, grid, scales)
    _draw_texts(figure, grid, chart)
    figure.align_ylabels()
    return figure


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Scale:
    """Colours of a part, which need a scale beside its panel."""

    axes: "Axes"
    shades: Any
    part: Field | Points

    @property
    def is_of_contours(self) -> bool:
        """Whether the colours are those between levels."""
        return isinstance(self.part, Field) and self.part.levels is not None

    def equals(self, other: "_Scale") -> bool:
        """Whether one scale serves both."""
        own, others = (getattr(each.part, "levels", ()) for each in (self, other))
        return self.part.scale_text == other.part.scale_text and np.array_equal(own, others)


@singledispatch
def _draw(part: Part, axes: "Axes") -> Any:
    """Draw a part of a panel; returns its colours where they need a scale."""
    raise NotImplementedError(type(part).__name__)


@_draw.register(Line)
def _line(part: Line, axes: "Axes") -> None:
    from matplotlib import rcParams
    from matplotlib.patheffects import Normal, Stroke

    width = part.weight * float(rcParams["lines.linewidth"])
    axes.plot(
        part.x,
        part.y,
        color=_colour(part.colour),
        linestyle=LINES[part.dash % len(LINES)],
        linewidth=width,
        marker="" if part.marker is None else MARKERS[part.marker % len(MARKERS)],
        markersize=_MARKER - 1,
        drawstyle="steps-post" if part.is_stepped else "default",
        path_effects=[Stroke(linewidth=width + 1.8, foreground="white"), Normal()] if part.has_halo else None,
        label=part.label or None,
    )


@_draw.register(Band)
def _band(part: Band, axes: "Axes") -> None:
    axes.fill_between(
        part.x,
        part.low,
        part.high,
        color=_colour(part.colour),
        alpha=part.opacity,
        linewidth=0.0,
        zorder=2,  # as of lines, so that the order of the parts decides
        label=part.label or None,
    )


@_draw.register(Points)
def _points(part: Points, axes: "Axes") -> Any:
    colour, size, scale = _colour(part.colour), part.size * _MARKER, None
    if part.shades is not None:
        scale = _shaded_points(part, axes)
    elif part.is_faint:
        axes.plot(
            part.x, part.y, ".", color=colour, ms=2.5, alpha=0.6, rasterized=True, zorder=1, label=part.label or None
        )
    else:
        _, caps, bars = axes.errorbar(
            part.x,
            part.y,
            yerr=part.y_error,
            xerr=part.x_error,
            fmt=MARKERS[part.marker % len(MARKERS)],
            color=colour,
            markerfacecolor="none" if part.is_hollow else colour,
            markeredgecolor=colour if part.is_hollow else "white",
            markeredgewidth=1.0 if part.is_hollow else 0.5,
            markersize=size,
            elinewidth=1.0,
            capsize=2,
            clip_on=not part.x.size,  # what has no place would be laid out at the origin
            zorder=3,
            label=part.label or None,
        )
        for each in (*caps, *bars):
            each.set_clip_on(True)  # however far beyond the axes they reach
    box = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8}
    for x, y, text in zip(part.x, part.y, part.texts, strict=False):
        axes.annotate(text, (x, y), (6, -3), textcoords="offset points", fontsize=7, bbox=box, zorder=6)
    return scale


def _shaded_points(part: Points, axes: "Axes") -> Any:
    """Points coloured by a value, on the scale of the field below them or, which is returned, on one of their own."""
    from matplotlib.collections import PathCollection

    field = next((each for each in axes.collections if each.get_array() is not None), None)
    edge = "black" if field is None or isinstance(field, PathCollection) else "white"
    style: dict[str, Any] = {"s": 30 * part.size, "marker": MARKERS[part.marker % len(MARKERS)], "zorder": 4}
    colours: dict[str, Any] = {"norm": field.norm, "cmap": field.get_cmap()} if field else {"cmap": "viridis"}
    if field is None and part.scale_ends is not None:
        colours |= {"vmin": part.scale_ends[0], "vmax": part.scale_ends[1]}
    drawn = axes.scatter(
        part.x, part.y, c=part.shades, edgecolors=edge, linewidths=0.7, clip_on=False, **style, **colours
    )
    if part.label:
        axes.scatter([], [], facecolors="0.6", edgecolors="black", label=part.label, **style)
    return drawn if field is None and part.scale_text else None


@_draw.register(Rule)
def _rule(part: Rule, axes: "Axes") -> None:
    across = axes.axvline if part.along == "x" else axes.axhline
    across(part.value, color=_colour(part.colour), ls=LINES[part.dash], lw=0.9, label=part.label or None)


@_draw.register(Zone)
def _zone(part: Zone, axes: "Axes") -> None:
    across = axes.axvspan if part.along == "x" else axes.axhspan
    style: dict[str, Any] = {"color": _colour(part.colour), "alpha": part.opacity, "linewidth": 0, "zorder": 0}
    for place, (first, last) in enumerate(zip(part.first, part.last, strict=True)):
        across(first, last, label=None if place else part.label or None, **style)


@_draw.register(Field)
def _field(part: Field, axes: "Axes") -> Any:
    axes.grid(visible=False)
    if part.words:
        _draw_words(part, axes)
        return None
    name = _SCALES[part.scale]
    if part.levels is None:
        ends: dict[str, Any] = {"vmin": part.lowest, "vmax": part.highest}
        return axes.pcolormesh(part.x, part.y, part.values, cmap=name, rasterized=True, **ends)
    inside = np.clip(part.values, part.levels[0], part.levels[-1])
    drawn = axes.contourf(part.x, part.y, inside, levels=part.levels, cmap=name)
    known = part.values[np.isfinite(part.values)]
    if part.lines is not None and known.size and np.ptp(known) > 0:
        _draw_contour_lines(part, axes)
    return drawn


def _draw_words(part: Field, axes: "Axes") -> None:
    """Cells of a quantity without order, each name with a colour."""
    from matplotlib.colors import ListedColormap

    colours = ListedColormap(_CATEGORIES[: len(part.words)])
    ends: dict[str, Any] = {"vmin": -0.5, "vmax": len(part.words) - 0.5}
    axes.pcolormesh(part.x, part.y, part.values, cmap=colours, rasterized=True, **ends)
    for number in np.unique(part.values[np.isfinite(part.values)]).astype(int):
        axes.scatter([], [], marker="s", s=50, color=_CATEGORIES[number], label=part.words[number])


def _draw_contour_lines(part: Field, axes: "Axes") -> None:
    """White lines with their values; none near the ends of the axes, where they would be cut off."""
    from matplotlib.patheffects import Normal, Stroke

    lines = axes.contour(part.x, part.y, part.values, levels=part.lines, colors="white", linewidths=0.6)
    for label in axes.clabel(lines, fmt="%.3g", fontsize=6, inline=False):
        label.set_path_effects([Stroke(linewidth=2, foreground="#2a3f6e"), Normal()])
        position = (label.get_position()[0] - part.x[0]) / (part.x[-1] - part.x[0])
        label.set_visible(0.05 < position < 0.95)


@_draw.register(Bars)
def _bars(part: Bars, axes: "Axes") -> None:
    draw: Any = axes.barh if part.along == "x" else axes.bar
    drawn = draw(
        part.places,
        part.lengths,
        part.breadth,
        color=_colour(part.colour),
        hatch=part.hatch or None,
        edgecolor="white",
        linewidth=1.0 if len(part.places) <= _MAX_EDGED else 0.0,
        error_kw={"elinewidth": 1, "capsize": 2},
        label=part.label or None,
        **{f"{part.along}err": part.error},
    )
    if part.texts:
        axes.bar_label(drawn, labels=part.texts, padding=4, fontsize=8)
    axes.grid(visible=False, axis="y" if part.along == "x" else "x")


@_draw.register(Note)
def _note(part: Note, axes: "Axes") -> None:
    shift, side = {"right": ((6, 0), "left"), "left": ((-6, 0), "right"), "above": ((0, 5), "center")}[part.side]
    upright = "bottom" if part.side == "above" else "center"
    style: dict[str, Any] = {"ha": side, "va": upright, "fontsize": 7.5, "color": _colour(part.colour), "zorder": 5}
    axes.annotate(part.text, (part.x, part.y), shift, textcoords="offset points", **style)


def _colour(colour: Colour) -> str:
    """Colour of the palette, or a shade of grey."""
    return COLOURS[colour % len(COLOURS)] if isinstance(colour, int) else colour


def _size(chart: Chart, place: int) -> tuple[float, float]:
    """Width and height of a panel with what is written beside it, in inches."""
    rows = -(-len(chart.panels) // chart.columns)
    row, column = divmod(place, chart.columns)
    widths, heights = chart.widths or (1.0,) * chart.columns, chart.heights or (1.0,) * rows
    return chart.size[0] * widths[column] / sum(widths), chart.size[1] * heights[row] / sum(heights)


def _set_axis(axes: "Axes", name: str, axis: Axis, *, text: str) -> None:
    """Set label, scale, ends and ticks of an axis of a panel; an empty label where it shares that of another."""
    one = getattr(axes, f"{name}axis")
    if axis.logarithmic:
        getattr(axes, f"set_{name}scale")("log")
    if axis.lowest is not None or axis.highest is not None:
        getattr(axes, f"set_{name}lim")(axis.lowest, axis.highest)
    if axis.logarithmic and not axis.ticks:
        _number_decades(one, getattr(axes, f"get_{name}lim")(), most=_room(axes, name))
    if axis.ticks or axis.words:
        places = axis.ticks or tuple(map(float, range(len(axis.words))))
        one.set_ticks(places, labels=axis.words or [f"{place:.4g}" for place in places])
        one.set_ticks([], minor=True)
        if not any(axis.words) and axis.words:
            one.set_tick_params(length=0)
            axes.spines["bottom" if name == "x" else "left"].set_visible(False)
    elif not axis.logarithmic:
        one.get_major_formatter().set_useOffset(False)
    one.set_label_text(text)
    one.set_tick_params(labelbottom=True) if text and name == "x" else None
    if axis.reciprocal is not None:
        constant, label = axis.reciprocal
        _add_second_axis(axes, name, label, (lambda value: constant / np.maximum(value, 1e-9),) * 2)
    if axis.proportional is not None:
        factor, label = axis.proportional
        _add_second_axis(axes, name, label, (lambda value: factor * value, lambda value: value / factor))


def _add_second_axis(axes: "Axes", name: str, label: str, functions: tuple[Any, Any]) -> None:
    """Add an axis on the other side of a panel, by the function of its value and the inverse."""
    other = getattr(axes, f"secondary_{name}axis")("top" if name == "x" else "right", functions=functions)
    getattr(other, f"set_{name}label")(label)
    if getattr(axes, f"get_{name}scale")() == "log":
        first, last = map(functions[0], getattr(axes, f"get_{name}lim")())
        _number_decades(getattr(other, f"{name}axis"), (first, last), most=_room(axes, name))


def _room(axes: "Axes", name: str) -> float:
    """Number of labels that an axis has room for."""
    place, (width, height) = axes.get_position(), axes.get_figure().get_size_inches()  # type: ignore[union-attr]
    return float(place.width * width / _NUMBER_WIDTH if name == "x" else place.height * height / _NUMBER_HEIGHT)


def _number_decades(axis: Any, ends: tuple[float, float], *, most: float) -> None:
    """Write the numbers of a logarithmic axis in full; also 2 and 5 where there is room; more below a decade."""
    from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

    ratio = max(ends) / min(ends)
    if ratio < _RATIO:
        axis.set_major_locator(MaxNLocator(5))
    else:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if 3 * np.log10(ratio) < most else (1,)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(_number_text)  # not as formulas, which take ten times as long to draw


def _number_text(value: float, place: int | None = None) -> str:
    """Number of a logarithmic axis, by a power of ten where it is long."""
    if 1e-3 <= value < 1e5:
        return f"{value:g}"
    factor, _, exponent = f"{value:.2e}".partition("e")
    factor = f"{float(factor):g}"
    power = "10" + str(int(exponent)).translate(_SUPERSCRIPTS)
    return power if factor == "1" else f"{factor}·{power}"


def _draw_scales(figure: "Figure", grid: Any, scales: list[_Scale]) -> None:
    """Scale of colours: one for all panels where it serves them, else one each."""
    if len(scales) > 1 and all(each.is_of_contours and each.equals(scales[0]) for each in scales):
        _draw_scale(figure, grid, scales[0])
    else:
        for each in scales:
            _draw_scale(figure, each.axes, each)


def _draw_scale(figure: "Figure", place: Any, scale: _Scale) -> None:
    """Scale of colours beside some panels."""
    part = scale.part
    is_cut = isinstance(part, Field) and part.levels is None and part.lowest is not None
    bar = figure.colorbar(scale.shades, ax=place, label=part.scale_text, extend="both" if is_cut else None)
    if isinstance(part, Field) and part.levels is not None and part.lines is not None:
        bar.set_ticks(part.levels[:: max(1, (part.levels.size - 1) // 5)].tolist())


def _draw_texts(figure: "Figure", grid: Any, chart: Chart) -> None:
    """Title, and the labels of all panels, each once, beside the panels; a title over a legend is part of it."""
    title = _wrapped(chart.title, inches_in_print(chart.size[0]))
    entries: dict[str, Any] = {}
    for axes in grid.flat if chart.legend not in ("panels", "none") else ():
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    if title and not (entries and chart.legend == "top"):
        figure.suptitle(title, fontsize=9)
    if entries:
        heading = title if chart.legend == "top" else chart.legend_title
        legend = figure.legend(
            list(entries.values()),
            list(entries),
            loc=_PLACES[chart.legend],
            ncols=1 if chart.legend == "right" else min(chart.legend_columns, len(entries)),
            title=heading or None,
            title_fontsize=9,
        )
        legend.get_title().set_multialignment("center")


def _wrapped(text: str, width: float) -> str:
    """Title in lines that fit a width in inches."""
    most = max(14, int(_MAX_WIDE * width / 5))
    return "\n".join(part for line in text.split("\n") for part in wrap(line, most) or [""])
