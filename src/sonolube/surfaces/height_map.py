"""A measured or generated surface: heights on a rectangular grid, some of them missing."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput

_BEYOND_ANY_SURFACE = 1e6  # m; powers of heights stay within what a float can hold


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeightMap:
    """Heights of a surface over a rectangular grid, row by row.

    Parameters
    ----------
    height : ndarray, shape (rows, columns)
        Height, positive out of the material; NaN where it was not measured. [m]
    spacing_x : float
        Distance of neighbouring columns. [m]
    spacing_y : float
        Distance of neighbouring rows. [m]

    Raises
    ------
    InvalidInput
        If the heights are not a matrix of numbers, one of them is infinite, none was measured, or a spacing is not
        positive.
    """

    height: Floats
    spacing_x: float
    spacing_y: float

    def __post_init__(self) -> None:
        require_positive(spacing_x=self.spacing_x, spacing_y=self.spacing_y)
        z = np.asarray(self.height)
        if z.ndim != 2 or z.dtype.kind not in "fiu":
            raise InvalidInput(f"height must be a matrix of numbers, got shape {z.shape} of {z.dtype}")
        if np.isinf(z).any():
            raise InvalidInput("height must be finite, or NaN where it was not measured; got an infinite value")
        if (np.abs(z) > _BEYOND_ANY_SURFACE).any():
            raise InvalidInput(f"height lies beyond any surface, {np.nanmax(np.abs(z)):g} m: look at its unit")
        if not np.isfinite(z).any():
            raise InvalidInput(f"height holds no measured pixel among {z.size}")
        object.__setattr__(self, "height", z.astype(np.float64, copy=False))

    @property
    def measured(self) -> NDArray[np.bool_]:
        """Which pixels were measured, of the map's shape."""
        return np.isfinite(self.height)

    @property
    def missing_fraction(self) -> float:
        """Share of pixels that were not measured."""
        return 1 - float(np.mean(self.measured))

    @property
    def x(self) -> Floats:
        """Positions of the columns from the first, in m."""
        return self.spacing_x * np.arange(self.height.shape[1], dtype=np.float64)

    @property
    def y(self) -> Floats:
        """Positions of the rows from the first, in m."""
        return self.spacing_y * np.arange(self.height.shape[0], dtype=np.float64)

    def with_height(self, height: Floats) -> "HeightMap":
        """Return a map of other heights on the same grid.

        Raises
        ------
        InvalidInput
            As at construction, or if the shape differs.
        """
        if np.shape(height) != self.height.shape:
            raise InvalidInput(f"height must keep the shape {self.height.shape}, got {np.shape(height)}")
        return HeightMap(height=height, spacing_x=self.spacing_x, spacing_y=self.spacing_y)
