"""Marks along a wear track: the dots of a vibration and the indentations of stick-slip, by their spacing."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from sonolube.checks import Floats, require_within
from sonolube.errors import InvalidInput
from sonolube.surfaces.grooves.groove import Groove
from sonolube.surfaces.grooves.sections import cross_sections

_FINER = 8  # steps of wavenumber to the one that the length of the track resolves
_LEAST_PERIODS = 2.0
_POINTS_PER_PERIOD = 2.5
_LEAST_SEEN = 0.5  # of a lane
_CANDIDATES = 8
_LOBE = 2.0  # width of a wave in the spectrum, over what the length of the track resolves
_STANDS_OUT = 8.0  # power over the background's: chance reaches half of it in a field of single lanes


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TrackMarks:
    """The spacing at which marks repeat along a track.

    Parameters
    ----------
    dot_spacing : float or None
        Spacing of the marks; None where none stand out. [m]
    dot_spacing_uncertainty : float or None
        Its standard uncertainty. [m]
    prominence : float
        Power of the foremost wave over that of the background.
    reason : str
        Why no spacing is given; empty where one is.
    wavenumber : ndarray, shape (n,)
        Waves per length along the track. [1/m]
    profile_spectral_density : ndarray, shape (n,)
        Mean power spectral density of the lanes. [m3]
    background : ndarray, shape (n,)
        A power law through it, in m3.
    """

    dot_spacing: float | None
    dot_spacing_uncertainty: float | None
    prominence: float
    reason: str
    wavenumber: Floats
    profile_spectral_density: Floats
    background: Floats


def track_marks(groove: Groove, *, inner_share: float = 0.6, lane_points: int = 8) -> TrackMarks:
    """Return the spacing of marks along the floor of a groove.

    Parameters
    ----------
    groove : Groove
    inner_share : float
        Share of the width that is looked at, about the middle.
    lane_points : int
        Points across the track that are averaged to one lane.

    Returns
    -------
    TrackMarks

    Raises
    ------
    InvalidInput
        If a share is out of range, or too little of the floor was measured.

    Notes
    -----
    Heights lose the mean section, each lane its mean and trend; missing points count as zero; the window is Hann's. The
    spectrum is the mean over lanes, so that marks need not stand abreast. A mark stands out where its power is 8 times
    that of the power law through the spectrum beside it. Spacings from 2.5 points to half the track are seen.
    `sonolube.metrics.dot_spacing` and `indentation_spacing` say what to expect: 3.95 um for 22 kHz at 87 mm/s, which
    needs pixels below 1.6 um, and 0.87 mm for stick-slip every 10 ms.

    References
    ----------
    .. [1] D 2.4 and figures 2.25 and 2.26.
    .. [2] D. C. Rife and R. R. Boorstyn, IEEE Trans. Inf. Theory 20, 591 (1974). doi:10.1109/TIT.1974.1055282
    """
    require_within(0.05, 1.0, inner_share=inner_share)
    lanes, step = _lanes(groove, inner_share, lane_points)
    length = lanes.shape[1] * step
    size = fft.next_fast_len(_FINER * lanes.shape[1])
    window = np.hanning(lanes.shape[1] + 2)[1:-1]
    power = np.mean(np.abs(fft.rfft(lanes * window, size, axis=1)) ** 2, axis=0) * step / np.sum(window**2)
    k = fft.rfftfreq(size, step)
    seen = (k >= _LEAST_PERIODS / length) & (k <= 1 / (_POINTS_PER_PERIOD * step))
    k, power = k[seen], power[seen]
    if k.size < 3 * _FINER or not np.any(power > 0):
        raise InvalidInput(f"a track of {length:.2g} m at {step:.2g} m a point is too short or too flat for a spectrum")
    summits = 1 + np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:]))
    foremost = summits[np.argsort(-(power * k)[summits])][:_CANDIDATES]
    backgrounds = [_power_law(k, power, np.abs(k - k[summit]) > _LOBE / length) for summit in foremost]
    prominences = [float((power / level)[summit]) for summit, level in zip(foremost, backgrounds, strict=True)]
    best = int(np.argmax(prominences)) if foremost.size else 0
    top, prominence = (int(foremost[best]), prominences[best]) if foremost.size else (0, 0.0)
    background = backgrounds[best] if foremost.size else _power_law(k, power, np.ones(k.size, dtype=np.bool_))
    found = prominence >= _STANDS_OUT
    spacing = 1 / _summit(k, power, top) if found else None
    return TrackMarks(
        dot_spacing=spacing,
        dot_spacing_uncertainty=None if spacing is None else _uncertainty(spacing, length, prominence),
        prominence=prominence,
        reason="" if found else f"no wave along the track has more than {prominence:.1f} times the background's power",
        wavenumber=k,
        profile_spectral_density=power,
        background=background,
    )


def _lanes(groove: Groove, inner_share: float, lane_points: int) -> tuple[Floats, float]:
    # less the section at each pixel's own distance: on slopes, the nearest pixel of a slanting track would step
    across, _ = groove.track.curvilinear_coordinates(groove.levelled)
    flat = groove.levelled.with_height(groove.levelled.height - groove.section.at(across))
    reach = inner_share * groove.groove_width / 2
    sections = cross_sections(flat, groove.track, reach=(-reach, reach))
    height = sections.height.T  # (points, sections)
    height = height[: max(1, len(height) // lane_points) * lane_points]
    measured = np.isfinite(height)
    shape = (-1, min(lane_points, len(height)), height.shape[1])
    count = measured.reshape(shape).sum(axis=1)
    lanes = np.where(measured, height, 0.0).reshape(shape).sum(axis=1) / np.maximum(count, 1)
    whole = np.flatnonzero(np.mean(count > 0, axis=0) > _LEAST_SEEN)
    if whole.size < 2:
        raise InvalidInput("too little of the groove's floor was measured for a spectrum along it")
    lanes, count = lanes[:, whole[0] : whole[-1] + 1], count[:, whole[0] : whole[-1] + 1]
    t = np.linspace(-1, 1, lanes.shape[1])
    t, shown = np.where(count > 0, t, 0.0), count > 0
    level = lanes.sum(axis=1, keepdims=True) / np.maximum(shown.sum(axis=1, keepdims=True), 1)
    lanes = np.where(shown, lanes - level, 0.0)
    trend = np.sum(lanes * t, axis=1, keepdims=True) / np.maximum(np.sum(t * t, axis=1, keepdims=True), 1e-12)
    return lanes - trend * t, float(sections.along[1] - sections.along[0])


def _power_law(k: Floats, power: Floats, beside: NDArray[np.bool_]) -> Floats:
    x, y = np.log(k[beside]), np.log(np.maximum(power[beside], power.max() * 1e-12))
    slope, level = np.polyfit(x, y, 1, w=1 / np.sqrt(k[beside]))  # as many to an octave anywhere
    return np.asarray(np.exp(slope * np.log(k) + level))


def _summit(k: Floats, power: Floats, top: int) -> float:
    left, middle, right = power[top - 1 : top + 2]
    return float(k[top] + (k[1] - k[0]) * (left - right) / (2 * (left - 2 * middle + right)))


def _uncertainty(spacing: float, length: float, prominence: float) -> float:
    return spacing**2 * math.sqrt(6 / prominence) / (2 * math.pi * length)  # Cramer-Rao bound of one lane
