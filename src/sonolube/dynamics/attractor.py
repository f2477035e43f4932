"""What a trajectory settles to: a period, several, a beat, chaos, or nothing; and how long it takes."""

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.dynamics.backend import Backend
from sonolube.dynamics.gap_law import LOST, GapLaw
from sonolube.dynamics.structure import Structure
from sonolube.dynamics.time_marching.records import ContactMotion, Envelope, State, Trajectories
from sonolube.dynamics.transient import AT_ONCE, march
from sonolube.dynamics.waveform import Waveform
from sonolube.errors import GpuUnused, InvalidInput

_HIGHEST_ORDER = 8  # subharmonics looked for
_SAME = 1e-3  # spread of strobed instants, over the peak-to-peak displacement, that counts as repetition
_SHRINKS = 0.7  # spread in the later half of the strobed instants, over that in the earlier, that counts as settling
_CHAOTIC = 0.02  # growth of a disturbance a period, as an exponent
_SURE = 0.005  # exponent that a disturbance of a stable motion can seem to have
_ROUND = 16  # periods for which a disturbance grows before it is made small again
_MOST_ROUNDS = 64  # in which a disturbance is watched
_DISTURBANCE = 1e-6  # over the motion itself
_RECORDED = 32  # periods in which a loss of contact is looked for
_FINER = 8  # instants to a step in which its loss is looked for


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Attractors:
    """What each point of a batch settles to.

    Parameters
    ----------
    kind : ndarray of str, shape (...)
        "periodic", "subharmonic", "beating", "chaotic", "settling" where it is still on its way, or "diverged".
    order : ndarray of int, shape (...)
        Periods of the drive after which the motion repeats; 0 where it does not.
    exponent : ndarray, shape (...)
        Growth exponent of a disturbance per period of the drive, negative where it dies out, to within 0.005; not a
        number where diverged.
    contact_loss_fraction : ndarray, shape (...)
        Share of the time in which the contact force is below 0.01 F_N. []
    beat_frequency : ndarray, shape (...)
        Frequency of the slow motion of the contact seen once a period, zero where there is none. [Hz]
    beat_amplitude : ndarray, shape (...)
        Half its peak-to-peak displacement. [m]
    description : ndarray of str, shape (...)
        All of this in a sentence, with advice where something is wrong.
    state : State
        The state at the end, from which to march on.
    """

    kind: NDArray[np.str_]
    order: NDArray[np.intp]
    exponent: Floats
    contact_loss_fraction: Floats
    beat_frequency: Floats
    beat_amplitude: Floats
    description: NDArray[np.str_]
    state: State


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Beat:
    """The strongest slow motion in samples.

    Parameters
    ----------
    beat_frequency : ndarray, shape (...)
        Its frequency, zero where nothing moves. [Hz]
    beat_amplitude : ndarray, shape (...)
        Half the peak-to-peak displacement over the later half of the samples. [m]
    """

    beat_frequency: Floats
    beat_amplitude: Floats


def describe(
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
    backend: Backend = "cpu",
) -> Attractors:
    """March on from where a trajectory ended, and say what it settled to.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : array_like
        Dead load. [N]
    frequency : array_like, broadcast against `normal_load`
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : array_like, broadcast against `normal_load`
        Drive voltage, peak to peak. [V]
    voltage_offset : array_like, broadcast against `normal_load`
        Its mean. [V]
    initial_state : State
        Where to start: the final state of a march that passed the transient.
    waveform : Waveform or None
        Shape of the voltage; a sine if None.
    periods : int
        Periods to watch, a multiple of 16, at least 32; a beat slower than all of them together is not seen.
    steps_per_period : int
        As for `march`.
    workers : int
        As for `march`.
    backend : {"cpu", "gpu"}
        As for `march`.

    Returns
    -------
    Attractors

    Raises
    ------
    InvalidInput
        As `march` does, or if the periods are no multiple of 16 or too few.

    Warns
    -----
    GpuUnused
        As `march` does.

    Notes
    -----
    The motion repeats after p periods if displacement and velocity, seen once a period, return to within a thousandth
    of the peak-to-peak displacement at every p-th instant. The exponent is that of two trajectories which start a
    millionth apart and are brought together again every 16 periods, 64 times at most, from the later half of this. [1]_

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
    go = partial(
        march,
        structure,
        gap_law,
        waveform=waveform,
        steps_per_period=steps_per_period,
        ramp=AT_ONCE,
        workers=workers,
        backend=backend,
    )
    watched = go(
        normal_load=load,
        frequency=f,
        voltage_peak_to_peak=swing,
        voltage_offset=offset,
        periods=periods,
        initial_state=initial_state,
        recorded_periods=_RECORDED,
        strobed_periods=periods,
    )

    def both(states: State) -> State:
        return go(
            normal_load=np.stack([load, load]),
            frequency=f,
            voltage_peak_to_peak=swing,
            voltage_offset=offset,
            periods=_ROUND,
            initial_state=states,
        ).final_state

    diverged = watched.status == "diverged"
    repeats = _repeats(watched, f)
    at_rest = gap_law.stiffness(np.zeros_like(load), load)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GpuUnused)  # which was told already
        rounds = min(periods // _ROUND, _MOST_ROUNDS)
        exponent = _exponent(structure, both, watched.final_state, f, at_rest, rounds)
    slow = beat(displacement=watched.strobed.displacement, interval=1 / f)
    kind = np.select(
        [diverged, repeats.order == 1, repeats.order > 1, exponent > _CHAOTIC, repeats.shrinking],
        ["diverged", "periodic", "subharmonic", "chaotic", "settling"],
        "beating",
    )
    open_share = _contact_loss_fraction(gap_law, watched.last_periods, load, f * steps_per_period)
    found = Attractors(
        kind=kind,
        order=np.where(diverged, 0, repeats.order),
        exponent=np.where(diverged, np.nan, exponent),
        contact_loss_fraction=np.where(diverged, np.nan, open_share),
        beat_frequency=slow.beat_frequency,
        beat_amplitude=slow.beat_amplitude,
        description=np.empty(kind.shape, dtype=np.str_),
        state=watched.final_state,
    )
    return replace(found, description=_descriptions(found, watched.advice))


def settling_time(envelope: Envelope, *, band: float = 0.02) -> Floats:
    """Return when the amplitude of the first harmonic comes within a band about its last value, to stay. [s]

    Parameters
    ----------
    envelope : Envelope
    band : float
        Half the width of the band, over the last value.

    Returns
    -------
    ndarray, shape of the points
        To the width of the envelope's windows; the last window's end where it never settles.

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
    """Return frequency and amplitude of the slow motion in equally spaced samples.

    Parameters
    ----------
    displacement : array_like, shape (..., n)
        Once a period, or means over periods, such as those of an envelope. [m]
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
    The strongest line of the spectrum says where to look; the frequency is that of the damped oscillation which best
    foretells each sample from two before it, a quarter of a beat apart. [1]_

    References
    ----------
    .. [1] S. L. Marple, Digital Spectral Analysis, Prentice-Hall (1987), on linear prediction.
    """
    samples = np.asarray(displacement, dtype=np.float64)
    if samples.ndim == 0 or samples.shape[-1] < 8:
        raise InvalidInput(f"displacement must have at least 8 samples, got shape {samples.shape}")
    rows = samples.reshape(-1, samples.shape[-1])
    found = np.array([_turns_a_sample(row) for row in rows]).reshape(samples.shape[:-1])
    later = samples[..., samples.shape[-1] // 2 :]
    return Beat(beat_frequency=found / np.asarray(interval), beat_amplitude=np.ptp(later, axis=-1) / 2)


def _turns_a_sample(samples: Floats) -> float:
    steady = samples - samples.mean()
    if not np.all(np.isfinite(steady)) or np.ptp(steady) <= 1e-9 * np.abs(samples).max(initial=0.0):
        return 0.0
    spectrum = np.abs(np.fft.rfft(steady * np.hanning(steady.size), 8 * steady.size))
    guess = max(int(np.argmax(spectrum)), 8) / (8 * steady.size)
    lag = min(max(round(0.25 / guess), 1), steady.size // 4)
    newest, middle, oldest = steady[2 * lag :], steady[lag:-lag], steady[: -2 * lag]
    (twice, square, _), *_ = np.linalg.lstsq(np.column_stack([middle, oldest, np.ones(middle.size)]), newest)
    cosine = twice / (2 * math.sqrt(-square)) if square < 0 else math.inf
    return math.acos(cosine) / (2 * math.pi * lag) if abs(cosine) < 1 else float(guess)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Repeats:
    order: NDArray[np.intp]
    shrinking: NDArray[np.bool_]


def _repeats(watched: Trajectories, f: Floats) -> _Repeats:
    """Return after how many periods each motion repeats, 0 for never, and whether its instants draw together."""
    seen = np.stack(
        [watched.strobed.displacement, watched.strobed.velocity / (2 * np.pi * f[..., np.newaxis])], axis=-1
    )
    scale = np.ptp(watched.last_periods.displacement, axis=-1)
    order = np.zeros(f.shape, dtype=np.intp)
    for p in range(_HIGHEST_ORDER, 0, -1):
        spread = np.max([np.ptp(seen[..., first::p, :], axis=-2).max(axis=-1) for first in range(p)], axis=0)
        order = np.where(spread <= _SAME * scale, p, order)
    half = seen.shape[-2] // 2
    early, late = (np.std(part, axis=-2).max(axis=-1) for part in (seen[..., :half, :], seen[..., half:, :]))
    return _Repeats(order=order, shrinking=late < _SHRINKS * early)


def _exponent(
    structure: Structure, both: Callable[[State], State], start: State, f: Floats, stiffness: Floats, rounds: int
) -> Floats:
    """Return the mean growth of a small disturbance over the later half of the rounds, as an exponent per period."""
    omega, n = 2 * np.pi * f, structure.coordinates

    def size(state: State) -> Floats:  # the root of the energy of small motions, which no mode makes swing
        kinetic = np.einsum("...i,ij,...j->...", state.rates, structure.mass_matrix, state.rates)
        elastic = np.einsum("...i,ij,...j->...", state.coordinates, structure.stiffness_matrix, state.coordinates)
        return np.asarray(np.sqrt(kinetic + elastic + stiffness * (state.coordinates @ structure.contact_vector) ** 2))

    small = _DISTURBANCE * np.maximum(size(start), 1e-300)[..., np.newaxis]
    aside = np.random.default_rng(0).normal(size=(2, n))  # any direction: it turns into the fastest growing one
    gap = State(coordinates=aside[0] / omega[..., np.newaxis], rates=np.broadcast_to(aside[1], (*f.shape, n)))
    growth = []
    for _ in range(rounds):
        scale = small / size(gap)[..., np.newaxis]
        ends = both(
            State(
                coordinates=np.stack([start.coordinates, start.coordinates + scale * gap.coordinates]),
                rates=np.stack([start.rates, start.rates + scale * gap.rates]),
            )
        )
        start = State(coordinates=ends.coordinates[0], rates=ends.rates[0])
        gap = State(coordinates=np.diff(ends.coordinates, axis=0)[0], rates=np.diff(ends.rates, axis=0)[0])
        growth.append(np.log(np.maximum(size(gap), 1e-300) / small[..., 0]))
    return np.asarray(np.mean(growth[rounds // 2 :], axis=0) / _ROUND)


def _contact_loss_fraction(gap_law: GapLaw, motion: ContactMotion, load: Floats, rate: Floats) -> Floats:
    """Look between the steps as well, along the cubics through displacements and velocities at their ends."""
    s = (np.arange(_FINER) / _FINER)[:, np.newaxis]
    x, v = (
        motion.displacement[..., np.newaxis, :],
        motion.velocity[..., np.newaxis, :] / rate[..., np.newaxis, np.newaxis],
    )
    before, after, start, end = x[..., :-1], x[..., 1:], v[..., :-1], v[..., 1:]
    between = before + s * (
        start + s * (3 * (after - before) - 2 * start - end + s * (2 * (before - after) + start + end))
    )
    weight = load[..., np.newaxis, np.newaxis]
    return np.asarray(np.mean(gap_law.force(between, weight) < LOST * weight, axis=(-2, -1)))


def _descriptions(found: Attractors, advice: NDArray[np.str_]) -> NDArray[np.str_]:
    fields = (
        found.kind,
        found.order,
        found.exponent,
        found.contact_loss_fraction,
        found.beat_frequency,
        found.beat_amplitude,
        advice,
    )
    texts = [_description(*values) for values in zip(*(field.ravel().tolist() for field in fields), strict=True)]
    return np.array(texts).reshape(found.kind.shape)


def _description(
    kind: str, order: int, exponent: float, open_share: float, frequency: float, amplitude: float, advice: str
) -> str:
    slow = f"{frequency:.4g} Hz with an amplitude of {amplitude * 1e6:.3g} um"
    dies_out = exponent < -_SURE
    words = {
        "periodic": "periodic" + (f"; a disturbance dies out by exp({exponent:.3g}) a period" if dies_out else ""),
        "subharmonic": f"subharmonic, repeats after {order} periods",
        "beating": f"beats at {slow}",
        "chaotic": f"chaotic; a disturbance grows by exp({exponent:.3g}) a period",
        "settling": f"still settling, at {slow}; march on for longer",
        "diverged": "diverged",
    }
    bouncing = f"without contact for {open_share:.2%} of the time" if open_share > 0 else ""
    return "; ".join(filter(None, (words[kind], bouncing, advice)))
