"""Figures for dark pages: the same figure with light text and lines on a transparent ground."""

import colorsys
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection, PolyCollection, QuadMesh
from matplotlib.colors import to_rgba, to_rgba_array
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text
from mpl_toolkits.mplot3d import Axes3D

_LIGHTEST, _DARKEST = 0.92, 0.09  # greys that black and white become
_GREY = 0.12  # spread of the channels up to which a colour counts as grey
_INK = 0.62  # least lightness of a coloured line
_VISIBLE = 0.25  # least luminance of it, five times the contrast of its page
_TINT = 0.8  # lightness from which a colour is a ground for others
_SATURATION = 0.8  # most of a colour, above which it glares
_GROUND = 0.22  # lightness that such a ground gets


def darken(figure: Figure) -> None:
    """Recolour a figure in place for a dark page.

    Greys are turned round, dark colours made lighter and pale grounds darker, each of the same hue. What lies on a map
    of colours, and the map, stays as it is.
    """
    figure.patch.set_alpha(0.0)
    for artist in _furniture(figure):
        _recolour(artist)
    for axes in figure.axes:
        axes.patch.set_alpha(0.0)
        if isinstance(axes, Axes3D):
            for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
                axis.set_pane_color((1.0, 1.0, 1.0, 0.05))
                axis.line.set_color(dark_colour(axis.line.get_color()))
                axis._axinfo["grid"]["color"] = (0.5, 0.5, 0.5, 0.6)
                axis.set_tick_params(color=dark_colour("k"), labelcolor=dark_colour("k"))
        else:
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_tick_params(which="both", color=dark_colour("k"), labelcolor=dark_colour("k"))


def dark_colour(colour: object) -> tuple[float, float, float, float]:
    """Colour of the same hue for a dark page."""
    red, green, blue, alpha = to_rgba(colour)  # type: ignore[arg-type]
    if max(red, green, blue) - min(red, green, blue) < _GREY:
        grey = _LIGHTEST + (_DARKEST - _LIGHTEST) * (red + green + blue) / 3
        return grey, grey, grey, alpha
    hue, lightness, saturation = colorsys.rgb_to_hls(red, green, blue)
    saturation = min(saturation, _SATURATION)
    if lightness > _TINT:
        return *colorsys.hls_to_rgb(hue, _GROUND, saturation), alpha
    lightness = max(lightness, _INK)
    while _luminance(colorsys.hls_to_rgb(hue, lightness, saturation)) < _VISIBLE:  # as blues are
        lightness += 0.02
    return *colorsys.hls_to_rgb(hue, lightness, saturation), alpha


def _luminance(colour: tuple[float, float, float]) -> float:
    """Relative luminance of a colour, near enough."""
    red, green, blue = (float(channel**2.2) for channel in colour)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def _furniture(figure: Figure) -> Iterator[Artist]:
    """Artists of a figure, but for its own ground and what lies on maps of colours."""
    kept = {id(part) for axes in figure.axes if _is_map(axes) for part in _everything(_content(axes))}
    grounds = {id(figure.patch), *(id(axes.patch) for axes in figure.axes)}
    yield from (part for part in dict.fromkeys(figure.findobj()) if id(part) not in kept | grounds)


def _is_map(axes: Axes) -> bool:
    """Whether axes show colours for values over a plane, or a body in space."""
    kinds = (AxesImage, QuadMesh)
    solid = any(isinstance(part, PolyCollection) and len(part.get_facecolor()) > 1 for part in axes.collections)
    filled = any(isinstance(part, ContourSet) and part.filled for part in axes.collections)
    return filled or solid or isinstance(axes, Axes3D) or any(isinstance(part, kinds) for part in axes.get_children())


def _content(axes: Axes) -> list[Artist]:
    """What was drawn into axes."""
    return [*axes.lines, *axes.patches, *axes.collections, *axes.images, *axes.texts]


def _everything(artists: Iterable[Artist]) -> Iterator[Artist]:
    """Artists and their parts."""
    for artist in artists:
        yield from artist.findobj()


def _recolour(artist: Artist) -> None:
    """Give an artist the colours of a dark page."""
    if isinstance(artist, Line2D):
        artist.set_color(dark_colour(artist.get_color()))
        artist.set_markerfacecolor(_known(artist.get_markerfacecolor()))
        artist.set_markeredgecolor(_known(artist.get_markeredgecolor()))
    elif isinstance(artist, Text):
        artist.set_color(dark_colour(artist.get_color()))
    elif isinstance(artist, Patch):
        face, edge = artist.get_facecolor(), artist.get_edgecolor()
        artist.set_facecolor(dark_colour(face))
        artist.set_edgecolor(dark_colour(edge))
    elif isinstance(artist, Collection) and artist.get_array() is None:
        artist.set_facecolor(_dark_colours(artist.get_facecolor()))
        artist.set_edgecolor(_dark_colours(artist.get_edgecolor()))


def _known(colour: Any) -> Any:
    """Colour of a marker, or that it has none."""
    return colour if isinstance(colour, str) and colour == "none" else dark_colour(colour)


def _dark_colours(colours: Any) -> Any:
    """Colours of a dark page, one a row."""
    return np.array([dark_colour(colour) for colour in to_rgba_array(colours)]).reshape(-1, 4)
