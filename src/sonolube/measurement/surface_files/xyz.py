"""XYZ text: points of a surface in any order, restored to the regular grid on which they were measured."""

import math
from array import array
from pathlib import Path
from typing import BinaryIO, ClassVar, final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import HEAD_SIZE
from sonolube.measurement.surface_files.surface_reading import SurfaceReading

_LONGEST_LINE = 1024
_MOST_HEADER_LINES = 64
_SEPARATORS = bytes.maketrans(b",;", b"  ")
_COMMENTS = (b"#", b"%", b"//", b"*")
_MISSING = ([b"bad"], [b"no", b"data"])  # spellings of Wyko and Zygo; "nan" is a number
_COINCIDENCE = 1e-6  # of the extent: closer positions are one
_GRID_TOLERANCE = 0.1  # of the spacing: by which rounding may move positions
_LEAST_FILLED = 0.05  # fraction of the grid


@final
class XyzText:
    """XYZ text: points x, y, z of a regular grid, one per line in any order; lengths in a unit the user gives."""

    name: ClassVar[str] = "XYZ text"
    suffixes: ClassVar[tuple[str, ...]] = (".xyz",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Return whether the last whole lines of the head are three numbers each."""
        whole_lines = head.splitlines()[: -1 if len(head) == HEAD_SIZE else None]
        return b"\0" not in head and len(whole_lines) > 3 and all(_is_point(line) for line in whole_lines[-3:])

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Return the heights of points x, y, z on their regular grid.

        Parameters
        ----------
        stream : binary file
            The text, open for reading: three numbers on a line, separated by blanks, commas or semicolons; in any order
            of lines. Lines before the first point and lines that start with ``#`` are skipped. A point whose height is
            written ``nan``, ``Bad`` or ``No Data``, and a grid position without a point, was not measured.
        path : Path
            Of the file, for messages.

        Returns
        -------
        SurfaceReading
            The first row has the smallest y. The text does not state its unit.

        Raises
        ------
        InvalidInput
            Naming the byte at which a line is no point, or stating how the points fail to form a grid.
        """
        x, y, z = _points(stream, path)
        column, spacing_x = _grid(x, path, axis="x")
        row, spacing_y = _grid(y, path, axis="y")
        columns, rows = int(column.max()) + 1, int(row.max()) + 1
        if z.size < _LEAST_FILLED * columns * rows:
            points = f"{z.size} points fill too little of a {columns} x {rows} grid"
            raise InvalidInput(f"{path}: {points}; are they scattered?")
        cell = row * columns + column
        if np.unique(cell).size < cell.size:
            twice = int(np.flatnonzero(np.bincount(cell) > 1)[0])
            first = int(np.flatnonzero(cell == twice)[0])
            raise InvalidInput(f"{path}: more than one point at x = {x[first]:g}, y = {y[first]:g}")
        height = np.full(rows * columns, np.nan)
        height[cell] = z
        if np.isnan(height).all():
            raise InvalidInput(f"{path}: none of the {z.size} points has a height")
        return SurfaceReading(
            height=height.reshape(rows, columns),
            format_name=self.name,
            spacing_x=spacing_x,
            spacing_y=spacing_y,
            states_unit=False,
        )


def _is_point(line: bytes) -> bool:
    """Return whether a line of text is a point: three numbers, the last of which may be a missing-value text."""
    try:
        return _point(line) is not None
    except ValueError:
        return False


def _points(stream: BinaryIO, path: Path) -> tuple[Floats, Floats, Floats]:
    """Return the coordinates of all points of the text."""
    stream.seek(0)
    values = array("d")
    offset = header_lines = 0
    while line := stream.readline(_LONGEST_LINE):
        try:
            point = _point(line)
        except ValueError as failure:
            header_lines += 1
            if values or header_lines > _MOST_HEADER_LINES or len(line) == _LONGEST_LINE:
                raise InvalidInput(f"{path}: byte {offset}: {failure}: {line[:40].decode('latin-1')!r}") from None
        else:
            values.extend(point or ())
        offset += len(line)
    if not values:
        raise InvalidInput(f"{path}: byte {offset}: " + ("no point x y z found" if offset else "the file is empty"))
    points = np.frombuffer(values, dtype=np.float64).reshape(-1, 3)
    return points[:, 0], points[:, 1], points[:, 2]


def _point(line: bytes) -> tuple[float, float, float] | None:
    """Return the point on a line; None for a blank line and a comment."""
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
    """Return a point whose height is a missing-value text, as NaN."""
    try:
        if [word.lower() for word in words[2:]] in _MISSING:
            return float(words[0]), float(words[1]), math.nan
    except ValueError:
        pass
    raise ValueError("a point has three numbers, x y z")


def _grid(position: Floats, path: Path, *, axis: str) -> tuple[NDArray[np.intp], float]:
    """Return the index of each position on the regular grid of one axis, and the spacing of that grid."""
    with np.errstate(over="ignore"):
        distinct = np.unique(position)
        extent = float(distinct[-1] - distinct[0])
    if not (0 < extent < math.inf):
        raise InvalidInput(f"{path}: points of one {axis} make no surface, which needs at least two")
    lines = distinct[np.concatenate(([True], np.diff(distinct) > _COINCIDENCE * extent))]
    steps = np.diff(lines)
    if not steps.size:
        raise InvalidInput(f"{path}: more {axis} than {1 / _COINCIDENCE:.0e} are no measured grid")
    spacing = extent / float(np.sum(np.rint(steps / steps.min())))  # the shortest step alone is too coarsely rounded
    index = np.rint((position - distinct[0]) / spacing)
    off = np.abs(position - distinct[0] - index * spacing)
    if off.max() > _GRID_TOLERANCE * spacing:
        worst = float(position[np.argmax(off)])
        raise InvalidInput(f"{path}: {axis} = {worst:g} lies off the grid of spacing {spacing:g} of its neighbours")
    return index.astype(np.intp), spacing
