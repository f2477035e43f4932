"""Power spectra of a height map, and the moments they give."""

import math
from dataclasses import dataclass
from typing import Literal

import numba
import numpy as np
from scipy import fft

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.surfaces.height_map import HeightMap

Window = Literal["hann", "none"]
ProfileDirection = Literal["rows", "columns"]

_BLOCK = 64  # profiles transformed at a time, which then stay in the cache


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ArealSpectrum:
    """Two-sided power spectral density of heights over the plane of wavenumbers, of which a half is kept.

    Parameters
    ----------
    wavenumber_x : ndarray, shape (p,)
        Waves per length along the rows, from zero up. [1/m]
    wavenumber_y : ndarray, shape (rows,)
        Waves per length along the columns, from negative to positive. [1/m]
    areal_spectral_density : ndarray, shape (rows, p)
        Power spectral density; the other half follows from its symmetry about the origin. [m4]
    height_variance : float
        Its integral over the whole plane. [m2]
    columns : int
        Columns of the map: where even, the last wavenumber along the rows is its own mirror image.
    """

    wavenumber_x: Floats
    wavenumber_y: Floats
    areal_spectral_density: Floats
    height_variance: float
    columns: int


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RadialSpectrum:
    """Areal power spectral density, averaged over rings of one wavenumber.

    Parameters
    ----------
    wavenumber : ndarray, shape (n,)
        Mean wavenumber of each ring that holds any. [1/m]
    areal_spectral_density : ndarray, shape (n,)
        Mean density over the ring. [m4]
    """

    wavenumber: Floats
    areal_spectral_density: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ProfileSpectrum:
    """Two-sided power spectral density of profiles, of which the positive half is kept.

    Parameters
    ----------
    wavenumber : ndarray, shape (n,)
        Waves per length, from zero up. [1/m]
    profile_spectral_density : ndarray, shape (n,)
        Power spectral density, the mean over all profiles. [m3]
    height_variance : float
        Its integral over negative and positive wavenumbers. [m2]
    """

    wavenumber: Floats
    profile_spectral_density: Floats
    height_variance: float


@dataclass(frozen=True, kw_only=True, slots=True)
class SpectralMoments:
    """Moments of the spectrum of a profile along any direction of an isotropic surface.

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
        require_positive(
            height_variance=self.height_variance,
            slope_variance=self.slope_variance,
            curvature_variance=self.curvature_variance,
        )

    @property
    def bandwidth(self) -> float:
        """Nayak's alpha, m0 m4/m2^2: 1.5 at least for an isotropic Gaussian surface, and then of one wavelength. []"""
        return self.height_variance * self.curvature_variance / self.slope_variance**2


def areal_spectrum(surface: HeightMap, *, window: Window = "hann") -> ArealSpectrum:
    """Return the power spectral density over the plane of wavenumbers.

    Parameters
    ----------
    surface : HeightMap
    window : {"hann", "none"}
        Weight that fades towards the edges, or equal weight, which suits periodic maps only.

    Returns
    -------
    ArealSpectrum

    Raises
    ------
    InvalidInput
        If the window is unknown.

    Notes
    -----
    Missing pixels have weight zero. The weighted mean is removed, and the sum of squared weights divided out, so that
    the integral over the plane is the weighted variance (Parseval). Gaps smear the spectrum by that of their pattern:
    with more than a few per cent missing read the steep end with care. Densities are over waves per length; over
    angular wavenumbers q = 2 pi k the number is the same if the integral is taken with dq/(2 pi).

    References
    ----------
    .. [1] T. D. B. Jacobs, T. Junge, L. Pastewka, Surf. Topogr. 5, 013001 (2017). doi:10.1088/2051-672X/aa51f8
    """
    rows, columns = surface.height.shape
    weighted = np.empty((rows, columns))
    squares = _weigh(np.ascontiguousarray(surface.height), _window(rows, window), _window(columns, window), weighted)
    dx, dy = surface.spacing_x, surface.spacing_y
    transform = fft.rfft2(weighted, workers=-1, overwrite_x=True)
    density = transform.real**2
    density += transform.imag**2
    density *= dx * dy / squares
    return ArealSpectrum(
        wavenumber_x=fft.rfftfreq(columns, dx),
        wavenumber_y=fft.fftshift(fft.fftfreq(rows, dy)),
        areal_spectral_density=fft.fftshift(density, axes=0),
        height_variance=float(_both_halves(columns) @ density.sum(axis=0)) / (rows * columns * dx * dy),
        columns=columns,
    )


def radial_spectrum(spectrum: ArealSpectrum) -> RadialSpectrum:
    """Return the spectrum averaged over direction, in rings as wide as the coarser step of wavenumber.

    Parameters
    ----------
    spectrum : ArealSpectrum

    Returns
    -------
    RadialSpectrum
        Up to the highest wavenumber that both directions hold.

    Raises
    ------
    InvalidInput
        If the map is a line or a point, so that there is no ring.
    """
    kx, ky = spectrum.wavenumber_x, spectrum.wavenumber_y
    if kx.size < 2 or ky.size < 2:
        raise InvalidInput(f"a radial spectrum needs at least 2 rows and 2 columns, got {ky.size} x {spectrum.columns}")
    ring_width = max(kx[1], ky[1] - ky[0])
    rings = int(min(kx[-1], -ky[0]) / ring_width + 0.5)
    sums = np.zeros((3, rings + 1))
    _ring_sums(kx, ky, _both_halves(spectrum.columns), spectrum.areal_spectral_density, 1 / ring_width, sums)
    count, radius, density = sums[:, sums[0] > 0]
    return RadialSpectrum(wavenumber=radius / count, areal_spectral_density=density / count)


def profile_spectrum(
    surface: HeightMap, *, along: ProfileDirection = "rows", window: Window = "hann"
) -> ProfileSpectrum:
    """Return the mean power spectral density of the profiles along rows or columns.

    Parameters
    ----------
    surface : HeightMap
    along : {"rows", "columns"}
        Which way the profiles run.
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
    Each profile loses its own mean; missing pixels have weight zero, and profiles with fewer than two measured pixels
    are left out.
    """
    height, spacing = profiles(surface, along=along)
    height = height[np.isfinite(height).sum(axis=1) > 1]
    if height.size == 0:
        raise InvalidInput(f"a spectrum along {along} needs two measured pixels in one of them")
    points = height.shape[1]
    weight = _window(points, window)
    weighted = np.empty((_BLOCK, points))
    density = np.zeros(points // 2 + 1)
    for start in range(0, len(height), _BLOCK):
        block = height[start : start + _BLOCK]
        squares = _weigh_each(block, weight, weighted[: len(block)])
        transform = fft.rfft(weighted[: len(block)], axis=1)
        density += (1 / squares) @ (transform.real**2 + transform.imag**2)
    density *= spacing / len(height)
    return ProfileSpectrum(
        wavenumber=fft.rfftfreq(points, spacing),
        profile_spectral_density=density,
        height_variance=float(_both_halves(points) @ density) / (points * spacing),
    )


def moments_of_spectrum(spectrum: ArealSpectrum) -> SpectralMoments:
    """Return m0, m2 and m4 as integrals of the spectrum, the mean of both directions.

    Parameters
    ----------
    spectrum : ArealSpectrum

    Returns
    -------
    SpectralMoments

    Raises
    ------
    InvalidInput
        If a moment is zero, as of a flat map or a line.

    Notes
    -----
    m4 gives the finest waves of the map the greatest weight, noise included; `spectral_moments` takes finite
    differences instead, which damp them.
    """
    times = _both_halves(spectrum.columns)
    along_x, along_y = times * spectrum.areal_spectral_density.sum(axis=0), spectrum.areal_spectral_density @ times
    share = spectrum.height_variance / (along_x.sum() or 1.0)
    qx, qy = 2 * math.pi * spectrum.wavenumber_x, 2 * math.pi * spectrum.wavenumber_y
    return SpectralMoments(
        height_variance=spectrum.height_variance,
        slope_variance=float(share * (along_x @ qx**2 + along_y @ qy**2) / 2),
        curvature_variance=float(share * (along_x @ qx**4 + along_y @ qy**4) / 2),
    )


def profiles(surface: HeightMap, *, along: ProfileDirection) -> tuple[Floats, float]:
    """Return the heights of a map with a profile in each row, and the distance of a profile's points in m.

    Parameters
    ----------
    surface : HeightMap
    along : {"rows", "columns"}
        Which way the profiles run.

    Returns
    -------
    tuple of ndarray and float

    Raises
    ------
    InvalidInput
        If `along` is neither rows nor columns.
    """
    if along == "rows":
        return np.ascontiguousarray(surface.height), surface.spacing_x
    if along == "columns":
        return np.ascontiguousarray(surface.height.T), surface.spacing_y
    raise InvalidInput(f"along must be rows or columns, got {along!r}")


def _window(points: int, window: Window) -> Floats:
    if window == "none":
        return np.ones(points)
    if window == "hann":
        return np.asarray(np.sin(math.pi * (np.arange(points) + 0.5) / points) ** 2)
    raise InvalidInput(f"window must be hann or none, got {window!r}")


def _both_halves(points: int) -> Floats:
    """Return how often each wavenumber of a half spectrum stands in the whole one."""
    times = np.full(points // 2 + 1, 2.0)
    times[0] = 1.0
    if points % 2 == 0:
        times[-1] = 1.0
    return times


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _weigh(height: Floats, weight_y: Floats, weight_x: Floats, weighted: Floats) -> float:
    """Write the weighted deviations from the weighted mean, zero where missing; return the sum of squared weights."""
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


@numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _weigh_each(height: Floats, weight: Floats, weighted: Floats) -> Floats:
    """Do as `_weigh` for each row by itself; return each row's sum of squared weights."""
    squares = np.zeros(height.shape[0])
    for row in range(height.shape[0]):
        line = height[row]
        a, b, c = 0.0, 0.0, 0.0
        for column in range(line.size):
            z = line[column]
            w = weight[column] if z == z else 0.0
            a += w
            b += w * w
            c += w * (z if z == z else 0.0)
        squares[row] = b
        mean = c / a
        for column in range(line.size):
            z = line[column]
            weighted[row, column] = weight[column] * (z - mean) if z == z else 0.0
    return squares


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _ring_sums(kx: Floats, ky: Floats, times: Floats, density: Floats, per_width: float, sums: Floats) -> None:
    """Add up number, wavenumber and density of what falls into each ring, the origin left out."""
    for row in range(ky.size):
        for column in range(kx.size):
            k = math.sqrt(kx[column] ** 2 + ky[row] ** 2)
            ring = int(k * per_width + 0.5)
            if ring < sums.shape[1] and k > 0:
                sums[0, ring] += times[column]
                sums[1, ring] += times[column] * k
                sums[2, ring] += times[column] * density[row, column]
