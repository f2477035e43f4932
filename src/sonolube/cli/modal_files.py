"""Modes as files for other programs: VTK grids, animations, and shapes at the points of a vibrometer."""

import io
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from sonolube.checks import Floats
from sonolube.cli.modal_output import MODE_COLOURS, mode_figure
from sonolube.errors import InvalidInput
from sonolube.fem import ConvergedModes, interpolate_at_points, vtu_text
from sonolube.fem.solver.model import DIRECTIONS
from sonolube.figure import publication_style
from sonolube.files import write_atomically

_FRAMES = 16  # of one period
_FRAME_DURATION = 60  # ms
_RESOLUTION = 90  # dots per inch


def write_vtu(found: ConvergedModes, names: Sequence[str], *, folder: Path, part: str) -> list[Path]:
    """Write the mesh with all elastic modes as one VTK grid and return the file."""
    fields = {
        f"{names[row]}, {found.natural_frequency[row]:.0f} Hz": found.modes.shapes[row] for row in _elastic(found)
    }
    return [write_atomically(folder / f"{part}-modes.vtu", vtu_text(found.model.mesh, fields=fields))]


def write_shapes(
    found: ConvergedModes, names: Sequence[str], points: Floats, *, toward: str, folder: Path, part: str
) -> list[Path]:
    """Write one component of the shapes at points, one mode a column, as `measure vibration --modes` takes them."""
    if toward not in DIRECTIONS or len(toward) != 1:
        raise InvalidInput(f"--toward must be x, y or z, got {toward!r}")
    rows = _elastic(found)
    shapes = interpolate_at_points(found.model.mesh, found.modes.shapes[rows], points=points)[
        ..., DIRECTIONS.index(toward)
    ]
    text = io.StringIO()
    heading = ", ".join(f"{names[row]} at {found.natural_frequency[row]:.1f} Hz" for row in rows)
    np.savetxt(text, (shapes / np.abs(shapes).max(axis=1, keepdims=True)).T, fmt="%.6g", delimiter=",", header=heading)
    return [write_atomically(folder / f"{part}-shapes.csv", text.getvalue())]


def write_animations(
    found: ConvergedModes,
    names: Sequence[str],
    *,
    folder: Path,
    part: str,
    advance: Callable[[str, int, int], None] | None = None,
) -> list[Path]:
    """Draw one period of each elastic mode as an animated GIF and return the files."""
    files = []
    for done, row in enumerate(rows := _elastic(found)):
        if advance:
            advance(f"animating {names[row]}", done, len(rows))
        title = f"{names[row]}, {found.natural_frequency[row]:.0f} Hz"
        name = f"{part}-{done + 1}-{names[row].replace(' ', '-')}.gif"
        files.append(write_atomically(folder / name, animated(found, found.modes.shapes[row], title=title)))
    return files


def animated(found: ConvergedModes, shape: Floats, *, title: str) -> bytes:
    """Return one period of a mode as an animated GIF."""
    from PIL import Image

    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    frames = []
    for phase in 2 * np.pi * np.arange(_FRAMES) / _FRAMES:
        figure = mode_figure(found.model.mesh, shape, title=title, share=float(np.cos(phase)))
        with publication_style():
            figure.savefig(picture := io.BytesIO(), format="png", dpi=_RESOLUTION)
        frames.append(Image.open(picture).convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE))
    content = io.BytesIO()
    frames[0].save(content, format="GIF", save_all=True, append_images=frames[1:], duration=_FRAME_DURATION, loop=0)
    return content.getvalue()


def _palette() -> list[int]:
    """Return the colours of all frames: those of the scale, and greys for what is drawn around the part."""
    from matplotlib import colormaps

    scale = np.round(255 * colormaps[MODE_COLOURS](np.linspace(0, 1, 192))[:, :3])
    greys = np.repeat(np.round(np.linspace(0, 255, 64))[:, np.newaxis], 3, axis=1)
    return [int(value) for value in np.concatenate([scale, greys]).ravel()]


def _elastic(found: ConvergedModes) -> list[int]:
    """Return the rows of the elastic modes."""
    return list(range(found.modes.rigid_body_count, len(found.natural_frequency)))
