"""Points of a surface as text, x y z on a line, brought back onto the grid they were measured on."""

import math
from array import array
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.surface_reading import SurfaceReading

_LONGEST_LINE = 1024
_MOST_HEADER_LINES = 64
_SEPARATORS = bytes.maketrans(b",;", b"  ")
_COMMENTS = (b"#", b"%", b"//", b"*")
_MISSING = ([b"bad"], [b"no", b"data"])  # as Wyko and Zygo write it; "nan" is a number
_COINCIDENT = 1e-6  # of the extent: positions closer than this are one
_OFF_GRID = 0.1  # of the spacing: positions may lie this far off, as text rounds them
_LEAST_FILLED = 0.05


def read_xyz(stream: BinaryIO, *, name: str) -> SurfaceReading:
    """Read points x, y, z onto a regular grid.

    Parameters
    ----------
    stream : binary file
        The text, open for reading: three numbers on a line, parted by blanks, commas or semicolons; in any order of
        lines. Lines before the first point and lines that start with ``#`` are passed over. A point whose height is
        written ``nan``, ``Bad`` or ``No Data``, and a grid position without a point, was not measured.
    name : str
        What to call it in an error.

    Returns
    -------
    SurfaceReading
        The first row has the smallest y. Text does not say its unit.

    Raises
    ------
    InvalidInput
        Naming the byte at which a line is no point, or saying how the points fail to be a grid.
    """
    x, y, z = _points(stream, name=name)
    column, spacing_x = _grid(x, name=name, axis="x")
    row, spacing_y = _grid(y, name=name, axis="y")
    columns, rows = int(column.max()) + 1, int(row.max()) + 1
    if z.size < _LEAST_FILLED * columns * rows:
        raise InvalidInput(f"{name}: {z.size} points fill too little of a {columns} x {rows} grid; are they scattered?")
    cell = row * columns + column
    if np.unique(cell).size < cell.size:
        twice = int(np.flatnonzero(np.bincount(cell) > 1)[0])
        first = int(np.flatnonzero(cell == twice)[0])
        raise InvalidInput(f"{name}: more than one point at x = {x[first]:g}, y = {y[first]:g}")
    height = np.full(rows * columns, np.nan)
    height[cell] = z
    if np.isnan(height).all():
        raise InvalidInput(f"{name}: none of the {z.size} points has a height")
    return SurfaceReading(
        height=height.reshape(rows, columns),
        format_name="XYZ text",
        spacing_x=spacing_x,
        spacing_y=spacing_y,
        states_unit=False,
    )


def is_point(line: bytes) -> bool:
    """Return whether a line of text is a point: three numbers, the last of which may say that it is missing."""
    try:
        return _point(line) is not None
    except ValueError:
        return False


def _points(stream: BinaryIO, *, name: str) -> tuple[Floats, Floats, Floats]:
    stream.seek(0)
    values = array("d")
    offset = header_lines = 0
    while line := stream.readline(_LONGEST_LINE):
        try:
            point = _point(line)
        except ValueError as failure:
            header_lines += 1
            if values or header_lines > _MOST_HEADER_LINES or len(line) == _LONGEST_LINE:
                raise InvalidInput(f"{name}: byte {offset}: {failure}: {line[:40].decode('latin-1')!r}") from None
        else:
            values.extend(point or ())
        offset += len(line)
    if not values:
        raise InvalidInput(f"{name}: byte {offset}: " + ("no point x y z found" if offset else "the file is empty"))
    points = np.frombuffer(values, dtype=np.float64).reshape(-1, 3)
    return points[:, 0], points[:, 1], points[:, 2]


def _point(line: bytes) -> tuple[float, float, float] | None:
    """Return the point on a line, None for a line without one."""
    words = line.translate(_SEPARATORS).split()
    try:
        x, y, z = map(float, words)
    except ValueError:
        if not words or line.lstrip().startswith(_COMMENTS):
            return None
        x, y, z = _unmeasured(words)
    if not (math.isfinite(x) and math.isfinite(y)) or math.isinf(z):
        raise ValueError("a point has finite coordinates")
    return x, y, z


def _unmeasured(words: list[bytes]) -> tuple[float, float, float]:
    """Return a point whose height is a word that says it is missing."""
    try:
        if [word.lower() for word in words[2:]] in _MISSING:
            return float(words[0]), float(words[1]), math.nan
    except ValueError:
        pass
    raise ValueError("a point has three numbers, x y z")


def _grid(position: Floats, *, name: str, axis: str) -> tuple[NDArray[np.intp], float]:
    """Return the index of each position on the evenly spaced line that they share, and its spacing."""
    with np.errstate(over="ignore"):
        distinct = np.unique(position)
        extent = float(distinct[-1] - distinct[0])
    if not (0 < extent < math.inf):
        raise InvalidInput(f"{name}: points of one {axis} make no surface; it needs two at the least")
    steps = np.diff(distinct)
    lines = distinct[np.concatenate(([True], steps > _COINCIDENT * extent))]
    steps = np.diff(lines)
    if not steps.size:
        raise InvalidInput(f"{name}: more {axis} than {1 / _COINCIDENT:.0e} are no grid that was measured")
    spacing = extent / float(np.sum(np.rint(steps / steps.min())))  # the shortest step alone is rounded too much
    index = np.rint((position - distinct[0]) / spacing)
    off = np.abs(position - distinct[0] - index * spacing)
    if off.max() > _OFF_GRID * spacing:
        worst = float(position[np.argmax(off)])
        raise InvalidInput(
            f"{name}: {axis} = {worst:g} lies off the grid of spacing {spacing:g} that its neighbours make"
        )
    return index.astype(np.intp), spacing
