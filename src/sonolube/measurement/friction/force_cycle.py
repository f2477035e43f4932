"""Records of stick-slip in a friction force, and the steady cycle near the natural frequency of the holder.

The estimate of a part follows from those of its stretches; a cycle is nearly a sine.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.special import gammaln

from sonolube.checks import Floats
from sonolube.measurement.friction.wobble import harmonic_columns
from sonolube.measurement.statistics.autocorrelation import statistical_inefficiency


@dataclass(frozen=True, kw_only=True, slots=True)
class StickSlipBurst:
    """Time in which slips recur without interruption.

    Parameters
    ----------
    start_time : float
        Beginning of the stick phase before the first slip. [s]
    end_time : float
        Last slip. [s]
    force_drops : int
        Number of slips.
    """

    start_time: float
    end_time: float
    force_drops: int


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StickSlipEstimate:
    """Stick-slip in a friction force: whether, how often, how much the force falls, and when.

    Parameters
    ----------
    detected : bool
        Whether sudden falls of the force recur more strongly than noise explains.
    resolved : bool
        Whether the sampling rate shows it: False where a line with fewer than six samples a period dominates the force,
        so that stick-slip is neither detected nor excluded.
    reason : str
        Why stick-slip was not detected, and up to which frequency it was sought; empty where it was.
    stick_slip_frequency : float
        Slips per time within the bursts; the frequency of the spectral peak where not detected. [Hz]
    spectral_frequency : float
        Frequency of the highest peak of the spectrum, in Hz.
    stick_slip_amplitude : float
        Mean fall of the force in a slip; 0 where not detected. [N]
    stick_slip_amplitude_uncertainty : float
        Its standard error. [N]
    stick_slip_amplitude_interval : tuple of two float
        Its 95 % interval. [N]
    force_drops : int
        Number of slips found.
    stick_slip_fraction : float
        Share of the time in which slips recur. []
    bursts : tuple of StickSlipBurst
        When they do.
    slip_time : ndarray, shape (force_drops,)
        Time of each slip, in s.
    """

    detected: bool = True
    resolved: bool = True
    reason: str = ""
    stick_slip_frequency: float
    spectral_frequency: float
    stick_slip_amplitude: float = 0.0
    stick_slip_amplitude_uncertainty: float = 0.0
    stick_slip_amplitude_interval: tuple[float, float] = (0.0, 0.0)
    force_drops: int = 0
    stick_slip_fraction: float = 0.0
    bursts: tuple[StickSlipBurst, ...] = ()
    slip_time: Floats = field(default_factory=lambda: np.empty(0))


def not_detected(reason: str, spectral_frequency: float, *, resolved: bool = True) -> StickSlipEstimate:
    """Estimate for a signal without recurring falls, with the reason and the frequency of its spectrum."""
    return StickSlipEstimate(
        detected=False,
        resolved=resolved,
        reason=reason,
        stick_slip_frequency=spectral_frequency,
        spectral_frequency=spectral_frequency,
    )


def combined(estimates: Sequence[StickSlipEstimate], spans: Sequence[float]) -> StickSlipEstimate:
    """Estimate of a part by those of its stretches."""
    if not estimates:
        return not_detected("too few samples follow one another without a gap", 0.0)
    longest = estimates[int(np.argmax(spans))]
    found = [one for one in estimates if one.detected]
    if len(estimates) == 1 or not found:
        return next((one for one in estimates if not one.resolved), longest)
    drops = np.array([one.force_drops for one in found])
    weights = drops / drops.sum()
    ends = weights @ np.array([one.stick_slip_amplitude_interval for one in found])
    filled = sum(one.stick_slip_fraction * span for one, span in zip(estimates, spans, strict=True))
    return StickSlipEstimate(
        stick_slip_frequency=float(weights @ [one.stick_slip_frequency for one in found]),
        spectral_frequency=longest.spectral_frequency,
        stick_slip_amplitude=float(weights @ [one.stick_slip_amplitude for one in found]),
        stick_slip_amplitude_uncertainty=float(
            np.sqrt(weights**2 @ np.square([one.stick_slip_amplitude_uncertainty for one in found]))
        ),
        stick_slip_amplitude_interval=(float(ends[0]), float(ends[1])),
        force_drops=int(drops.sum()),
        stick_slip_fraction=filled / sum(spans),
        bursts=tuple(burst for one in found for burst in one.bursts),
        slip_time=np.concatenate([one.slip_time for one in found]),
    )


MIN_SAMPLES_OF_CYCLE = 6
"""Samples of a cycle, below which its shape is not resolved."""

CYCLE_SCORE = 12.0
"""Logarithm of the likelihood ratio of a steady amplitude over a resonance in noise, from which it is a cycle."""

SHARE_OF_VARIANCE = 0.5
"""Of a section or a signal, from which a cycle or a line of the spectrum dominates it."""

_CYCLES_OF_SECTION = 8
_MIN_SECTIONS = 6
_MAX_HARMONICS = 12
_HARMONICS_PER_SAMPLE = 0.475  # of a cycle: the highest harmonic stays below half the sampling rate
_STEADIEST = 200.0  # greatest shape of the gamma distribution of the power
_SLOWEST_SINE = 30.0  # Hz, below which a cycle whose fall takes as long as its rise is wobble of the disc
_MAINS = (50.0, 60.0)  # Hz
_MAINS_WIDTH = 0.3  # Hz, about multiples of the mains
_SUDDEN = 1 / 3  # of the period, up to which a fall is that of a slip
_LONGEST_FALL = 0.6  # of the period, above which the rises are the sudden ones
_VARYING = 0.3  # standard deviation of the power in bursts over its mean, from which it is no steady cycle
_REMAINING = 0.1  # of the mean power in bursts, which is not left between them
_PHASES = 256  # at which the shape of a cycle is computed


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ForceCycle:
    """Cycle that recurs with a steady amplitude.

    Parameters
    ----------
    frequency : float
        Of the cycle. [Hz]
    fall_share : float
        Duration of the fall from the highest to the lowest force, over the period.
    falls : ndarray, shape (sections,)
        Fall of the force in sections of eight cycles, without the first and the last of a burst, in N.
    truncation : float
        Share of the fall in the highest harmonic that the sampling rate resolves, in N.
    slips : ndarray of int
        Indices of the samples after the middle of each fall.
    sections : ndarray, shape (sections, 2)
        First and last sample of each section that the cycle fills.
    """

    frequency: float
    fall_share: float
    falls: Floats
    truncation: float
    slips: np.ndarray
    sections: np.ndarray


def find_cycle(signal: Floats, *, sample_interval: float, frequency: float) -> tuple[ForceCycle | None, str]:
    r"""Cycle of steady amplitude near a frequency, or the reason for which there is none.

    Parameters
    ----------
    signal : ndarray, shape (samples,)
        Evenly spaced, of zero mean, in N.
    sample_interval : float
        Time between samples. [s]
    frequency : float
        Of the highest peak of the spectrum. [Hz]

    Returns
    -------
    ForceCycle or None
    str
        Empty where a cycle was found, or where nothing hints at one.

    Notes
    -----
    Sections of eight cycles are fitted by the fundamental and its harmonics below half the sampling rate. A resonance
    in Gaussian noise has an exponentially distributed power x of the fundamental, whatever the length of the sections;
    a self-excited cycle has a steady one. With the shape a of a gamma distribution of x by maximum likelihood, and K/g
    independent sections of K,

    .. math:: S = \frac{K}{g}\Bigl[a \ln a - a - \ln\Gamma(a) + 1 + (a - 1)\,(\overline{\ln x} - \ln\bar x)\Bigr]

    is the logarithm of the likelihood ratio, which grows with the length of the recording. The cycle is one where S is
    at least 12 and the fit holds half of the variance in half of the sections. In bursts it is one where, of the
    sections that it fills with their neighbours, the logarithm of the likelihood ratio of a normal distribution over an
    exponential one from the least power on,

    .. math:: S_b = \frac{K}{g}\Bigl[\ln\frac{\bar x - \min x}{s_x} + \tfrac12 - \tfrac12 \ln 2\pi\Bigr] ,

    is at least 12, the standard deviation is below 0.3 of the mean, and at most a tenth of the power is left between.
    It is stick-slip where its fall takes less than a third of the period; and, from 30 Hz on, where it takes up to 0.6
    and the frequency is no multiple of that of the mains, which have no bursts: a mass on a spring with a slip as long
    as the stick swings nearly like a sine.
    """
    per_cycle = 1 / (frequency * sample_interval) if frequency > 0 else np.inf
    size = round(_CYCLES_OF_SECTION * min(per_cycle, float(signal.size)))
    count = signal.size // size
    if per_cycle < MIN_SAMPLES_OF_CYCLE or count < _MIN_SECTIONS:
        return None, ""
    harmonics = int(min(_MAX_HARMONICS, _HARMONICS_PER_SAMPLE * per_cycle))
    parts = signal[: count * size].reshape(count, size)
    coefficients, filled = _fits(parts, per_cycle, harmonics)
    power = np.hypot(coefficients[:, 0], coefficients[:, harmonics]) ** 2
    whole = filled
    if np.mean(filled) < SHARE_OF_VARIANCE or _steadiness(power) < CYCLE_SCORE:
        whole = _inner(filled)
        if not _is_steady_in_bursts(power, whole, _inner(~filled)):
            return None, ""
    waves = harmonic_columns(revolutions=np.arange(_PHASES) / _PHASES, harmonics=harmonics).T
    falls = np.ptp((coefficients @ waves)[whole], axis=1)
    mean_wave, shifts = _aligned(coefficients, harmonics)
    top = int(np.argmax(mean_wave))
    fall_share = (int(np.argmin(mean_wave)) - top) % _PHASES / _PHASES
    if fall_share > _LONGEST_FALL:
        return None, f"the force rises faster than it falls in the cycle of {frequency:.3g} Hz"
    duration = signal.size * sample_interval
    if fall_share > _SUDDEN and (reason := _other_origin(frequency, duration, has_bursts=whole is not filled)):
        return None, reason
    fewer = coefficients.copy()
    fewer[:, [harmonics - 1, 2 * harmonics - 1]] = 0.0
    lower = np.ptp(fewer[whole] @ waves, axis=1)
    starts = np.flatnonzero(filled) * size
    middles = (top / _PHASES + fall_share / 2 - shifts[filled, None] + np.arange(_CYCLES_OF_SECTION)) * per_cycle
    slips = np.ceil(starts[:, None] + middles % (_CYCLES_OF_SECTION * per_cycle)).astype(int).ravel()
    return (
        ForceCycle(
            frequency=frequency,
            fall_share=fall_share,
            falls=falls,
            truncation=abs(float(np.mean(falls - lower))) if harmonics > 1 else 0.0,
            slips=np.unique(slips[slips < signal.size]),
            sections=np.column_stack([starts, starts + size - 1]),
        ),
        "",
    )


def _other_origin(frequency: float, duration: float, *, has_bursts: bool) -> str:
    """Reason for which a cycle like a sine is not stick-slip; empty where it is."""
    if frequency < _SLOWEST_SINE:
        return f"the cycle of {frequency:.3g} Hz falls as slowly as it rises, as wobble does"
    if has_bursts:
        return ""
    width = max(_MAINS_WIDTH, 0.5 / duration)
    mains = [mains for mains in _MAINS if abs(frequency - mains * round(frequency / mains)) < width]
    return f"the cycle of {frequency:.4g} Hz cannot be told from hum of the mains" if mains else ""


def _fits(parts: Floats, per_cycle: float, harmonics: int) -> tuple[Floats, np.ndarray]:
    """Coefficients of the harmonics in each section, and whether they hold half of its variance."""
    cycles = np.arange(parts.shape[1]) / per_cycle
    waves = harmonic_columns(revolutions=cycles, harmonics=harmonics)
    design = np.column_stack([waves, np.ones(cycles.size), cycles - cycles.mean()])
    coefficients = parts @ np.linalg.pinv(design).T
    residual = np.var(parts - coefficients @ design.T, axis=1)
    explained = np.var(coefficients[:, : 2 * harmonics] @ design[:, : 2 * harmonics].T, axis=1)
    return coefficients[:, : 2 * harmonics], explained > SHARE_OF_VARIANCE * (explained + residual)


def _steadiness(power: Floats) -> float:
    """Logarithm of the likelihood ratio of a gamma over an exponential distribution of powers."""
    if not power.min() > 0:
        return 0.0
    deficit = max(float(np.log(power.mean()) - np.log(power).mean()), 1e-6)
    shape = (3 - deficit + np.sqrt((deficit - 3) ** 2 + 24 * deficit)) / (12 * deficit)
    a = float(np.clip(shape, 1.0, _STEADIEST))
    gain = a * np.log(a) - a - float(gammaln(a)) + 1 - (a - 1) * deficit
    return power.size / statistical_inefficiency(power) * float(gain)


def _is_steady_in_bursts(power: Floats, whole: np.ndarray, empty: np.ndarray) -> bool:
    """Whether the powers of whole sections are steady, no resonance above a threshold, and vanish in empty ones."""
    own = power[whole]
    if own.size < _MIN_SECTIONS or not empty.any():
        return False
    deviation, mean = float(np.std(own)), float(np.mean(own))
    if deviation > _VARYING * mean or np.mean(power[empty]) > _REMAINING * mean:
        return False
    gain = np.log((mean - own.min()) / deviation) + (1 - np.log(2 * np.pi)) / 2 if deviation else np.inf
    return bool(own.size / statistical_inefficiency(own) * gain >= CYCLE_SCORE)


def _inner(chosen: np.ndarray) -> np.ndarray:
    """Which sections are chosen with both neighbours."""
    return np.asarray(chosen & np.append(chosen[1:], True) & np.insert(chosen[:-1], 0, True))


def _aligned(coefficients: Floats, harmonics: int) -> tuple[Floats, Floats]:
    """Mean shape of the cycle, its fundamental at phase zero in every section, and the shifts in cycles that do it."""
    complex_ones = coefficients[:, :harmonics] - 1j * coefficients[:, harmonics:]
    shifts = np.angle(complex_ones[:, 0]) / (2 * np.pi)
    orders = np.arange(1, harmonics + 1)
    turned = np.mean(complex_ones * np.exp(-2j * np.pi * shifts[:, None] * orders), axis=0)
    phases = np.arange(_PHASES) / _PHASES
    return np.real(np.exp(2j * np.pi * phases[:, None] * orders) @ turned), shifts
