"""Friction ratio of asperity stick-slip by interpolation, for very many amplitudes and decay lengths."""

from functools import cache

import numpy as np

from sonolube.checks import Floats
from sonolube.models.friction.models.asperity_stick_slip_sine import sine_stick_slip_ratio

_BETA = (0.02, 60.0)  # amplitude over decay length
_SPEED = (1e-3, 1.0)  # sliding speed over that from which the ratio is 1
_NODES = (80, 64)  # of the ratios that are computed
_FINE = (800, 640)  # of those that are interpolated between them


@cache
def _table() -> Floats:
    """Ratio at even steps of the logarithms of amplitude over decay length and of the reduced speed."""
    from scipy.interpolate import RectBivariateSpline

    beta, speed = (np.geomspace(*ends, count) for ends, count in zip((_BETA, _SPEED), _NODES, strict=True))
    length, frequency = 1e-6, 1e4
    a = beta[:, None] * length
    ratio = sine_stick_slip_ratio(
        decay_length=length,
        vibration_amplitude=a,
        frequency=frequency,
        sliding_speed=speed * 2 * np.pi * frequency * a,
        memory_length=length,
    )
    spline = RectBivariateSpline(np.log(beta), np.log(speed), ratio)
    fine = [np.log(np.geomspace(*ends, count)) for ends, count in zip((_BETA, _SPEED), _FINE, strict=True)]
    return np.asarray(np.clip(spline(*fine), 0.0, 1.0))


def interpolated_ratio(*, relative_amplitude: Floats, reduced_speed: Floats) -> Floats:
    """Friction ratio from amplitude over decay length a/l and reduced speed v l/(omega a D_c), any shape.

    Values outside the table, 0.02 to 60 and 0.001 to 1, are taken at its edge; from a reduced speed of 1 on it is 1.
    """
    from scipy.ndimage import map_coordinates

    places = [
        (np.log(np.clip(values, *ends)) - np.log(ends[0])) * ((count - 1) / np.log(ends[1] / ends[0]))
        for values, ends, count in zip((relative_amplitude, reduced_speed), (_BETA, _SPEED), _FINE, strict=True)
    ]
    ratio = map_coordinates(_table(), places, order=1, mode="nearest")
    return np.asarray(np.where(reduced_speed >= 1, 1.0, ratio))
