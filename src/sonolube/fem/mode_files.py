"""Contents of files of natural modes: VTK grid, table of shapes at points, and animated GIF."""

import io
import math
from collections.abc import Sequence

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.fem.figures import MODE_COLOURS, mode_figure
from sonolube.fem.solver.convergence import ConvergedModes
from sonolube.fem.solver.model import DIRECTIONS
from sonolube.fem.solver.postprocessing import interpolate_at_points
from sonolube.fem.vtk_export import vtu_text
from sonolube.figure import render_figure

_FRAMES = 16  # of one period
_FRAME_DURATION = 60  # ms
_RESOLUTION = 90  # dots per inch


def elastic_rows(found: ConvergedModes) -> range:
    """Indices of the elastic modes among all modes, rigid motions left out."""
    return range(found.modes.rigid_body_count, len(found.natural_frequency))


def mode_title(found: ConvergedModes, names: Sequence[str], row: int) -> str:
    """Name and natural frequency of a mode with its error, such as "axial 1, 20.01 kHz ± 6 Hz"."""
    return f"{names[row]}, {frequency_text(found, row)}"


def frequency_text(found: ConvergedModes, row: int) -> str:
    """Natural frequency of a mode with its error and the digits that this leaves a meaning: "20.01 kHz ± 6 Hz"."""
    frequency = float(found.natural_frequency[row])
    error = frequency * float(found.frequency_error[row])
    place = math.floor(math.log10(max(2 * error, 1e-9 * frequency, 1e-3)))  # power of ten of the last digit
    unit, power = ("kHz", 3) if frequency >= 1e3 else ("Hz", 0)
    number = f"{round(frequency, -place) / 10**power:.{max(0, power - place)}f} {unit}"
    scaled, error_unit = (error / 1e3, "kHz") if error >= 1e3 else (error, "Hz")
    return f"{number} ± {scaled:.1g} {error_unit}"


def modes_grid(found: ConvergedModes, names: Sequence[str]) -> str:
    """Mesh with the shapes of all elastic modes as a VTK grid (.vtu).

    Parameters
    ----------
    found : ConvergedModes
    names : sequence of str
        Of all modes.

    Returns
    -------
    str
    """
    fields = {mode_title(found, names, row): found.modes.shapes[row] for row in elastic_rows(found)}
    return vtu_text(found.model.mesh, fields=fields)


def shapes_table(found: ConvergedModes, names: Sequence[str], points: Floats, *, direction: str) -> str:
    """One component of the elastic mode shapes at given points as CSV, one mode a column, each scaled to 1.

    Parameters
    ----------
    found : ConvergedModes
    names : sequence of str
        Of all modes.
    points : ndarray, shape (p, 3)
        Coordinates of the points, in m.
    direction : str
        Component: "x", "y" or "z".

    Returns
    -------
    str
        As `sonolube measure vibration --modes` reads it.

    Raises
    ------
    InvalidInput
        If the direction is none of the axes.
    """
    if direction not in DIRECTIONS or len(direction) != 1:
        raise InvalidInput(f"direction must be x, y or z, got {direction!r}")
    rows = list(elastic_rows(found))
    shapes = interpolate_at_points(found.model.mesh, found.modes.shapes[rows], points=points)[
        ..., DIRECTIONS.index(direction)
    ]
    text = io.StringIO()
    header = ", ".join(f"{names[row]} at {found.natural_frequency[row]:.1f} Hz" for row in rows)
    np.savetxt(text, (shapes / np.abs(shapes).max(axis=1, keepdims=True)).T, fmt="%.6g", delimiter=",", header=header)
    return text.getvalue()


def mode_animation(found: ConvergedModes, shape: Floats, *, title: str) -> bytes:
    """One period of a mode as an animated GIF.

    Parameters
    ----------
    found : ConvergedModes
    shape : ndarray, shape (nodes, 3)
        Displacements of the nodes.
    title : str

    Returns
    -------
    bytes
    """
    from PIL import Image

    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    frames = []
    for phase in 2 * np.pi * np.arange(_FRAMES) / _FRAMES:
        figure = mode_figure(found.model.mesh, shape, title=title, amplitude=float(np.cos(phase)))
        picture = io.BytesIO(render_figure(figure, "png", resolution=_RESOLUTION))
        frames.append(Image.open(picture).convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE))
    content = io.BytesIO()
    frames[0].save(content, format="GIF", save_all=True, append_images=frames[1:], duration=_FRAME_DURATION, loop=0)
    return content.getvalue()


def _palette() -> list[int]:
    """Colours of all frames: those of the displacement scale, and greys for axes and text."""
    from matplotlib import colormaps

    scale = np.round(255 * colormaps[MODE_COLOURS](np.linspace(0, 1, 192))[:, :3])
    greys = np.repeat(np.round(np.linspace(0, 255, 64))[:, np.newaxis], 3, axis=1)
    return [int(value) for value in np.concatenate([scale, greys]).ravel()]
