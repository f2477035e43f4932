"""Surfaces made to measure: Gaussian heights of a known spectrum."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import fft

from sonolube.checks import Floats, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.surfaces.height_map import HeightMap
from sonolube.surfaces.spectrum import SpectralMoments


@dataclass(frozen=True, kw_only=True, slots=True)
class GaussianCorrelationSpectrum:
    """Isotropic spectrum of the autocorrelation exp(-r^2/l^2): hills and valleys of about one size.

    Parameters
    ----------
    correlation_length : float
        Distance l in which the autocorrelation falls to 1/e. [m]
    """

    correlation_length: float

    def __post_init__(self) -> None:
        require_positive(correlation_length=self.correlation_length)

    @property
    def longest_wavelength(self) -> float:
        """Longest wave that carries much of the height, as a length a map must hold. [m]"""
        return math.pi * self.correlation_length

    @property
    def shortest_wavelength(self) -> float:
        """Wave below which there is less than 1e-4 of the variance. [m]"""
        return self.correlation_length

    def relative_spectral_density(self, *, wavenumber: Floats) -> Floats:
        """Return the areal density up to a factor.

        Parameters
        ----------
        wavenumber : ndarray, any shape
            Waves per length. [1/m]

        Returns
        -------
        ndarray, shape of `wavenumber`
        """
        return np.asarray(np.exp(-np.square(math.pi * self.correlation_length * wavenumber)))

    def moments(self, *, rms_height: float) -> SpectralMoments:
        """Return the spectral moments in closed form.

        Parameters
        ----------
        rms_height : float
            Standard deviation of heights. [m]

        Returns
        -------
        SpectralMoments
        """
        require_positive(rms_height=rms_height)
        length = self.correlation_length
        return SpectralMoments(
            height_variance=rms_height**2,
            slope_variance=2 * rms_height**2 / length**2,
            curvature_variance=12 * rms_height**2 / length**4,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class SelfAffineSpectrum:
    """Isotropic spectrum that falls as a power of the wavenumber, as of ground, worn and fractured surfaces.

    The density is constant from the longest wavelength to the roll-off, falls as k^(-2 - 2H) to the shortest
    wavelength, and is zero outside.

    Parameters
    ----------
    hurst_exponent : float
        H, between 0 and 1; the smaller, the more of the height lies in short waves. []
    longest_wavelength : float
        Longest wavelength. [m]
    rolloff_wavelength : float
        Wavelength above which the density is constant. [m]
    shortest_wavelength : float
        Shortest wavelength. [m]

    Raises
    ------
    InvalidInput
        If a value is out of range or the wavelengths are not in falling order.

    References
    ----------
    .. [1] B. N. J. Persson et al., J. Phys. Condens. Matter 17, R1 (2005). doi:10.1088/0953-8984/17/1/R01
    """

    hurst_exponent: float
    longest_wavelength: float
    rolloff_wavelength: float
    shortest_wavelength: float

    def __post_init__(self) -> None:
        require_within(0.0, 1.0, hurst_exponent=self.hurst_exponent)
        require_positive(
            longest_wavelength=self.longest_wavelength,
            rolloff_wavelength=self.rolloff_wavelength,
            shortest_wavelength=self.shortest_wavelength,
        )
        if not self.longest_wavelength >= self.rolloff_wavelength > self.shortest_wavelength:
            raise InvalidInput(
                "longest_wavelength, rolloff_wavelength and shortest_wavelength must fall in this order, got "
                f"{self.longest_wavelength!r} m, {self.rolloff_wavelength!r} m and {self.shortest_wavelength!r} m"
            )

    def relative_spectral_density(self, *, wavenumber: Floats) -> Floats:
        """Return the areal density over that below the roll-off.

        Parameters
        ----------
        wavenumber : ndarray, any shape
            Waves per length. [1/m]

        Returns
        -------
        ndarray, shape of `wavenumber`
        """
        rolled = np.maximum(wavenumber * self.rolloff_wavelength, 1.0) ** (-2 - 2 * self.hurst_exponent)
        inside = (wavenumber * self.longest_wavelength >= 1) & (wavenumber * self.shortest_wavelength <= 1)
        return np.where(inside, rolled, 0.0)

    def moments(self, *, rms_height: float) -> SpectralMoments:
        """Return the spectral moments in closed form.

        Parameters
        ----------
        rms_height : float
            Standard deviation of heights. [m]

        Returns
        -------
        SpectralMoments
        """
        require_positive(rms_height=rms_height)
        m0 = 2 * math.pi * self._radial_integral(1)
        m2 = 2 * math.pi * (2 * math.pi) ** 2 / 2 * self._radial_integral(3)  # mean of cos^2 is 1/2
        m4 = 2 * math.pi * (2 * math.pi) ** 4 * 3 / 8 * self._radial_integral(5)  # mean of cos^4 is 3/8
        scale = rms_height**2 / m0
        return SpectralMoments(height_variance=rms_height**2, slope_variance=scale * m2, curvature_variance=scale * m4)

    def _radial_integral(self, power: int) -> float:
        """Return the integral of k^power times the relative density."""
        low, knee, high = 1 / self.longest_wavelength, 1 / self.rolloff_wavelength, 1 / self.shortest_wavelength
        plateau = (knee ** (power + 1) - low ** (power + 1)) / (power + 1)
        fall = power - 1 - 2 * self.hurst_exponent
        slope = math.log(high / knee) if fall == 0 else (high**fall - knee**fall) / fall
        return float(plateau + knee ** (2 + 2 * self.hurst_exponent) * slope)


HeightSpectrum = GaussianCorrelationSpectrum | SelfAffineSpectrum


def gaussian_surface(
    *,
    rms_height: float,
    spectrum: HeightSpectrum,
    shape: tuple[int, int],
    spacing_x: float,
    spacing_y: float,
    seed: int,
) -> HeightMap:
    """Return a random surface with Gaussian heights and the given spectrum.

    Parameters
    ----------
    rms_height : float
        Standard deviation of heights over many such surfaces; that of one map scatters about it. [m]
    spectrum : SingleScaleSpectrum or SelfAffineSpectrum
    shape : tuple of int
        Rows and columns.
    spacing_x : float
        Distance of neighbouring columns. [m]
    spacing_y : float
        Distance of neighbouring rows. [m]
    seed : int
        The same seed gives the same surface.

    Returns
    -------
    HeightMap
        Periodic: opposite edges fit each other.

    Raises
    ------
    InvalidInput
        If an argument is out of range.
    OutsideRange
        If the spacing is coarser than half the shortest wavelength, or the map shorter than the longest.

    Notes
    -----
    White noise is weighted with the root of the spectrum in the space of wavenumbers.
    """
    require_positive(rms_height=rms_height, spacing_x=spacing_x, spacing_y=spacing_y)
    rows, columns = shape
    if max(spacing_x, spacing_y) > spectrum.shortest_wavelength / 2 * (1 + 1e-9):
        raise OutsideRange(
            f"spacing_x and spacing_y must be at most half the shortest wave, {spectrum.shortest_wavelength!r} m; "
            f"got {spacing_x!r} m and {spacing_y!r} m"
        )
    if min(rows * spacing_y, columns * spacing_x) < spectrum.longest_wavelength * (1 - 1e-9):
        raise OutsideRange(
            f"the map must be at least {spectrum.longest_wavelength!r} m long both ways, "
            f"got {rows * spacing_y!r} m by {columns * spacing_x!r} m"
        )
    noise = fft.rfft2(np.random.default_rng(seed).standard_normal((rows, columns)), workers=-1)
    k = np.hypot(fft.rfftfreq(columns, spacing_x)[None, :], fft.fftfreq(rows, spacing_y)[:, None])
    density = spectrum.relative_spectral_density(wavenumber=k)
    density[0, 0] = 0.0
    mirrored = 2 * density.sum() - density[:, 0].sum() - (density[:, -1].sum() if columns % 2 == 0 else 0.0)
    noise *= np.sqrt(density * (rows * columns / mirrored))
    height = rms_height * fft.irfft2(noise, s=(rows, columns), workers=-1, overwrite_x=True)
    return HeightMap(height=height, spacing_x=spacing_x, spacing_y=spacing_y)
