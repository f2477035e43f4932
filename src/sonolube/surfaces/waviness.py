"""Waviness: which wavelengths stand out of a surface."""

from typing import Literal

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.surfaces.form_removal import remove_form
from sonolube.surfaces.height_map import HeightMap

_PADDING = 8  # points of the spectrum to one of the plain transform, so that a parabola finds the peak
_FEWEST_WAVES = 1.5  # in the map: what is longer cannot be told from form


def dominant_wavelengths(height_map: HeightMap, *, along: Literal["rows", "columns"] = "rows", most: int = 3) -> Floats:
    """Wavelengths of the waviness in one direction, the strongest first. [m]

    Parameters
    ----------
    height_map : HeightMap
        The surface; its tilt is taken off here, missing pixels count as level. For several levels of waviness, as on
        coated steel, look at the low pass and the high pass too.
    along : {"rows", "columns"}
        Whether along rows, the x-direction, or along columns, y.
    most : int
        How many wavelengths at the most.

    Returns
    -------
    ndarray, shape (found,)
        Wavelengths at the peaks of the mean power spectrum of all profiles under a Hann window; empty where the
        spectrum has none between one and a half waves in the map and four pixels.

    Raises
    ------
    InvalidInput
        If fewer than 16 pixels lie along that direction.

    Notes
    -----
    A wave of length l in a map of length L is found to 5 % of l**2/L where four waves or more lie in the map, to a
    third of it where there are two. Two waves are told apart when their lengths differ by about 2 l**2/L.

    References
    ----------
    .. [1] D 4.1.3, where Fourier transforms of the heights give 0.18 mm in both directions for a powder coating and
       1.25 mm and 0.95 mm for its coarser level.
    """
    z = np.nan_to_num(remove_form(height_map).height)
    spacing = height_map.spacing_x
    if along == "columns":
        z, spacing = z.T, height_map.spacing_y
    points = z.shape[1]
    if points < 16:
        raise InvalidInput(f"waviness needs 16 pixels along {along} at the least, got {points}")
    spectrum = np.fft.rfft(z * np.hanning(points + 1)[:-1], _PADDING * points, axis=1)
    power = np.mean(np.abs(spectrum) ** 2, axis=0)
    inner = power[1:-1]
    waves = np.arange(1, power.size - 1) / _PADDING  # in the map
    peak = (inner > power[:-2]) & (inner >= power[2:]) & (waves >= _FEWEST_WAVES) & (waves <= points / 4)
    peak &= inner > 1e-3 * np.max(inner, initial=0.0)  # the window's own side lobes are below
    found = 1 + np.flatnonzero(peak)
    left, middle, right = np.log(power[found - 1]), np.log(power[found]), np.log(power[found + 1])
    shift = (left - right) / (2 * (left - 2 * middle + right))
    strongest = np.argsort(-middle)[:most]
    return np.asarray(points * spacing * _PADDING / (found + shift)[strongest])
