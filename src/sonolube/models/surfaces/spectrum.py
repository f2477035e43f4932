"""Power spectral densities of a height map, areal, radial and of profiles, and spectral moments of a surface."""

import math
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np
from scipy import fft

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.surfaces.height_map import HeightMap

Window = Literal["hann", "none"]
ProfileDirection = Literal["rows", "columns"]

_BLOCK = 64  # profiles transformed at a time, which fit into the cache


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ArealSpectrum:
    """Two-sided areal power spectral density of heights, stored for non-negative wavenumbers along the rows.

    Parameters
    ----------
    wavenumber_x : ndarray, shape (p,)
        Wavenumber along the rows, in waves per length, from zero. [1/m]
    wavenumber_y : ndarray, shape (rows,)
        Wavenumber along the columns, in waves per length, from negative to positive. [1/m]
    areal_spectral_density : ndarray, shape (rows, p)
        Areal power spectral density; the other half follows from its symmetry about the origin. [m4]
    height_variance : float
        Integral of the density over the plane of wavenumbers. [m2]
    columns : int
        Number of columns of the map; where it is even, the last wavenumber along the rows occurs only once.
    """

    wavenumber_x: Floats
    wavenumber_y: Floats
    areal_spectral_density: Floats
    height_variance: float
    columns: int


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RadialSpectrum:
    """Areal power spectral density averaged over direction.

    Parameters
    ----------
    wavenumber : ndarray, shape (n,)
        Mean wavenumber of each ring, in waves per length. [1/m]
    areal_spectral_density : ndarray, shape (n,)
        Mean areal power spectral density over the ring. [m4]
    """

    wavenumber: Floats
    areal_spectral_density: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ProfileSpectrum:
    """Two-sided power spectral density of profiles, stored for non-negative wavenumbers.

    Parameters
    ----------
    wavenumber : ndarray, shape (n,)
        Wavenumber in waves per length, from zero. [1/m]
    profile_spectral_density : ndarray, shape (n,)
        Power spectral density, averaged over the profiles. [m3]
    height_variance : float
        Integral of the density over negative and positive wavenumbers. [m2]
    """

    wavenumber: Floats
    profile_spectral_density: Floats
    height_variance: float


@dataclass(frozen=True, kw_only=True, slots=True)
class SpectralMoments:
    """Spectral moments m0, m2 and m4 of profiles of an isotropic surface.

    Parameters
    ----------
    height_variance : float
        Variance of heights, m0. [m2]
    slope_variance : float
        Variance of slopes along a line, m2. []
    curvature_variance : float
        Variance of second derivatives along a line, m4. [1/m2]

    Raises
    ------
    InvalidInput
        If one is not positive and finite.
    """

    height_variance: float
    slope_variance: float
    curvature_variance: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))

    @property
    def bandwidth(self) -> float:
        """Nayak's bandwidth parameter m0 m4/m2^2: 1.5 or more for an isotropic Gaussian surface. []"""
        return self.height_variance * self.curvature_variance / self.slope_variance**2


def areal_spectrum(surface: HeightMap, *, window: Window = "hann") -> ArealSpectrum:
    r"""Areal power spectral density of a height map by windowed Fourier transform.

    Parameters
    ----------
    surface : HeightMap
    window : {"hann", "none"}
        Hann window, or none, which is right for periodic maps only.

    Returns
    -------
    ArealSpectrum

    Raises
    ------
    InvalidInput
        If the window is unknown.

    Notes
    -----
    With the weight :math:`w` (the window, zero where missing) and heights :math:`z` less their weighted mean

    .. math:: C(k_x, k_y) = \frac{\Delta x \Delta y}{\sum w^2}
        \left| \sum w z\, e^{-2\pi i (k_x x + k_y y)} \right|^2, \qquad
        \iint C \,\mathrm{d}k_x \mathrm{d}k_y = \frac{\sum w^2 z^2}{\sum w^2} .

    Missing pixels convolve the spectrum with that of their pattern: with more than a few per cent of them missing its
    steep end is unreliable. Densities are over waves per length; over angular wavenumbers q = 2 pi k the values are the
    same if integrals are taken with dq/(2 pi).

    References
    ----------
    .. [1] T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr. 5, 013001 (2017). doi:10.1088/2051-672X/aa51f8
    """
    rows, columns = surface.height.shape
    weighted = np.empty((rows, columns))
    z = np.ascontiguousarray(surface.height)
    squares = _apply_window(z, _window(rows, window), _window(columns, window), weighted)
    dx, dy = surface.spacing_x, surface.spacing_y
    transform = fft.rfft2(weighted, workers=-1, overwrite_x=True)
    density = transform.real**2
    density += transform.imag**2
    density *= dx * dy / squares
    return ArealSpectrum(
        wavenumber_x=fft.rfftfreq(columns, dx),
        wavenumber_y=fft.fftshift(fft.fftfreq(rows, dy)),
        areal_spectral_density=fft.fftshift(density, axes=0),
        height_variance=float(half_spectrum_multiplicity(columns) @ density.sum(axis=0)) / (rows * columns * dx * dy),
        columns=columns,
    )


def radial_spectrum(spectrum: ArealSpectrum) -> RadialSpectrum:
    """Areal power spectral density averaged over direction, in rings of the larger of both wavenumber steps.

    Parameters
    ----------
    spectrum : ArealSpectrum

    Returns
    -------
    RadialSpectrum
        Up to the largest wavenumber of both directions.

    Raises
    ------
    InvalidInput
        If the map has fewer than two rows or columns.
    """
    kx, ky = spectrum.wavenumber_x, spectrum.wavenumber_y
    if kx.size < 2 or ky.size < 2:
        raise InvalidInput(
            f"a radial spectrum requires at least 2 rows and 2 columns, got {ky.size} x {spectrum.columns}"
        )
    ring_width = max(kx[1], ky[1] - ky[0])
    rings = int(min(kx[-1], -ky[0]) / ring_width + 0.5)
    sums = np.zeros((3, rings + 1))
    _ring_sums(
        kx, ky, half_spectrum_multiplicity(spectrum.columns), spectrum.areal_spectral_density, 1 / ring_width, sums
    )
    count, radius, density = sums[:, sums[0] > 0]
    return RadialSpectrum(wavenumber=radius / count, areal_spectral_density=density / count)


def profile_spectrum(
    surface: HeightMap, *, along: ProfileDirection = "rows", window: Window = "hann"
) -> ProfileSpectrum:
    """Mean power spectral density of the profiles along rows or columns of a height map.

    Parameters
    ----------
    surface : HeightMap
    along : {"rows", "columns"}
        Direction of the profiles.
    window : {"hann", "none"}
        As in `areal_spectrum`.

    Returns
    -------
    ProfileSpectrum

    Raises
    ------
    InvalidInput
        If no profile has two measured pixels.

    Notes
    -----
    The weighted mean of each profile is removed; missing pixels have weight zero, and profiles with fewer than two
    measured pixels are left out.
    """
    height, spacing = profiles(surface, along=along)
    height = height[np.isfinite(height).sum(axis=1) > 1]
    if height.size == 0:
        raise InvalidInput(f"a spectrum along {along} requires two measured pixels in one of them")
    points = height.shape[1]
    weight = _window(points, window)
    weighted = np.empty((_BLOCK, points))
    density = np.zeros(points // 2 + 1)
    for start in range(0, len(height), _BLOCK):
        block = height[start : start + _BLOCK]
        squares = _apply_window_to_rows(block, weight, weighted[: len(block)])
        transform = fft.rfft(weighted[: len(block)], axis=1)
        density += (1 / squares) @ (transform.real**2 + transform.imag**2)
    density *= spacing / len(height)
    return ProfileSpectrum(
        wavenumber=fft.rfftfreq(points, spacing),
        profile_spectral_density=density,
        height_variance=float(half_spectrum_multiplicity(points) @ density) / (points * spacing),
    )


def profiles(surface: HeightMap, *, along: ProfileDirection) -> tuple[Floats, float]:
    """Profiles of a height map, one per row of the result, and the distance of neighbouring points in m.

    Parameters
    ----------
    surface : HeightMap
    along : {"rows", "columns"}
        Direction of the profiles.

    Returns
    -------
    tuple of ndarray and float

    Raises
    ------
    InvalidInput
        If `along` is neither "rows" nor "columns".
    """
    if along == "rows":
        return np.ascontiguousarray(surface.height), surface.spacing_x
    if along == "columns":
        return np.ascontiguousarray(surface.height.T), surface.spacing_y
    raise InvalidInput(f"along must be rows or columns, got {along!r}")


def _window(points: int, window: Window) -> Floats:
    """Weights of a window at a number of points."""
    if window == "none":
        return np.ones(points)
    if window == "hann":
        return np.asarray(np.sin(math.pi * (np.arange(points) + 0.5) / points) ** 2)
    raise InvalidInput(f"window must be hann or none, got {window!r}")


def half_spectrum_multiplicity(points: int) -> Floats:
    """Number of occurrences of each wavenumber of a half spectrum in the two-sided one."""
    multiplicity = np.full(points // 2 + 1, 2.0)
    multiplicity[0] = 1.0
    if points % 2 == 0:
        multiplicity[-1] = 1.0
    return multiplicity


@kernel(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _apply_window(height: Floats, weight_y: Floats, weight_x: Floats, weighted: Floats) -> float:
    """Write weighted deviations from the weighted mean, zero where missing; return the sum of squared weights."""
    rows, columns = height.shape
    total, squares, sums = 0.0, 0.0, 0.0
    for row in range(rows):
        line = height[row]
        a, b, c = 0.0, 0.0, 0.0
        for column in range(columns):
            z = line[column]
            w = weight_x[column] if z == z else 0.0
            a += w
            b += w * w
            c += w * (z if z == z else 0.0)
        total += weight_y[row] * a
        squares += weight_y[row] ** 2 * b
        sums += weight_y[row] * c
    mean = sums / total
    for row in range(rows):
        line = height[row]
        for column in range(columns):
            z = line[column]
            weighted[row, column] = weight_y[row] * weight_x[column] * (z - mean) if z == z else 0.0
    return squares


@kernel(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _apply_window_to_rows(height: Floats, weight: Floats, weighted: Floats) -> Floats:
    """As `_apply_window`, for each row separately; return the sum of squared weights of each row."""
    squares, one = np.empty(height.shape[0]), np.ones(1)
    for row in range(height.shape[0]):
        squares[row] = _apply_window(height[row : row + 1], one, weight, weighted[row : row + 1])
    return squares


@kernel(cache=True, nogil=True, error_model="numpy")
def _ring_sums(kx: Floats, ky: Floats, multiplicity: Floats, density: Floats, per_width: float, sums: Floats) -> None:
    """Add number, wavenumber and density of the points in each ring to `sums`, the origin left out."""
    for row in range(ky.size):
        for column in range(kx.size):
            k = math.sqrt(kx[column] ** 2 + ky[row] ** 2)
            ring = int(k * per_width + 0.5)
            if ring < sums.shape[1] and k > 0:
                sums[0, ring] += multiplicity[column]
                sums[1, ring] += multiplicity[column] * k
                sums[2, ring] += multiplicity[column] * density[row, column]
