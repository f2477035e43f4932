"""Profiles of tuned horns with their dimensions, as a DXF file of AutoCAD R12 in mm and as a dimensioned drawing."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import pi, tan
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.design.horns.shapes import TunableBody
from sonolube.design.horns.tuning import HornDesign
from sonolube.facts.materials import Material
from sonolube.figure import FIGURE_STYLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STATIONS = 5  # of an exponential horn at which its diameter is stated
_CURVE_POINTS = 201
_QUARTER_ARC = tan(pi / 8)  # bulge of a vertex of a DXF polyline from which a quarter of a circle starts
_TEXT_HEIGHT = 3.0  # mm

Vertex = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class HornProfile:
    """Closed half profile of a horn between its axis and its surface, with the dimensions that make it.

    Parameters
    ----------
    vertices : tuple of (float, float, float)
        Distance from the driven face, distance from the axis, both in m, and the bulge of the edge to the next vertex:
        zero for a straight line, the tangent of a quarter of its angle for an arc.
    stations : tuple of float
        Distances from the driven face at which sections begin and end, in m.
    widths : tuple of (float, float)
        Distance from the driven face, and the diameter, or width of a block, there, in m.
    fillets : tuple of (float, float, float)
        Distance from the driven face, distance from the axis, and radius of each fillet, in m.
    thickness : float or None
        Of a block; None for a body of revolution. [m]
    notes : tuple of str
        What no dimension states.
    """

    vertices: tuple[Vertex, ...]
    stations: tuple[float, ...]
    widths: tuple[tuple[float, float], ...]
    fillets: tuple[tuple[float, float, float], ...] = ()
    thickness: float | None = None
    notes: tuple[str, ...] = ()

    @property
    def outline(self) -> Floats:
        """Half profile with arcs as polygons, shape (n, 2): distances from the driven face and from the axis. [m]"""
        points: list[Floats] = []
        for start, end in pairwise((*self.vertices, self.vertices[0])):
            one, other, bulge = np.array(start[:2]), np.array(end[:2]), start[2]
            along = np.linspace(0.0, 1.0, 33 if bulge else 2)[:-1, np.newaxis]
            if not bulge:
                points.append(one + along * (other - one))
                continue
            middle, half = (one + other) / 2, (other - one) / 2
            centre = middle + (1 / bulge - bulge) / 2 * np.array([-half[1], half[0]])
            angle = 4 * np.arctan(bulge) * along
            spoke = one - centre
            across = np.array([-spoke[1], spoke[0]])
            points.append(centre + np.cos(angle) * spoke + np.sin(angle) * across)
        return np.concatenate(points)


def horn_profile(body: TunableBody, *, length: float) -> HornProfile | None:
    """Half profile of a horn of a named shape; none for a body from a file."""
    if not body.sizes:
        return None
    return _PROFILES[body.name]({**body.sizes, body.tuned_size: length})


def profile_dxf(profile: HornProfile, lines: Iterable[str]) -> str:
    """Half profile and centre line as a DXF file of AutoCAD R12, in mm.

    ASCII, on the layers PROFILE, CENTRE and TEXT.

    Source: Autodesk, AutoCAD Release 12 Customization Manual, Appendix: Drawing Interchange Format.
    """
    end = max(place for place, _, _ in profile.vertices)
    overhang = 0.05 * end
    tags: list[tuple[int, object]] = [(999, "lengths in mm"), (0, "SECTION"), (2, "HEADER"), (9, "$ACADVER")]
    tags += [(1, "AC1009"), (0, "ENDSEC"), (0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LTYPE"), (70, 2)]
    tags += [(0, "LTYPE"), (2, "CONTINUOUS"), (70, 0), (3, "Solid line"), (72, 65), (73, 0), (40, 0.0)]
    tags += [(0, "LTYPE"), (2, "CENTER"), (70, 0), (3, "Long and short dashes"), (72, 65), (73, 4), (40, 50.8)]
    tags += [(49, dash) for dash in (31.75, -6.35, 6.35, -6.35)]
    tags += [(0, "ENDTAB"), (0, "TABLE"), (2, "LAYER"), (70, 3)]
    for name, line, colour in (("PROFILE", "CONTINUOUS", 7), ("CENTRE", "CENTER", 1), ("TEXT", "CONTINUOUS", 3)):
        tags += [(0, "LAYER"), (2, name), (70, 0), (62, colour), (6, line)]
    tags += [(0, "ENDTAB"), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]
    tags += [(0, "POLYLINE"), (8, "PROFILE"), (66, 1), *_point(0.0, 0.0), (70, 1)]
    for place, distance, bulge in profile.vertices:
        tags += [(0, "VERTEX"), (8, "PROFILE"), *_point(place, distance), *([(42, bulge)] if bulge else [])]
    tags += [(0, "SEQEND"), (8, "PROFILE"), (0, "LINE"), (8, "CENTRE"), *_point(-overhang, 0.0)]
    tags += _point(end + overhang, 0.0, first=11)
    for row, line in enumerate(lines, 2):
        tags += [(0, "TEXT"), (8, "TEXT"), *_point(0.0, -2e-3 * _TEXT_HEIGHT * row), (40, _TEXT_HEIGHT)]
        tags.append((1, line.replace("⌀", "%%c").encode("ascii", "replace").decode()))
    tags += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code:3d}\n{_value(value)}\n" for code, value in tags)


def _value(value: object) -> str:
    """Value of a tag; lengths to a tenth of a nanometre."""
    return f"{round(value, 10):.10g}" if isinstance(value, float) else str(value)


def _point(place: float, distance: float, *, first: int = 10) -> list[tuple[int, object]]:
    """Tags of a point given in m, in mm."""
    return [(first, 1e3 * place), (first + 10, 1e3 * distance), (first + 20, 0.0)]


def _closed(outline: Iterable[tuple[float, float]], bulges: Mapping[int, float] | None = None) -> tuple[Vertex, ...]:
    """Vertices from the axis along an outline and back, with the bulges of edges by the number of their first point."""
    points = list(outline)
    curved = bulges or {}
    surface = [(place, distance, curved.get(k, 0.0)) for k, (place, distance) in enumerate(points)]
    return ((points[0][0], 0.0, 0.0), *surface, (points[-1][0], 0.0, 0.0))


def _cylinder(sizes: Mapping[str, float]) -> HornProfile:
    """Profile of a cylinder."""
    length, radius = sizes["length"], sizes["radius"]
    return HornProfile(
        vertices=_closed([(0.0, radius), (length, radius)]), stations=(0.0, length), widths=((length / 2, 2 * radius),)
    )


def _conical(sizes: Mapping[str, float]) -> HornProfile:
    """Profile of a cone."""
    length, radius, end = sizes["length"], sizes["radius"], sizes["end_radius"]
    return HornProfile(
        vertices=_closed([(0.0, radius), (length, end)]),
        stations=(0.0, length),
        widths=((0.0, 2 * radius), (length, 2 * end)),
    )


def _exponential(sizes: Mapping[str, float]) -> HornProfile:
    """Profile of an exponential horn, with its diameter at quarters of its length."""
    length, radius, ratio = sizes["length"], sizes["radius"], sizes["end_radius"] / sizes["radius"]
    z, stations = (np.linspace(0.0, length, count) for count in (_CURVE_POINTS, _STATIONS))
    ends = [f"{2e3 * each:.2f}" for each in (radius, ratio * radius)]
    return HornProfile(
        vertices=_closed(zip(z.tolist(), (radius * ratio ** (z / length)).tolist(), strict=True)),
        stations=tuple(stations.tolist()),
        widths=tuple((float(place), float(2 * radius * ratio ** (place / length))) for place in stations),
        notes=(f"diameter at z from the driven face: {ends[0]} ({ends[1]}/{ends[0]})^(z/{1e3 * length:.2f})",),
    )


def _stepped(sizes: Mapping[str, float]) -> HornProfile:
    """Profile of a stepped horn with the fillet of its step."""
    length, radius, end, fillet = (sizes[name] for name in ("length", "radius", "end_radius", "edge_radius"))
    total = length + sizes["end_length"]
    foot = [(length, end + fillet), (length + fillet, end)] if fillet else [(length, end)]
    along = 1 - 0.5**0.5  # of the radius, at which its dimension meets the middle of the arc
    return HornProfile(
        vertices=_closed([(0.0, radius), (length, radius), *foot, (total, end)], {2: _QUARTER_ARC} if fillet else None),
        stations=(0.0, length, total),
        widths=((length / 2, 2 * radius), ((length + fillet + total) / 2, 2 * end)),
        fillets=((length + along * fillet, end + along * fillet, fillet),) if fillet else (),
    )


def _booster(sizes: Mapping[str, float]) -> HornProfile:
    """Profile of a booster with its flange."""
    names = ("length", "radius", "end_length", "end_radius", "flange_thickness", "flange_radius")
    length, radius, end_length, end, thickness, flange = (sizes[name] for name in names)
    top = length + thickness
    total = top + end_length
    outline = [(0.0, radius), (length, radius), (length, flange), (top, flange), (top, end), (total, end)]
    return HornProfile(
        vertices=_closed(outline),
        stations=(0.0, length, top, total),
        widths=((length / 2, 2 * radius), (length + thickness / 2, 2 * flange), ((top + total) / 2, 2 * end)),
    )


def _block(sizes: Mapping[str, float]) -> HornProfile:
    """Half profile of a block in the plane of its length and width."""
    length, width, edge = sizes["length"], sizes["width"], sizes.get("edge_radius", 0.0)
    end = sizes.get("end_width", width)
    return HornProfile(
        vertices=_closed([(0.0, width / 2), (length, end / 2)]),
        stations=(0.0, length),
        widths=((length / 2, width),) if end == width else ((0.0, width), (length, end)),
        thickness=sizes["thickness"],
        notes=(f"all edges rounded, R{1e3 * edge:.2f}",) if edge else (),
    )


_PROFILES: Mapping[str, Callable[[Mapping[str, float]], HornProfile]] = {
    "block": _block,
    "booster": _booster,
    "conical_horn": _conical,
    "cylinder": _cylinder,
    "exponential_horn": _exponential,
    "stepped_horn": _stepped,
}
"""Profiles by the name of the shape, from all its sizes in m."""


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
