"""Records of a surface: its height map with missing pixels, and the roughness of the statistical contact models."""

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput

Mask = NDArray[np.bool_]
"""A truth value for each pixel."""

_LARGEST_HEIGHT = 1e6  # m; fourth powers of heights stay within floating-point range


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeightMap:
    """Heights of a surface on a rectangular grid.

    Parameters
    ----------
    height : ndarray, shape (rows, columns)
        Height, positive out of the material; NaN where not measured. [m]
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
            raise InvalidInput("height must be finite, or NaN where not measured; got an infinite value")
        if (highest := np.nanmax(np.abs(z), initial=0.0)) > _LARGEST_HEIGHT:
            raise InvalidInput(f"height must not exceed {_LARGEST_HEIGHT:g} m, got {highest:g} m; check its unit")
        if not np.isfinite(z).any():
            raise InvalidInput(f"height must have a measured pixel, but all {z.size} are NaN")
        object.__setattr__(self, "height", z.astype(np.float64, copy=False))

    @property
    def measured(self) -> Mask:
        """Mask of the measured pixels, of the shape of the heights."""
        return np.isfinite(self.height)

    @property
    def missing_fraction(self) -> float:
        """Fraction of the pixels that were not measured."""
        return 1 - float(np.mean(self.measured))

    @property
    def x(self) -> Floats:
        """Positions of the columns, from 0 at the first, in m."""
        return self.spacing_x * np.arange(self.height.shape[1], dtype=np.float64)

    @property
    def y(self) -> Floats:
        """Positions of the rows, from 0 at the first, in m."""
        return self.spacing_y * np.arange(self.height.shape[0], dtype=np.float64)

    @property
    def sides(self) -> tuple[float, float]:
        """Lengths of the field along x and y, as many spacings as it has columns and rows, in m."""
        rows, columns = self.height.shape
        return columns * self.spacing_x, rows * self.spacing_y

    def with_height(self, height: Floats) -> "HeightMap":
        """Height map of other heights on the same grid.

        Raises
        ------
        InvalidInput
            As at construction, or if the shape differs.
        """
        if np.shape(height) != self.height.shape:
            raise InvalidInput(f"height must have the shape {self.height.shape}, got {np.shape(height)}")
        return HeightMap(height=height, spacing_x=self.spacing_x, spacing_y=self.spacing_y)


@dataclass(frozen=True, kw_only=True, slots=True)
class Roughness:
    """Equivalent roughness of two surfaces in contact, as one rough surface against a smooth one.

    Parameters
    ----------
    rms_height : float
        Standard deviation of asperity heights, Rq. [m]
    summit_radius : float
        Mean radius of asperity summits, Rs. [m]
    summit_density : float
        Areal density of asperity summits. [1/m2]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    References
    ----------
    .. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
    """

    rms_height: float
    summit_radius: float
    summit_density: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))

    @property
    def roughness_parameter(self) -> float:
        """Roughness parameter beta: density times standard deviation times radius; 0.03 to 0.05 for most surfaces."""
        return self.summit_density * self.rms_height * self.summit_radius
