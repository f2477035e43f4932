"""Caveats on the size of a surface file's field and heights, which a wrong unit makes implausible."""

import numpy as np

from sonolube.checks import Floats
from sonolube.text.units import format_si

_LARGEST_FIELD = 0.5  # m, which no profilometer scans
_SMALLEST_FIELD = 1e-6  # m, below which only force microscopes scan


def size_caveats(*, height: Floats, spacing_x: float, spacing_y: float, unit: str) -> tuple[str, ...]:
    """Caveats of an implausible size of a field or range of its heights, one line each.

    `height` has shape (rows, columns).

    Empty for a field from 1 um to 0.5 m along its longer side with a range of heights below that side.
    """
    rows, columns = height.shape
    sides = (columns * spacing_x,) if rows == 1 else (columns * spacing_x, rows * spacing_y)
    field = " x ".join(format_si(side, "m", digits=4) for side in sides)
    check = f"check the lateral unit ({unit})"
    found = []
    if max(sides) > _LARGEST_FIELD:
        found.append(f"the field is {field}, beyond the {_LARGEST_FIELD:g} m that profilometers reach: {check}")
    if max(sides) < _SMALLEST_FIELD:
        found.append(f"the field is {field}, which only a force microscope scans: {check}")
    height_range = float(np.nanmax(height) - np.nanmin(height))
    if height_range > max(sides):
        span = format_si(height_range, "m", digits=4)
        found.append(f"heights range over {span}, more than the field of {field}: {check}, and that of the heights")
    return tuple(found)
