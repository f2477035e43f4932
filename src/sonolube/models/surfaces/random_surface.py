"""Randomly rough surfaces: Gaussian heights with a given power spectrum, by spectral synthesis."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import fft

from sonolube.checks import Floats, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True)
class GaussianCorrelationSpectrum:
    r"""Isotropic spectrum of the Gaussian autocorrelation exp(-r^2/l^2): asperities of about one size.

    Parameters
    ----------
    correlation_length : float
        Distance l over which the autocorrelation decays to 1/e. [m]

    Notes
    -----
    .. math:: C(k) \propto e^{-(\pi l k)^2}, \qquad
        m_0 = \sigma^2, \quad m_2 = \frac{2\sigma^2}{l^2}, \quad m_4 = \frac{12\sigma^2}{l^4}, \quad \alpha = 3 .
    """

    correlation_length: float

    def __post_init__(self) -> None:
        require_positive(correlation_length=self.correlation_length)

    @property
    def longest_wavelength(self) -> float:
        """Wavelength that a map must contain to represent the spectrum. [m]"""
        return math.pi * self.correlation_length

    @property
    def shortest_wavelength(self) -> float:
        """Wavelength below which the spectrum has less than 1e-4 of the variance. [m]"""
        return self.correlation_length

    def relative_spectral_density(self, *, wavenumber: Floats) -> Floats:
        """Areal power spectral density up to a factor.

        Parameters
        ----------
        wavenumber : ndarray, any shape
            Wavenumber, in waves per length. [1/m]

        Returns
        -------
        ndarray, shape of `wavenumber`
        """
        return np.asarray(np.exp(-np.square(math.pi * self.correlation_length * wavenumber)))


@dataclass(frozen=True, kw_only=True, slots=True)
class SelfAffineSpectrum:
    r"""Isotropic self-affine spectrum with roll-off, as of ground, worn and fractured surfaces.

    Parameters
    ----------
    hurst_exponent : float
        Hurst exponent H, between 0 and 1; the smaller, the rougher at short wavelengths. []
    longest_wavelength : float
        Longest wavelength of the spectrum. [m]
    rolloff_wavelength : float
        Roll-off wavelength, above which the density is constant. [m]
    shortest_wavelength : float
        Shortest wavelength of the spectrum. [m]

    Raises
    ------
    InvalidInput
        If a value is out of range or the wavelengths are not in descending order.

    Notes
    -----
    With the wavenumbers :math:`k_L < k_r < k_s` of the three wavelengths

    .. math:: C(k) \propto \begin{cases} 1 & k_L \le k \le k_r \\ (k/k_r)^{-2 - 2H} & k_r < k \le k_s \end{cases}

    and zero elsewhere.

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
                "longest_wavelength, rolloff_wavelength and shortest_wavelength must be in descending order, got "
                f"{self.longest_wavelength!r} m, {self.rolloff_wavelength!r} m and {self.shortest_wavelength!r} m"
            )

    def relative_spectral_density(self, *, wavenumber: Floats) -> Floats:
        """Areal power spectral density over that below the roll-off.

        Parameters
        ----------
        wavenumber : ndarray, any shape
            Wavenumber, in waves per length. [1/m]

        Returns
        -------
        ndarray, shape of `wavenumber`
        """
        density = np.maximum(wavenumber * self.rolloff_wavelength, 1.0) ** (-2 - 2 * self.hurst_exponent)
        inside = (wavenumber * self.longest_wavelength >= 1) & (wavenumber * self.shortest_wavelength <= 1)
        return np.where(inside, density, 0.0)


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
    """Periodic random surface with Gaussian heights and a given power spectrum, by spectral synthesis.

    Parameters
    ----------
    rms_height : float
        Standard deviation of heights in the ensemble; that of one map scatters about it. [m]
    spectrum : GaussianCorrelationSpectrum or SelfAffineSpectrum
    shape : tuple of int
        Numbers of rows and columns.
    spacing_x : float
        Distance of neighbouring columns. [m]
    spacing_y : float
        Distance of neighbouring rows. [m]
    seed : int
        Seed of the random numbers.

    Returns
    -------
    HeightMap
        Periodic: opposite edges are continuous.

    Raises
    ------
    InvalidInput
        If an argument is out of range.
    OutsideRange
        If the spacing is coarser than half the shortest wavelength, or the map shorter than the longest.

    Notes
    -----
    The Fourier transform of white noise is multiplied by the square root of the spectral density.

    Examples
    --------
    >>> from sonolube.models.surfaces import GaussianCorrelationSpectrum, gaussian_surface
    >>> spectrum = GaussianCorrelationSpectrum(correlation_length=10e-6)
    >>> grid = {"shape": (256, 256), "spacing_x": 2e-6, "spacing_y": 2e-6}
    >>> surface = gaussian_surface(rms_height=1e-6, spectrum=spectrum, **grid, seed=1)
    >>> round(1e6 * float(surface.height.std()), 1)
    1.0
    """
    require_positive(rms_height=rms_height, spacing_x=spacing_x, spacing_y=spacing_y)
    rows, columns = shape
    if max(spacing_x, spacing_y) > spectrum.shortest_wavelength / 2 * (1 + 1e-9):
        raise OutsideRange(
            "spacing_x and spacing_y must be at most half the shortest wavelength, "
            f"{spectrum.shortest_wavelength!r} m; got {spacing_x!r} m and {spacing_y!r} m"
        )
    if min(rows * spacing_y, columns * spacing_x) < spectrum.longest_wavelength * (1 - 1e-9):
        raise OutsideRange(
            f"the map must be at least {spectrum.longest_wavelength!r} m long in both directions, "
            f"got {rows * spacing_y!r} m by {columns * spacing_x!r} m"
        )
    noise = fft.rfft2(np.random.default_rng(seed).standard_normal((rows, columns)), workers=-1)
    k = np.hypot(fft.rfftfreq(columns, spacing_x)[None, :], fft.fftfreq(rows, spacing_y)[:, None])
    density = spectrum.relative_spectral_density(wavenumber=k)
    density[0, 0] = 0.0
    total = 2 * density.sum() - density[:, 0].sum() - (density[:, -1].sum() if columns % 2 == 0 else 0.0)
    noise *= np.sqrt(density * (rows * columns / total))
    height = rms_height * fft.irfft2(noise, s=(rows, columns), workers=-1, overwrite_x=True)
    return HeightMap(height=height, spacing_x=spacing_x, spacing_y=spacing_y)
