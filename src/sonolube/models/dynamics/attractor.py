"""Classification of attractors as periodic, subharmonic, beating or chaotic; Lyapunov exponents and beats."""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.gap_laws.closed_form import CONTACT_LOSS_THRESHOLD, GapLaw
from sonolube.models.dynamics.motions import ContactSamples, Envelope, State, Trajectories
from sonolube.models.dynamics.structure import Structure
from sonolube.models.dynamics.transient import NO_RAMP, march
from sonolube.models.dynamics.waveform import Waveform

_HIGHEST_ORDER = 8  # of subharmonics
_REPETITION = 1e-3  # range of strobed samples, over the peak-to-peak displacement, below which a motion repeats
_SETTLING = 0.7  # deviation of the later strobed samples over that of the earlier below which a motion is settling
_CHAOTIC = 0.02  # Lyapunov exponent per period above which a motion is chaotic
_EXPONENT_ERROR = 0.005  # of the Lyapunov exponent
_ROUND = 16  # periods between renormalisations of the disturbance
_MAX_ROUNDS = 64
_DISTURBANCE = 1e-6  # over the motion itself
_RECORDED = 32  # periods in which the time without contact is measured
_SUBDIVISIONS = 8  # of a step, for the time without contact


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Attractors:
    """Attractors of the points of a batch.

    Parameters
    ----------
    kind : ndarray of str, shape (...)
        "periodic", "subharmonic", "beating" (quasi-periodic), "chaotic", "settling" for a transient that still decays,
        or "diverged".
    order : ndarray of int, shape (...)
        Number of drive periods after which the motion repeats; 0 where it does not.
    lyapunov_exponent : ndarray, shape (...)
        Largest Lyapunov exponent per period of the drive, negative for a stable motion, to within 0.005; NaN where
        diverged.
    contact_loss_fraction : ndarray, shape (...)
        Fraction of the time in which the contact force is below 0.01 F_N. []
    beat_frequency : ndarray, shape (...)
        Frequency of the slow motion in samples once per period, zero where there is none. [Hz]
    beat_amplitude : ndarray, shape (...)
        Half the peak-to-peak displacement of the slow motion. [m]
    description : ndarray of str, shape (...)
        Summary of the above in a sentence, with a remedy where one is needed.
    final_state : State
        State at the end, from which marching can continue.
    """

    kind: NDArray[np.str_]
    order: NDArray[np.intp]
    lyapunov_exponent: Floats
    contact_loss_fraction: Floats
    beat_frequency: Floats
    beat_amplitude: Floats
    description: NDArray[np.str_]
    final_state: State


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Beat:
    """Strongest slow oscillation in equally spaced samples.

    Parameters
    ----------
    beat_frequency : ndarray, shape (...)
        Frequency of the oscillation, zero for constant samples. [Hz]
    beat_amplitude : ndarray, shape (...)
        Half the peak-to-peak displacement over the later half of the samples. [m]
    """

    beat_frequency: Floats
    beat_amplitude: Floats


def classify_attractor(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: ArrayLike,
    frequency: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    voltage_offset: ArrayLike = 0.0,
    initial_state: State,
    waveform: Waveform | None = None,
    periods: int = 256,
    steps_per_period: int = 16,
    workers: int = 1,
) -> Attractors:
    r"""Classify the attractors that trajectories have reached, by marching on from their final states.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : array_like
        Dead load. [N]
    frequency : array_like, broadcast against `normal_load`
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : array_like, broadcast against `normal_load`
        Peak-to-peak drive voltage. [V]
    voltage_offset : array_like, broadcast against `normal_load`
        Mean drive voltage. [V]
    initial_state : State
        Final state of a march beyond the transient.
    waveform : Waveform or None
        Waveform of the voltage; a sine if None.
    periods : int
        Periods to observe, a multiple of 16, at least 32; a beat slower than all of them together is not resolved.
    steps_per_period, workers
        As in `march`.

    Returns
    -------
    Attractors

    Raises
    ------
    InvalidInput
        As `march`, or if the periods are not a multiple of 16 or too few.

    See Also
    --------
    march, march_until_settled

    Notes
    -----
    The motion repeats after p periods if the Poincare samples of displacement and velocity, taken once per period,
    return to within a thousandth of the peak-to-peak displacement at every p-th sample. The largest Lyapunov exponent
    is estimated from two trajectories with an initial distance :math:`\delta_0` of a millionth, renormalised every 16
    periods, 64 times at most, of which the later half is averaged [1]_:

    .. math:: \lambda = \frac{1}{16}\left\langle \ln\frac{\delta}{\delta_0} \right\rangle

    References
    ----------
    .. [1] G. Benettin, L. Galgani and J.-M. Strelcyn, Phys. Rev. A 14, 2338 (1976). doi:10.1103/PhysRevA.14.2338
    """
    if periods < 2 * _ROUND or periods % _ROUND:
        raise InvalidInput(f"periods must be a multiple of {_ROUND}, at least {2 * _ROUND}, got {periods!r}")

    load, f, swing, offset = np.broadcast_arrays(
        require_positive(normal_load=normal_load),
        require_positive(frequency=frequency),
        require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak),
        require_finite(voltage_offset=voltage_offset),
    )
    run = partial(
        march,
        structure,
        gap_law,
        frequency=f,
        voltage_peak_to_peak=swing,
        voltage_offset=offset,
        waveform=waveform,
        steps_per_period=steps_per_period,
        ramp=NO_RAMP,
        workers=workers,
    )
    observe = partial(run, recorded_periods=_RECORDED, strobed_periods=periods)
    observed = observe(normal_load=load, periods=periods, initial_state=initial_state)

    def advance_pair(states: State) -> State:
        return run(normal_load=np.stack([load, load]), periods=_ROUND, initial_state=states).final_state

    diverged = observed.status == "diverged"
    order, settling = _repetition(observed, f)
    stiffness = gap_law.stiffness(np.zeros_like(load), load)
    rounds = min(periods // _ROUND, _MAX_ROUNDS)
    exponent = _lyapunov_exponent(structure, advance_pair, observed.final_state, f, stiffness, rounds)
    slow = beat(displacement=observed.strobed.displacement, interval=1 / f)
    kind = np.select(
        [diverged, order == 1, order > 1, exponent > _CHAOTIC, settling],
        ["diverged", "periodic", "subharmonic", "chaotic", "settling"],
        "beating",
    )
    loss = _contact_loss_fraction(gap_law, observed.last_periods, load, f * steps_per_period)
    found = Attractors(
        kind=kind,
        order=np.where(diverged, 0, order),
        lyapunov_exponent=np.where(diverged, np.nan, exponent),
        contact_loss_fraction=np.where(diverged, np.nan, loss),
        beat_frequency=slow.beat_frequency,
        beat_amplitude=slow.beat_amplitude,
        description=np.empty(kind.shape, dtype=np.str_),
        final_state=observed.final_state,
    )
    return replace(found, description=_descriptions(found, observed.advice))


def settling_time(envelope: Envelope, *, band: float = 0.02) -> Floats:
    """Settling time: when the first-harmonic amplitude enters a band about its last value for good. [s]

    Parameters
    ----------
    envelope : Envelope
    band : float
        Half-width of the band over the last value.

    Returns
    -------
    ndarray, shape of the points
        Resolved to the envelope's windows; the end of the last window where the amplitude never settles.

    Raises
    ------
    InvalidInput
        If the band does not lie between 0 and 1.
    """
    require_within(0.0, 1.0, band=band)
    amplitude = envelope.first_harmonic_amplitude
    outside = ~(np.abs(amplitude - amplitude[..., -1:]) <= band * amplitude[..., -1:])
    first_inside = amplitude.shape[-1] - np.argmax(outside[..., ::-1], axis=-1)
    first_inside = np.where(outside.any(axis=-1), np.minimum(first_inside, amplitude.shape[-1] - 1), 0)
    return np.take_along_axis(envelope.time, first_inside[..., np.newaxis], axis=-1)[..., 0]


def beat(*, displacement: ArrayLike, interval: ArrayLike) -> Beat:
    """Frequency and amplitude of the strongest slow oscillation in samples, by linear prediction.

    Parameters
    ----------
    displacement : array_like, shape (..., n)
        Samples once per period, or means over periods, such as those of an envelope. [m]
    interval : array_like, shape (...)
        Time between samples, in s.

    Returns
    -------
    Beat

    Raises
    ------
    InvalidInput
        If there are fewer than 8 samples.

    Notes
    -----
    The strongest line of the spectrum is the initial estimate; the frequency is that of the damped oscillation that
    best predicts each sample from two previous ones, spaced by a quarter of a beat [1]_.

    References
    ----------
    .. [1] S. L. Marple, Digital Spectral Analysis, Prentice-Hall (1987), on linear prediction.
    """
    samples = np.asarray(displacement, dtype=np.float64)
    if samples.ndim == 0 or samples.shape[-1] < 8:
        raise InvalidInput(f"displacement must have at least 8 samples, got shape {samples.shape}")
    rows = samples.reshape(-1, samples.shape[-1])
    found = np.array([_cycles_per_sample(row) for row in rows]).reshape(samples.shape[:-1])
    later = samples[..., samples.shape[-1] // 2 :]
    return Beat(beat_frequency=found / np.asarray(interval), beat_amplitude=np.ptp(later, axis=-1) / 2)


def _cycles_per_sample(samples: Floats) -> float:
    """Frequency of the strongest slow oscillation in one row of samples, in cycles per sample."""
    centred = samples - samples.mean()
    if not np.all(np.isfinite(centred)) or np.ptp(centred) <= 1e-9 * np.abs(samples).max(initial=0.0):
        return 0.0
    spectrum = np.abs(np.fft.rfft(centred * np.hanning(centred.size), 8 * centred.size))
    guess = max(int(np.argmax(spectrum)), 8) / (8 * centred.size)
    lag = min(max(round(0.25 / guess), 1), centred.size // 4)
    newest, middle, oldest = centred[2 * lag :], centred[lag:-lag], centred[: -2 * lag]
    (twice, square, _), *_ = np.linalg.lstsq(np.column_stack([middle, oldest, np.ones(middle.size)]), newest)
    cosine = twice / (2 * math.sqrt(-square)) if square < 0 else math.inf
    return math.acos(cosine) / (2 * math.pi * lag) if abs(cosine) < 1 else float(guess)


def _repetition(observed: Trajectories, f: Floats) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Number of periods after which each motion repeats, 0 for never, and whether its samples converge."""
    strobed, omega = observed.strobed, 2 * np.pi * f[..., np.newaxis]
    samples = np.stack([strobed.displacement, strobed.velocity / omega], axis=-1)
    scale = np.ptp(observed.last_periods.displacement, axis=-1)
    order = np.zeros(f.shape, dtype=np.intp)
    for p in range(_HIGHEST_ORDER, 0, -1):
        extent = np.max([np.ptp(samples[..., first::p, :], axis=-2).max(axis=-1) for first in range(p)], axis=0)
        order = np.where(extent <= _REPETITION * scale, p, order)
    half = samples.shape[-2] // 2
    early, late = (np.std(part, axis=-2).max(axis=-1) for part in (samples[..., :half, :], samples[..., half:, :]))
    return order, np.asarray(late < _SETTLING * early)


def _lyapunov_exponent(
    structure: Structure,
    advance_pair: Callable[[State], State],
    start: State,
    f: Floats,
    stiffness: Floats,
    rounds: int,
) -> Floats:
    """Largest Lyapunov exponent per period, from the growth of a small disturbance in the later rounds.

    The norm of a disturbance is the root of its energy, with the contact linearised, which does not oscillate in
    undamped free motion.
    """
    omega, n = 2 * np.pi * f, structure.coordinates

    def norm(state: State) -> Floats:
        kinetic = np.einsum("...i,ij,...j->...", state.velocities, structure.mass_matrix, state.velocities)
        elastic = np.einsum("...i,ij,...j->...", state.coordinates, structure.stiffness_matrix, state.coordinates)
        return np.asarray(np.sqrt(kinetic + elastic + stiffness * (state.coordinates @ structure.contact_vector) ** 2))

    initial = _DISTURBANCE * np.maximum(norm(start), 1e-300)[..., np.newaxis]
    direction = np.random.default_rng(0).normal(size=(2, n))  # arbitrary: it turns into the fastest growing one
    velocities = np.broadcast_to(direction[1], (*f.shape, n))
    disturbance = State(coordinates=direction[0] / omega[..., np.newaxis], velocities=velocities)
    growth = []
    for _ in range(rounds):
        scale = initial / norm(disturbance)[..., np.newaxis]
        ends = advance_pair(
            State(
                coordinates=np.stack([start.coordinates, start.coordinates + scale * disturbance.coordinates]),
                velocities=np.stack([start.velocities, start.velocities + scale * disturbance.velocities]),
            )
        )
        x, v = ends.coordinates, ends.velocities
        start = State(coordinates=x[0], velocities=v[0])
        disturbance = State(coordinates=x[1] - x[0], velocities=v[1] - v[0])
        growth.append(np.log(np.maximum(norm(disturbance), 1e-300) / initial[..., 0]))
    return np.asarray(np.mean(growth[rounds // 2 :], axis=0) / _ROUND)


def _contact_loss_fraction(gap_law: GapLaw, motion: ContactSamples, load: Floats, rate: Floats) -> Floats:
    """Fraction of the time without contact, between steps by cubic Hermite interpolation."""
    s = (np.arange(_SUBDIVISIONS) / _SUBDIVISIONS)[:, np.newaxis]
    x = motion.displacement[..., np.newaxis, :]
    v = motion.velocity[..., np.newaxis, :] / rate[..., np.newaxis, np.newaxis]
    before, after, start, end = x[..., :-1], x[..., 1:], v[..., :-1], v[..., 1:]
    rise = after - before
    between = before + s * (start + s * (3 * rise - 2 * start - end + s * (-2 * rise + start + end)))
    weight = load[..., np.newaxis, np.newaxis]
    return np.asarray(np.mean(gap_law.force(between, weight) < CONTACT_LOSS_THRESHOLD * weight, axis=(-2, -1)))


def _descriptions(found: Attractors, advice: NDArray[np.str_]) -> NDArray[np.str_]:
    """Description of every attractor."""
    columns = [getattr(found, each.name) for each in fields(found)[:6]]  # kind to beat_amplitude
    lists = (values.ravel().tolist() for values in (*columns, advice))
    texts = [_description(*values) for values in zip(*lists, strict=True)]
    return np.array(texts).reshape(found.kind.shape)


def _description(
    kind: str, order: int, exponent: float, loss: float, frequency: float, amplitude: float, advice: str
) -> str:
    """Description of one attractor: kind, stability, beat, time without contact and advice."""
    slow = f"{frequency:.4g} Hz with an amplitude of {amplitude * 1e6:.3g} um"
    decays = exponent < -_EXPONENT_ERROR
    texts = {
        "periodic": "periodic" + (f"; a disturbance decays by exp({exponent:.3g}) a period" if decays else ""),
        "subharmonic": f"subharmonic, repeats after {order} periods",
        "beating": f"beats at {slow}",
        "chaotic": f"chaotic; a disturbance grows by exp({exponent:.3g}) a period",
        "settling": f"still settling, at {slow}; march on for longer",
        "diverged": "diverged",
    }
    no_contact = f"without contact for {loss:.2%} of the time" if loss > 0 else ""
    return "; ".join(filter(None, (texts[kind], no_contact, advice)))
