"""Dominant wavelengths of the waviness of a height map, from peaks of its mean power spectrum."""

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.form_removal import remove_form
from sonolube.models.surfaces.height_map import HeightMap
from sonolube.models.surfaces.spectrum import ProfileDirection, profiles

_PADDING = 8  # zero padding, so that a parabola locates the peak of the spectrum
_MIN_WAVES = 1.5  # in the map: longer waves are not distinguishable from form


def dominant_wavelengths(surface: HeightMap, *, along: ProfileDirection = "rows", most: int = 3) -> Floats:
    """Dominant wavelengths of the waviness in one direction, the strongest first. [m]

    Parameters
    ----------
    surface : HeightMap
        Its tilt is removed here, and missing pixels are set to zero. For several scales of waviness, as on coated
        steel, evaluate the low pass and the high pass as well.
    along : {"rows", "columns"}
        Direction of the profiles: along rows, the x-direction, or along columns, y.
    most : int
        Largest number of wavelengths to return.

    Returns
    -------
    ndarray, shape (found,)
        Wavelengths at the peaks of the mean power spectrum of all profiles with a Hann window; empty where the spectrum
        has no peak between 1.5 waves in the map and four pixels per wave.

    Raises
    ------
    InvalidInput
        If the map has fewer than 16 pixels in that direction.

    Notes
    -----
    In a map of length L a wavelength l is found to 5 % of l**2/L where the map contains four waves or more, and to a
    third of it where it contains two. Two wavelengths are resolved if they differ by about 2 l**2/L.

    References
    ----------
    .. [1] D 4.1.3, where Fourier transforms of the heights give 0.18 mm in both directions for a powder coating and
       1.25 mm and 0.95 mm for its coarser level.
    """
    levelled, spacing = profiles(remove_form(surface), along=along)
    z, points = np.nan_to_num(levelled), levelled.shape[1]
    if points < 16:
        raise InvalidInput(f"waviness requires at least 16 pixels along {along}, got {points}")
    spectrum = np.fft.rfft(z * np.hanning(points + 1)[:-1], _PADDING * points, axis=1)
    power = np.mean(np.abs(spectrum) ** 2, axis=0)
    inner = power[1:-1]
    waves = np.arange(1, power.size - 1) / _PADDING  # in the map
    peak = (inner > power[:-2]) & (inner >= power[2:]) & (waves >= _MIN_WAVES) & (waves <= points / 4)
    peak &= inner > 1e-3 * np.max(inner, initial=0.0)  # side lobes of the window are below
    found = 1 + np.flatnonzero(peak)
    left, middle, right = np.log(power[found - 1]), np.log(power[found]), np.log(power[found + 1])
    shift = (left - right) / (2 * (left - 2 * middle + right))
    strongest = np.argsort(-middle)[:most]
    return np.asarray(points * spacing * _PADDING / (found + shift)[strongest])
