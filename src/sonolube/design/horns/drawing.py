"""Dimensioned drawing of a tuned horn: side view to scale, with lengths, diameters, radii and notes."""

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.design.horns.profile import HornProfile
from sonolube.design.horns.tuning import HornDesign
from sonolube.facts.materials import Material
from sonolube.figure import FIGURE_STYLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SHEET = FIGURE_STYLES["journal"].page_width  # mm
_VIEW = (132.0, 44.0)  # mm, largest width and height of the side view
_SCALES = (50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02)  # ISO 5455
_CHARACTER = 1.9  # mm, width of a character with a margin
_TEXT = 7.5  # points
_ROW = 5.0  # mm, height of a line of text
_STROKE = 1.0  # mm, half the oblique stroke at the ends of a dimension line
_THIN: dict[str, Any] = {"color": "0.35", "linewidth": 0.6}


def horn_notes(design: HornDesign, material: Material, profile: HornProfile) -> list[str]:
    """Text of a drawing: shape, material and mass, tuned mode, node, and what the dimensions leave open."""
    mode = design.tuned.mode
    mass = 1e3 * design.geometry.volume * material.value("density")
    widths = "width" if profile.thickness else "diameters"
    return [
        f"{design.body.name.replace('_', ' ')} of {material.name}, {mass:.4g} g",
        f"{mode.names[mode.row]} at {mode.frequency:.0f} Hz by finite elements, trim"
        f" {1e-3 * design.tuned.frequency_per_length:+.1f} Hz/mm of {design.body.tuned_size.replace('_', ' ')}",
        f"node of the axial motion {_millimetres(design.node_position)} from the driven face",
        *profile.notes,
        f"nominal lengths and {widths} in mm; tolerances, finish and threads are not part of the design",
    ]


def horn_drawing(profile: HornProfile, *, notes: Sequence[str]) -> "Figure":
    """Side view of a horn on its centre line, to scale, with all its dimensions in mm.

    As wide as the page of a journal, on which it is to scale.
    """
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import PlaceHolderLayoutEngine

    outline = 1e3 * profile.outline
    length, half = outline.max(axis=0)
    scale = next((each for each in _SCALES if each * length <= _VIEW[0] and 2 * each * half <= _VIEW[1]), _SCALES[-1])
    ratio = f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"
    notes = [*notes, f"scale {ratio} at a width of {_SHEET:g} mm"]
    rows = 2 if len(profile.stations) > 2 else 1
    middle = _ROW * (len(notes) + 1 + 2 * rows) + scale * half + 3
    height = middle + scale * half + 2.5 * _ROW
    figure = Figure(
        figsize=(_SHEET / 25.4, height / 25.4),
        layout=PlaceHolderLayoutEngine(adjust_compatible=True, colorbar_gridspec=True),
    )
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0, _SHEET), ylim=(0, height), aspect="equal")
    axes.set_axis_off()
    left = (_SHEET - scale * length) / 2
    _view(axes, np.array([left, middle]) + scale * outline, middle)
    _widths(axes, profile, left=left, middle=middle, scale=scale)
    foot = middle - scale * half
    ends = [left + 1e3 * scale * place for place in profile.stations]
    lowest = foot - 2 * _ROW * rows + 3
    for end in ends if rows > 1 else (ends[0], ends[-1]):
        outermost = end in (ends[0], ends[-1])
        at = float(np.interp(end, *_surface(left, middle, scale * outline)))
        bottom = lowest if outermost else foot - _ROW - 1
        axes.plot([end, end], [2 * middle - at - 1, bottom - 1], **_THIN)
    if rows > 1:
        _lengths(axes, ends, 1e3 * np.diff(profile.stations), at=foot - _ROW - 1)
    _lengths(axes, [ends[0], ends[-1]], [length], at=lowest)
    for row, note in enumerate(notes):
        axes.text(8, _ROW * (len(notes) - row - 0.4), note, fontsize=_TEXT, va="center")
    return figure


def _millimetres(length: float) -> str:
    """Length in m as text in mm, to a hundredth."""
    return f"{1e3 * length:.2f}"


def _surface(left: float, middle: float, outline: Floats) -> tuple[Floats, Floats]:
    """Places on the sheet of the upper surface, without the axis, rising from left to right."""
    upper = outline[outline[:, 1] > 0]
    return left + upper[:, 0], middle + upper[:, 1]


def _view(axes: "Axes", upper: Floats, middle: float) -> None:
    """Both halves of the side view, the edges across it, its centre line and the names of its faces."""
    from matplotlib.patches import Polygon

    surface = upper[upper[:, 1] > middle]
    whole = np.concatenate([surface, (surface * [1, -1] + [0, 2 * middle])[::-1]])
    axes.add_patch(Polygon(whole, facecolor="0.93", edgecolor="black", linewidth=1.1, joinstyle="miter"))
    left, right = surface[0, 0], surface[-1, 0]
    axes.plot([left - 3, right + 3], [middle, middle], color="black", linewidth=0.6, dashes=(12, 3, 2, 3))
    for place, name, side in ((left - 4, "driven\nface", "right"), (right + 4, "working\nface", "left")):
        axes.text(place, middle, name, fontsize=_TEXT, ha=side, va="center")


def _widths(axes: "Axes", profile: HornProfile, *, left: float, middle: float, scale: float) -> None:
    """Diameters or widths and radii above the view, each with a line to its place on the surface."""
    sign = "width " if profile.thickness else "⌀"
    marks = [(place, width / 2, f"{sign}{_millimetres(width)}") for place, width in profile.widths]
    marks += [(place, distance, f"R{_millimetres(radius)}") for place, distance, radius in profile.fillets]
    if profile.thickness:
        place, width = profile.widths[-1]
        end = profile.stations[-1]
        distance = width / 2 if place == end else profile.widths[0][1] / 2
        marks.append((0.9 * end, distance, f"thickness {_millimetres(profile.thickness)}"))
    marks.sort()
    top = middle + 1e3 * scale * max(width for _, width in profile.widths) / 2
    places = [left + 1e3 * scale * place for place, _, _ in marks]
    texts = _spread(places, [_CHARACTER * len(text) + 2 for _, _, text in marks])
    for place, text_place, (_, distance, text) in zip(places, texts, marks, strict=True):
        surface = middle + 1e3 * scale * distance
        axes.plot([text_place, place, place], [top + 5, top + 2, surface], **_THIN)
        axes.plot(place, surface, "o", color="black", markersize=2)
        axes.text(text_place, top + 5.5, text, fontsize=_TEXT, ha="center", va="bottom")


def _lengths(axes: "Axes", ends: Sequence[float], lengths: Sequence[float] | Floats, *, at: float) -> None:
    """Chain of dimension lines with the lengths in mm below them."""
    axes.plot([ends[0], ends[-1]], [at, at], **_THIN)
    for end in ends:
        axes.plot([end - _STROKE, end + _STROKE], [at - _STROKE, at + _STROKE], color="black", linewidth=0.9)
    texts = [f"{length:.2f}" for length in lengths]
    middles = [(one + other) / 2 for one, other in pairwise(ends)]
    for middle, place, text in zip(
        middles, _spread(middles, [_CHARACTER * len(text) + 2 for text in texts]), texts, strict=True
    ):
        if abs(place - middle) > _STROKE:
            axes.plot([middle, place], [at, at - 1.8], **_THIN)
        axes.text(place, at - 2, text, fontsize=_TEXT, ha="center", va="top")


def _spread(places: Sequence[float], widths: Sequence[float]) -> list[float]:
    """Middles of texts of given widths side by side on the sheet, each near its own place, in the same order."""
    found: list[float] = []
    for k, place in enumerate(places):
        least = found[-1] + (widths[k - 1] + widths[k]) / 2 if found else widths[0] / 2
        found.append(max(place, least))
    shift = [(found[k] - places[k]) for k in range(len(places))]
    found = [place - max(shift) / 2 for place in found] if len(found) > 1 and max(shift) > 0 else found
    right = _SHEET
    for k in reversed(range(len(found))):
        found[k] = min(found[k], right - widths[k] / 2)
        right = found[k] - widths[k] / 2
    return found
