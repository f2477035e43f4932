"""XYZ text: points of a surface in any order, and of profiles.

The regular grid on which positions were measured is restored, and uneven steps along a profile are made even.
"""

import math
import re
from array import array
from pathlib import Path
from typing import BinaryIO, ClassVar, final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import HEAD_SIZE
from sonolube.measurement.surface_files.reader import SurfaceReading

_COINCIDENCE = 1e-6  # of the extent: closer positions are one
_GRID_TOLERANCE = 0.1  # of the spacing: by which rounding may move positions
_MIN_FILLED_PROFILE = 0.9  # fraction of the steps of a profile that have a point: with fewer its steps are uneven


def grid_index(coordinate: Floats, *, axis: str) -> tuple[NDArray[np.intp], float]:
    """Index of each coordinate on the regular grid of one axis, and the spacing of that grid.

    From zero at the smallest coordinate. Spacing, in the unit of the positions.
    """
    with np.errstate(over="ignore"):
        distinct = np.unique(coordinate)
        extent = float(distinct[-1] - distinct[0])
    if not (0 < extent < math.inf):
        raise InvalidInput(f"points of one {axis} make no surface, which needs at least two")
    lines = distinct[np.concatenate(([True], np.diff(distinct) > _COINCIDENCE * extent))]
    steps = np.diff(lines)
    if not steps.size:
        raise InvalidInput(f"more {axis} than {1 / _COINCIDENCE:.0e} are no measured grid")
    spacing = extent / float(np.sum(np.rint(steps / steps.min())))  # the shortest step alone is too coarsely rounded
    index = np.rint((coordinate - distinct[0]) / spacing)
    off = np.abs(coordinate - distinct[0] - index * spacing)
    if off.max() > _GRID_TOLERANCE * spacing:
        worst = float(coordinate[np.argmax(off)])
        raise InvalidInput(f"{axis} = {worst:g} lies off the grid of spacing {spacing:g} of its neighbours")
    return index.astype(np.intp), spacing


def even_profile(coordinate: Floats, measured: Floats) -> tuple[Floats, float, tuple[str, ...]]:
    """Heights of a profile at even steps, interpolated linearly where its positions are uneven.

    Heights in the order of the positions, as the one row of a map. Their spacing, in the unit of the positions. That
    heights were interpolated, where they were.

    Positions that rounding moves by a tenth of the spacing at most, of which up to a tenth may be missing, keep their
    heights. Others are replaced by as many even steps over the same length.
    """
    order = np.argsort(coordinate, kind="stable")
    x, z = np.asarray(coordinate, dtype=np.float64)[order], np.asarray(measured, dtype=np.float64)[order]
    with np.errstate(over="ignore"):
        steps = np.diff(x)
        extent = float(x[-1] - x[0]) if x.size else 0.0
    if not (0 < extent < math.inf):
        raise InvalidInput("points of one position make no profile, which needs at least two")
    if not steps.min() > 0:
        raise InvalidInput(f"more than one point at {x[int(np.argmin(steps))]:g} along the profile")
    if np.isnan(z).all():
        raise InvalidInput(f"none of the {z.size} points has a height")
    mean_step = extent / steps.size
    if mean_step > 0 and np.abs(x - x[0] - mean_step * np.arange(x.size)).max() <= _GRID_TOLERANCE * mean_step:
        return z[np.newaxis], mean_step, ()
    if (filled := _filled(x, z)) is not None:
        return filled[0][np.newaxis], filled[1], ()
    even = np.interp(np.linspace(x[0], x[-1], x.size), x, z)
    if np.isnan(even).all():
        raise InvalidInput("too few of the points have a height to interpolate between them")
    shortest, longest = steps.min() / mean_step, steps.max() / mean_step
    note = f"steps are uneven, {shortest:.3g} to {longest:.3g} of their mean: heights interpolated at even steps"
    return even[np.newaxis], mean_step, (note,)


def _filled(coordinate: Floats, height: Floats) -> tuple[Floats, float] | None:
    """Heights of a profile on its regular grid, NaN where that has no point, and its spacing; None without a grid."""
    try:
        index, spacing = grid_index(coordinate, axis="position")
    except InvalidInput:
        return None
    points = int(index[-1]) + 1
    if coordinate.size < _MIN_FILLED_PROFILE * points or np.unique(index).size < index.size:
        return None
    grid = np.full(points, np.nan)
    grid[index] = height
    return grid, spacing


_LONGEST_LINE = 1024
_MAX_HEADER_LINES = 64
_SEPARATORS = bytes.maketrans(b",;", b"  ")
_COMMENTS = (b"#", b"%", b"//", b"*")
_WANTED = {2: "a point has two numbers, x z", 3: "a point has three numbers, x y z"}
_MISSING = ([b"bad"], [b"no", b"data"])  # spellings of Wyko and Zygo; "nan" is a number
_REMOTE = 1000.0  # distance of one position from the others over their extent
_MIN_POSITIONS = 3  # of which one can be remote
_MIN_FILLED = 0.05  # fraction of the grid
# Texts that SurfaceTopography reads with the unit of their header: Hommel-Etamic's HFM, whose third column is a flag,
# Dektak's export, and matrices with a comment such as "# Width: 12.34 um".
_STATES_UNIT = re.compile(rb"X;Y;valid|Scan Parameters|Lateral um,|(?m:^#[^:\n]*:\s*[-+\d.,eE]+\s*\S{0,3}m\s*$)")


@final
class XyzText:
    """XYZ text: points x, y, z of a regular grid or x, z of a profile, one a line; lengths in a unit the user gives."""

    name: ClassVar[str] = "XYZ text"
    suffixes: ClassVar[tuple[str, ...]] = (".xyz",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the last whole lines of the head are three numbers each, or two each."""
        whole_lines = head.splitlines()[: -1 if len(head) == HEAD_SIZE else None]
        if b"\0" in head or len(whole_lines) <= 3 or _STATES_UNIT.search(head):
            return False
        counts = {_numbers_on(line) for line in whole_lines[-3:]}
        return len(counts) == 1 and 0 not in counts

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Heights of points x, y, z on their regular grid, or of points x, z along a profile.

        The first row has the smallest y. Points of one y, or of one x, are a profile: one row, whose heights are
        interpolated at even steps where its positions are uneven. The text does not state its unit.
        """
        x, y, z = _points(stream, path)
        try:
            if y.min() == y.max() or x.min() == x.max():
                return self._profile(x if y.min() == y.max() else y, z)
            return self._map(x, y, z)
        except InvalidInput as refusal:
            raise InvalidInput(f"{path}: {refusal}") from None

    def _profile(self, position: Floats, z: Floats) -> SurfaceReading:
        """Heights of points on one line."""
        height, spacing, notes = even_profile(position, z)
        return SurfaceReading(
            height=height, format_name=self.name, spacing_x=spacing, spacing_y=spacing, states_unit=False, notes=notes
        )

    def _map(self, x: Floats, y: Floats, z: Floats) -> SurfaceReading:
        """Heights of points on a grid."""
        for axis, positions in (("x", x), ("y", y)):
            _refuse_remote(positions, axis=axis)
        column, spacing_x = grid_index(x, axis="x")
        row, spacing_y = grid_index(y, axis="y")
        columns, rows = int(column.max()) + 1, int(row.max()) + 1
        if z.size < _MIN_FILLED * columns * rows:
            points = f"{z.size} points fill too little of a {columns} x {rows} grid"
            raise InvalidInput(f"{points}; are they scattered?")
        cell = row * columns + column
        if np.unique(cell).size < cell.size:
            twice = int(np.flatnonzero(np.bincount(cell) > 1)[0])
            first = int(np.flatnonzero(cell == twice)[0])
            raise InvalidInput(f"more than one point at x = {x[first]:g}, y = {y[first]:g}")
        height = np.full(rows * columns, np.nan)
        height[cell] = z
        if np.isnan(height).all():
            raise InvalidInput(f"none of the {z.size} points has a height")
        return SurfaceReading(
            height=height.reshape(rows, columns),
            format_name=self.name,
            spacing_x=spacing_x,
            spacing_y=spacing_y,
            states_unit=False,
        )


def _refuse_remote(positions: Floats, *, axis: str) -> None:
    """Refuse a lowest or highest position that is farther from all others than these can be of one grid."""
    distinct = np.unique(positions)
    if distinct.size < _MIN_POSITIONS:
        return
    for rest, extreme in ((distinct[1:], distinct[0]), (distinct[:-1], distinct[-1])):
        gap, extent = np.abs(rest - extreme).min(), rest[-1] - rest[0]
        if gap > _REMOTE * extent:
            raise InvalidInput(f"{axis} = {extreme:g} lies far from all other points; leave its line out or mend it")


def _numbers_on(line: bytes) -> int:
    """Number of values of a line of text that is a point, the last of which may be missing; 0 for other lines."""
    try:
        return len(_point(line) or ())
    except ValueError:
        return 0


def _points(stream: BinaryIO, path: Path) -> tuple[Floats, Floats, Floats]:
    """Coordinates of all points of the text; y is zero in a text of two columns."""
    stream.seek(0)
    values = array("d")
    offset = header_lines = columns = 0
    while line := stream.readline(_LONGEST_LINE):
        try:
            point = _point(line) or ()
            if point and len(point) != (columns or len(point)):
                raise ValueError(_WANTED[columns])
        except ValueError as failure:
            header_lines += 1
            if values or header_lines > _MAX_HEADER_LINES or len(line) == _LONGEST_LINE:
                raise InvalidInput(f"{path}: byte {offset}: {failure}: {line[:40].decode('latin-1')!r}") from None
        else:
            values.extend(point)
            columns = columns or len(point)
        offset += len(line)
    if not values:
        raise InvalidInput(f"{path}: byte {offset}: " + ("no point x y z found" if offset else "the file is empty"))
    points = np.frombuffer(values, dtype=np.float64).reshape(-1, columns)
    return points[:, 0], points[:, 1] if columns == 3 else np.zeros(len(points)), points[:, -1]


def _point(line: bytes) -> tuple[float, ...] | None:
    """Point on a line, x y z or x z; None for a blank line and a comment."""
    words = line.translate(_SEPARATORS).split()
    try:
        numbers = tuple(map(float, words))
    except ValueError:
        if not words or line.lstrip().startswith(_COMMENTS):
            return None
        numbers = _unmeasured(words)
    if not words:
        return None
    if len(numbers) not in _WANTED:
        raise ValueError(_WANTED[3])
    if not all(map(math.isfinite, numbers[:-1])) or math.isinf(numbers[-1]):
        raise ValueError("a point has finite coordinates")
    return numbers


def _unmeasured(words: list[bytes]) -> tuple[float, ...]:
    """Point whose height is a missing-value text, as NaN."""
    for count in (2, 1):
        if [word.lower() for word in words[count:]] in _MISSING:
            try:
                return (*map(float, words[:count]), math.nan)
            except ValueError:
                break
    raise ValueError(_WANTED[3])
