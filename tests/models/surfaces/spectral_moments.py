"""Spectral moments m0, m2 and m4 of the spectra of random surfaces in closed form, and as integrals of a spectrum."""

import math

from sonolube.models.surfaces import (
    ArealSpectrum,
    GaussianCorrelationSpectrum,
    HeightSpectrum,
    SelfAffineSpectrum,
    SpectralMoments,
)
from sonolube.models.surfaces.spectrum import half_spectrum_multiplicity


def moments(spectrum: HeightSpectrum, *, rms_height: float) -> SpectralMoments:
    """Spectral moments of a surface of a spectrum."""
    variance = rms_height**2
    if isinstance(spectrum, GaussianCorrelationSpectrum):
        length = spectrum.correlation_length
        return SpectralMoments(
            height_variance=variance,
            slope_variance=2 * variance / length**2,
            curvature_variance=12 * variance / length**4,
        )
    m0 = 2 * math.pi * _radial_integral(spectrum, 1)
    m2 = 2 * math.pi * (2 * math.pi) ** 2 / 2 * _radial_integral(spectrum, 3)  # mean of cos^2 is 1/2
    m4 = 2 * math.pi * (2 * math.pi) ** 4 * 3 / 8 * _radial_integral(spectrum, 5)  # mean of cos^4 is 3/8
    return SpectralMoments(
        height_variance=variance, slope_variance=variance / m0 * m2, curvature_variance=variance / m0 * m4
    )


def _radial_integral(spectrum: SelfAffineSpectrum, power: int) -> float:
    """Integral of k^power times the relative density over k."""
    low, rolloff = 1 / spectrum.longest_wavelength, 1 / spectrum.rolloff_wavelength
    high = 1 / spectrum.shortest_wavelength
    plateau = (rolloff ** (power + 1) - low ** (power + 1)) / (power + 1)
    exponent = power - 1 - 2 * spectrum.hurst_exponent
    decay = math.log(high / rolloff) if exponent == 0 else (high**exponent - rolloff**exponent) / exponent
    return float(plateau + rolloff ** (2 + 2 * spectrum.hurst_exponent) * decay)


def moments_of_spectrum(spectrum: ArealSpectrum) -> SpectralMoments:
    """Spectral moments as integrals of an areal power spectrum, averaged over both directions."""
    multiplicity = half_spectrum_multiplicity(spectrum.columns)
    density = spectrum.areal_spectral_density
    along_x, along_y = multiplicity * density.sum(axis=0), density @ multiplicity
    step = spectrum.height_variance / along_x.sum()
    qx, qy = 2 * math.pi * spectrum.wavenumber_x, 2 * math.pi * spectrum.wavenumber_y
    return SpectralMoments(
        height_variance=spectrum.height_variance,
        slope_variance=float(step * (along_x @ qx**2 + along_y @ qy**2) / 2),
        curvature_variance=float(step * (along_x @ qx**4 + along_y @ qy**4) / 2),
    )
