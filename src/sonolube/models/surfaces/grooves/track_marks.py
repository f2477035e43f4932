"""Periodic marks along a wear track, such as dots of a vibration or indentations of stick-slip, by their spectrum."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft, stats

from sonolube.checks import Floats, require_within
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.grooves.groove import Groove
from sonolube.models.surfaces.grooves.track import cross_sections

_PADDING = 8  # zero padding of the profiles
_MIN_PERIODS = 2.0  # in the track
_POINTS_PER_PERIOD = 2.5
_MIN_MEASURED = 0.5  # fraction of the profiles at a point
_CANDIDATES = 8  # local maxima of the spectrum that are compared
_LOBE = 2.0  # width of a peak of the spectrum over the resolution
_FALSE_ALARMS = 0.01  # probability of a spacing where there are no marks
_TRIALS_PER_RESOLUTION = 2.0  # independent heights of a spectrum of tapered profiles, per resolution
_ROLL_OFFS = 24  # lengths of the background's roll-off that are tried
_NEIGHBOURS, _MIN_NEIGHBOURS = 12, 6  # resolutions beside a peak that give the freedom of the spectrum
_RESOLUTIONS_PER_HEIGHT = 1.5  # of a spectrum of tapered profiles


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TrackMarks:
    """Spacing of periodic marks along a wear track, with the power spectrum from which it was found.

    Parameters
    ----------
    dot_spacing : float or None
        Spacing of the marks; None where no peak is significant. [m]
    dot_spacing_uncertainty : float or None
        Standard uncertainty of the spacing. [m]
    prominence : float
        Power of the most prominent peak over that of the background.
    false_alarm_probability : float
        Probability of a peak as prominent, at any of the wavenumbers searched, where there are no marks.
    reason : str
        Reason why no spacing is given; empty where one is.
    wavenumber : ndarray, shape (n,)
        Wavenumber along the track, in waves per length. [1/m]
    profile_spectral_density : ndarray, shape (n,)
        Mean power spectral density of the longitudinal profiles. [m3]
    background : ndarray, shape (n,)
        Smooth spectrum fitted to it, in m3.
    """

    dot_spacing: float | None
    dot_spacing_uncertainty: float | None
    prominence: float
    false_alarm_probability: float
    reason: str
    wavenumber: Floats
    profile_spectral_density: Floats
    background: Floats


def track_marks(groove: Groove, *, width_fraction: float = 0.6, averaged_points: int = 8) -> TrackMarks:
    r"""Spacing of periodic marks along the floor of a groove, from the mean power spectrum of longitudinal profiles.

    Parameters
    ----------
    groove : Groove
    width_fraction : float
        Fraction of the groove width that is evaluated, about the middle.
    averaged_points : int
        Number of points across the track that are averaged to one longitudinal profile.

    Returns
    -------
    TrackMarks

    Raises
    ------
    InvalidInput
        If the fraction is out of range, or too little of the floor was measured.

    Notes
    -----
    The mean cross-section is subtracted from the heights, and mean and trend from each profile; missing points are set
    to zero, and a Hann window is applied. The spectra of the profiles are averaged, so that marks of different profiles
    need not be in phase. The background is a power law with a roll-off, and the power over it an F variate, whose
    freedom follows from the coherence of the profiles about the peak. A spacing is given
    where a peak as high would appear at any of the wavenumbers searched with a probability below 1 % [3]_. Spacings
    from 2.5 points to half the track can be found. With the length :math:`L` of the track and the prominence :math:`p`
    the standard uncertainty of the spacing :math:`s` is the Cramer-Rao bound [2]_ of a single profile

    .. math:: u(s) = \frac{s^2}{2\pi L} \sqrt{\frac{6}{p}} .

    `sonolube.facts.metrics.dot_spacing` and `indentation_spacing` give expected values: 3.95 um for 22 kHz at 87 mm/s,
    which requires pixels below 1.6 um, and 0.87 mm for stick-slip every 10 ms.

    References
    ----------
    .. [1] D 2.4 and figures 2.25 and 2.26.
    .. [2] D. C. Rife and R. R. Boorstyn, IEEE Trans. Inf. Theory 20, 591 (1974). doi:10.1109/TIT.1974.1055282
    .. [3] J. D. Scargle, Astrophys. J. 263, 835 (1982), section III. doi:10.1086/160554
    """
    require_within(0.05, 1.0, width_fraction=width_fraction)
    profiles, step = _longitudinal_profiles(groove, width_fraction, averaged_points)
    length = profiles.shape[1] * step
    size = fft.next_fast_len(_PADDING * profiles.shape[1])
    window = np.hanning(profiles.shape[1] + 2)[1:-1]
    spectra = fft.rfft(profiles * window, size, axis=1) * math.sqrt(step / float(np.sum(window**2)))
    power = np.mean(np.abs(spectra) ** 2, axis=0)
    k = fft.rfftfreq(size, step)
    resolved = (k >= _MIN_PERIODS / length) & (k <= 1 / (_POINTS_PER_PERIOD * step))
    k, power, spectra = k[resolved], power[resolved], spectra[:, resolved]
    if k.size < 3 * _PADDING or not np.any(power > 0):
        track = f"a track of {length:.2g} m with points every {step:.2g} m"
        raise InvalidInput(f"{track} is too short or too flat for a spectrum")
    maxima = 1 + np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:]))
    candidates = maxima[np.argsort(-(power * k)[maxima])][:_CANDIDATES]
    alarm, top, background = 1.0, 0, power
    for index in candidates.tolist():
        level = _background(k, power, np.abs(k - k[index]) > _LOBE / length, length)
        found = _false_alarm(k, power / level, spectra / np.sqrt(level), index, length)
        if top == 0 or found < alarm:
            alarm, top, background = found, index, level
    if top == 0:
        background = _background(k, power, np.ones(k.size, dtype=np.bool_), length)
    prominence = float(power[top] / background[top]) if top else 0.0
    significant = alarm < _FALSE_ALARMS
    spacing = 1 / _interpolated_maximum(k, power, top) if significant else None
    weak = f"no periodic marks found (largest peak {prominence:.1f} times the background, p = {alarm:.2g})"
    return TrackMarks(
        dot_spacing=spacing,
        dot_spacing_uncertainty=None if spacing is None else _uncertainty(spacing, length, prominence),
        prominence=prominence,
        false_alarm_probability=alarm,
        reason="" if significant else weak,
        wavenumber=k,
        profile_spectral_density=power,
        background=background,
    )


def _longitudinal_profiles(groove: Groove, width_fraction: float, averaged_points: int) -> tuple[Floats, float]:
    """Profiles along the floor of a groove less their mean and trend, and the distance of their points in m."""
    # the section is subtracted at each pixel's own distance: resampling at nearest pixels would leave steps on slopes
    transverse, _ = groove.track.curvilinear_coordinates(groove.levelled)
    flat = groove.levelled.with_height(groove.levelled.height - groove.mean_cross_section.at(transverse))
    reach = width_fraction * groove.groove_width / 2
    sections = cross_sections(flat, groove.track, reach=(-reach, reach))
    height = sections.height.T  # (points, sections)
    height = height[: max(1, len(height) // averaged_points) * averaged_points]
    measured = np.isfinite(height)
    shape = (-1, min(averaged_points, len(height)), height.shape[1])
    count = measured.reshape(shape).sum(axis=1)
    profiles = np.where(measured, height, 0.0).reshape(shape).sum(axis=1) / np.maximum(count, 1)
    whole = np.flatnonzero(np.mean(count > 0, axis=0) > _MIN_MEASURED)
    if whole.size < 2:
        raise InvalidInput("too little of the groove's floor was measured for a spectrum along it")
    profiles, count = profiles[:, whole[0] : whole[-1] + 1], count[:, whole[0] : whole[-1] + 1]
    t = np.linspace(-1, 1, profiles.shape[1])
    t, known = np.where(count > 0, t, 0.0), count > 0
    level = profiles.sum(axis=1, keepdims=True) / np.maximum(known.sum(axis=1, keepdims=True), 1)
    profiles = np.where(known, profiles - level, 0.0)
    trend = np.sum(profiles * t, axis=1, keepdims=True) / np.maximum(np.sum(t * t, axis=1, keepdims=True), 1e-12)
    return profiles - trend * t, float(sections.arc_length[1] - sections.arc_length[0])


def _background(k: Floats, power: Floats, beside: NDArray[np.bool_], length: float) -> Floats:
    """Power law with a roll-off fitted at some wavenumbers in double logarithmic scale."""
    y = np.log(np.maximum(power, power.max() * 1e-12))

    def fitted(roll_off: float) -> Floats:
        design = np.stack([np.ones(k.size), np.log1p((2 * math.pi * roll_off * k) ** 2)], axis=1)
        return np.asarray(design @ np.linalg.lstsq(design[beside], y[beside], rcond=None)[0])

    models = [fitted(roll_off) for roll_off in np.geomspace(1 / length, 1 / k[-1], _ROLL_OFFS)]
    return np.asarray(np.exp(min(models, key=lambda model: float(np.sum(np.square((y - model)[beside]))))))


def _false_alarm(k: Floats, ratio: Floats, spectra: Floats, top: int, length: float) -> float:
    """Probability of a peak as high anywhere, from the freedom of the averaged spectra about the peak."""
    away = np.abs(k - k[top]) * length
    beside = np.flatnonzero(away > _LOBE)
    near = np.sort(beside[np.argsort(np.abs(np.log(k[beside] / k[top])))][: _NEIGHBOURS * _PADDING])
    if near.size < _MIN_NEIGHBOURS * _PADDING:
        return 1.0
    count = near.size / _PADDING / _RESOLUTIONS_PER_HEIGHT  # independent ones
    normal = spectra[:, near]
    products = normal @ np.conj(normal.T) / near.size
    squared_trace = float(np.trace(products).real) ** 2
    inverse_freedom = (float(np.sum(np.abs(products) ** 2)) / squared_trace - 1 / count) / (1 - 1 / count**2)
    freedom = 1 / min(max(inverse_freedom, 1 / len(spectra)), 1.0)
    height = float(ratio[top] / np.mean(ratio[near]))
    single = float(stats.f.sf(height, 2 * freedom, 2 * freedom * count))
    searched = _TRIALS_PER_RESOLUTION * float(k[-1] - k[0]) * length
    return -math.expm1(searched * math.log1p(-min(single, 1 - 1e-12)))


def _interpolated_maximum(k: Floats, power: Floats, top: int) -> float:
    """Wavenumber of the maximum of the parabola through a point and its neighbours."""
    left, middle, right = power[top - 1 : top + 2]
    return float(k[top] + (k[1] - k[0]) * (left - right) / (2 * (left - 2 * middle + right)))


def _uncertainty(spacing: float, length: float, prominence: float) -> float:
    """Cramer-Rao bound of the spacing from one profile, in m."""
    return spacing**2 * math.sqrt(6 / prominence) / (2 * math.pi * length)
