"""Expected width of a predictive interval after a further measurement: one run, the contact stiffness, an input.

Resonances of a rig whose shift between free and pressed shows the stiffness of its contact.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics import Structure, modes, with_contact_spring
from sonolube.prediction.evidence import Conditions
from sonolube.prediction.hierarchy import discrepancy_correlation, sorted_quantiles
from sonolube.prediction.inputs import RigInputs
from sonolube.prediction.predictive import RigPrediction
from sonolube.text.units import format_si

_RESOLVED = 3.0  # shift over its standard uncertainty
_STEP = 0.01  # of central differences, in the logarithm of the stiffness
_WIDEST = 0.5  # damping ratio from which on no peak shows
_LISTED = 6  # probes named in a sentence
_BEST = 2  # of them that a prediction tells


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Probe:
    """Resonance of a rig as a probe of its contact's stiffness, at several decay lengths.

    Parameters
    ----------
    mode : int
        Number of the mode in order of frequency, from 0.
    name : str
        As printed.
    modal_mass : float
        At the free contact; infinite for a mode that does not move it. [kg]
    free_frequency : float
        Without contact, in Hz; zero for a rigid-body mode.
    decay_length : ndarray, shape (n,)
        Load over stiffness of the contact. [m]
    pressed_frequency : ndarray, shape (n,)
        Undamped, with a spring of that stiffness at the contact, in Hz.
    peak_half_width : ndarray, shape (n,)
        Half width of the pressed resonance at half power, in Hz.
    shift_uncertainty : ndarray, shape (n,)
        Standard uncertainty of the shift if each frequency is resolved to a fraction of its half width, in Hz.
    resolvable : ndarray of bool, shape (n,)
        Whether the shift is at least three times its uncertainty, and the resonance narrow enough to show.
    log_stiffness_deviation : ndarray, shape (n,)
        Expected standard deviation of the logarithm of the stiffness; infinite where the shift is not resolvable.
    """

    mode: int
    name: str
    modal_mass: float
    free_frequency: float
    decay_length: Floats
    pressed_frequency: Floats
    peak_half_width: Floats
    shift_uncertainty: Floats
    resolvable: NDArray[np.bool_]
    log_stiffness_deviation: Floats

    @property
    def shift(self) -> Floats:
        """Pressed less free frequency, in Hz, shape (n,)."""
        return self.pressed_frequency - self.free_frequency


def stiffness_probes(
    structure: Structure,
    *,
    normal_load: float,
    decay_length: ArrayLike,
    resolution: float = 1 / 50,
    modal_mass_deviation: float = 0.1,
) -> tuple[Probe, ...]:
    r"""Resonances of a structure whose shift between free and pressed shows the stiffness of its contact.

    One a mode that moves the contact, in order of frequency.

    See Also
    --------
    probe_sentences : the same in words.
    sonolube.measurement.contact_stiffness.stiffness_estimate.contact_stiffness : the stiffness from measured shifts.

    With resolution r, half widths :math:`h = \zeta f` and the slope by central differences,

    .. math::

        u_s^2 = r^2 (h_0^2 + h_1^2), \qquad
        u^2(\ln k_n) = \left(\frac{u_s}{df/d\ln k_n}\right)^2 + u^2(\ln m) ,

    and a shift is resolvable from :math:`3 u_s` on. A rigid-body mode has no width of its own when free.
    """
    lengths = np.atleast_1d(require_positive(decay_length=decay_length))
    r = float(require_positive(resolution=resolution))
    require_non_negative(modal_mass_deviation=modal_mass_deviation)
    if lengths.ndim != 1:
        raise InvalidInput(f"decay_length must be a number or a list, got shape {lengths.shape}")
    free = modes(structure)
    stiffness = normal_load / lengths
    at, upper, lower = (
        [modes(with_contact_spring(structure, normal_stiffness=float(k))) for k in stiffness * factor]
        for factor in (1.0, np.exp(_STEP), np.exp(-_STEP))
    )
    frequency, above, below = (np.array([one.natural_frequency for one in each]).T for each in (at, upper, lower))
    damping_ratio = np.array([one.damping_ratio for one in at]).T
    found = []
    participation = np.abs(structure.contact_vector @ free.shapes)
    for mode in np.flatnonzero(participation > 1e-6 * participation.max()):
        pressed, damping, rise = frequency[mode], damping_ratio[mode], above[mode] - below[mode]
        f_0 = float(free.natural_frequency[mode])
        shift_uncertainty = r * np.hypot(damping * pressed, float(free.damping_ratio[mode]) * f_0)
        resolvable = (pressed - f_0 >= _RESOLVED * shift_uncertainty) & (damping < _WIDEST) & (rise > 0)
        slope = np.where(resolvable, rise / (2 * _STEP), 1.0)
        deviation = np.where(resolvable, np.hypot(shift_uncertainty / slope, modal_mass_deviation), np.inf)
        found.append(
            Probe(
                mode=int(mode),
                name="floating mode" if free.rigid[mode] else f"mode at {format_si(f_0, 'Hz', digits=4)}",
                modal_mass=float(participation[mode] ** -2),
                free_frequency=f_0,
                decay_length=lengths,
                pressed_frequency=pressed,
                peak_half_width=damping * pressed,
                shift_uncertainty=shift_uncertainty,
                resolvable=resolvable,
                log_stiffness_deviation=deviation,
            )
        )
    return tuple(found)


def told_probes(probes: Sequence[Probe], *, frequency: float) -> tuple[Probe, ...]:
    """The two probes of least uncertainty, and the mode nearest to a frequency of vibration.

    Up to three, the one of least uncertainty first.
    """
    if not probes:
        return ()
    ranked = _ranked(probes)
    vibrated = min(probes, key=lambda one: abs(one.free_frequency - frequency))
    best = [one for one in ranked[:_BEST] if one.resolvable.any()]
    return (*best, *(one for one in (vibrated,) if one not in best))


def probe_sentences(probes: Sequence[Probe]) -> tuple[str, ...]:
    """Sentences on the resonances of a rig that show the stiffness of its contact.

    The probe of least uncertainty first; one sentence where no probe is known.
    """
    if not probes:
        return ("no structure is known, so no resonance can be named whose shift tells the stiffness of the contact",)
    return tuple(_sentence(probe) for probe in _ranked(probes)[:_LISTED])


def _ranked(probes: Sequence[Probe]) -> list[Probe]:
    """Probes by the share of contacts that they do not resolve, then by their least uncertainty."""
    return sorted(probes, key=lambda one: (float(np.mean(~one.resolvable)), float(one.log_stiffness_deviation.min())))


def _sentence(probe: Probe) -> str:
    """Frequencies of a probe at its decay lengths, and whether their shift is resolved."""
    places = " and ".join(
        f"{format_si(float(f), 'Hz', digits=4 if probe.free_frequency < 1e4 else 6)} at"
        f" l = {format_si(float(length), 'm', digits=2)}"
        for f, length in zip(probe.pressed_frequency, probe.decay_length, strict=True)
    )
    if probe.resolvable.any():
        good = probe.log_stiffness_deviation[probe.resolvable]
        within = f"{100 * float(good.min()):.0f}" + (
            f" to {100 * float(good.max()):.0f}" if np.ptp(good) > 0.005 else ""
        )
        limit = "" if probe.resolvable.all() else ", at the stiffer contacts only"
        return f"{probe.name}: pressed {places}; its shift gives k_n within {within} %{limit}"
    shift, width = float(probe.shift.max()), 2 * float(probe.peak_half_width.max())
    if width >= 2 * _WIDEST * float(probe.pressed_frequency.max()):
        return f"{probe.name}: pressed {places}; too damped to show a peak"
    share = f"1/{width / shift:.0f}" if shift > 0 else "nothing"
    return (
        f"{probe.name}: shifts by {format_si(shift, 'Hz', digits=2)} at most, {share} of its"
        f" width of {format_si(width, 'Hz', digits=2)}: not resolvable"
    )


KNOWN_WELL: Final = {"decay_length": 0.1, "vibration_amplitude": 0.02, "friction_coefficient": 0.03}
"""Standard deviation of the logarithm of each uncertain input after a careful measurement."""

_OUTCOMES: Final = 24  # of a measurement, over which the width is averaged
_PROBABILITIES: Final = (np.arange(_OUTCOMES) + 0.5) / _OUTCOMES
_RUN: Final = 0.05  # standard uncertainty of the ratio of one run
_FARTHER: Final = 2.0  # speed of the other point over that of the rig
_STIFFNESS: Final = (0.3, 0.1)  # standard deviations of the logarithm of a measured contact stiffness
_TAILS: Final = np.array([0.1, 0.9])  # probabilities of the ends of the interval
_NARROWEST: Final = 1e-6


@dataclass(frozen=True, kw_only=True, slots=True)
class Measure:
    """A measurement that would narrow a prediction.

    Parameters
    ----------
    key : str
        "run_here", "run_at_other_speed" or "contact_stiffness".
    label : str
        In words.
    share_left : float
        Expected width of the 80 % interval of the friction ratio after it, over the width now.
    """

    key: str
    label: str
    share_left: float


def own_logarithms(found: RigPrediction, *, intrinsic: Floats, seed: int) -> dict[str, Floats]:
    """Draws of the uncertain inputs of a rig as logarithms by their names, row by row those of the friction ratio.

    Decay length and amplitude, as factors on their medians, are split from their ratio, on which friction depends.
    """
    draws = found.draws
    at, rows = draws.at, np.arange(found.count) % draws.rows.size
    if at.decay_length_spread is None:
        middle, scatter = draws.hyperparameters[rows, 1], np.exp(draws.hyperparameters[rows, 3])
    else:
        middle, scatter = np.zeros(found.count), np.full(found.count, at.decay_length_spread)
    both = np.hypot(scatter, at.amplitude_spread)
    deviate = draws.deviates[rows, 1]
    fresh = np.random.default_rng(seed + 7).standard_normal(found.count)
    amplitude = at.amplitude_spread / both * (-at.amplitude_spread * deviate + scatter * fresh)
    length = middle + both * deviate + amplitude
    return {"decay_length": length, "vibration_amplitude": amplitude, "friction_coefficient": np.log(intrinsic)}


class Target:
    """Draws of a predicted quantity, sorted once for all measurements that may narrow their 80 % interval.

    Parameters
    ----------
    draws : ndarray, shape (draws,)
    """

    def __init__(self, draws: Floats) -> None:
        self._order = np.argsort(draws)
        self._values = draws[self._order]
        low, high = sorted_quantiles(self._values, _TAILS)
        self._width = max(float(high - low), _NARROWEST)

    def share_left(self, *, observed: Floats, noise: float) -> float:
        """Expected width of the interval after a measurement over that now, at most 1.

        Draws are weighed by the normal density of each of 24 evenly probable outcomes of the measurement.
        """
        outcomes = sorted_quantiles(np.sort(observed + noise * _deviates(observed.size)), _PROBABILITIES)
        deviations = outcomes[:, None] / noise - observed[self._order] / noise
        logs = np.multiply(deviations, -0.5 * deviations, out=deviations)
        logs -= logs.max(axis=1, keepdims=True)
        cumulative = np.cumsum(np.exp(logs, out=logs), axis=1, out=logs)
        ends = [each.searchsorted(each[-1] * _TAILS) for each in cumulative]
        low, high = self._values[np.minimum(ends, self._values.size - 1)].T
        return min(float(np.mean(high - low)) / self._width, 1.0)


@lru_cache(maxsize=4)
def _deviates(count: int) -> Floats:
    """Standard normal errors of a measurement, the same for all."""
    return np.random.default_rng(8).standard_normal(count)


def measures(
    found: RigPrediction, inputs: RigInputs, *, ratio: Floats, probes: Sequence[Probe], seed: int
) -> tuple[Measure, ...]:
    """Measurements that would narrow the prediction at the operating point: a run first, then the contact stiffness."""
    near, far = _two_points(found, inputs)
    narrowed = Target(near)
    made = [
        Measure(
            key="run_here", label="one run at this point", share_left=narrowed.share_left(observed=near, noise=_RUN)
        ),
        Measure(
            key="run_at_other_speed",
            label=f"one run at this point, for the ratio at {_FARTHER:g} times the speed",
            share_left=Target(far).share_left(observed=near, noise=_RUN),
        ),
    ]
    if not inputs.measured_length:
        length = own_logarithms(found, intrinsic=np.ones(found.count), seed=seed)["decay_length"]
        made += _stiffness_measures(ratio, length, probes)
    return tuple(made)


def _stiffness_measures(ratio: Floats, length: Floats, probes: Sequence[Probe]) -> list[Measure]:
    """Share of the width that a stiffness by each resonance would leave; two uncertainties where none shows it."""
    made, target = [], Target(ratio)
    for probe in probes:
        if not probe.resolvable.any():
            continue
        deviation = float(np.mean(probe.log_stiffness_deviation[probe.resolvable]))
        low, high = (format_si(float(each), "Hz", digits=3) for each in np.sort(probe.pressed_frequency)[[0, -1]])
        told = float(np.mean(probe.resolvable))  # share of contacts of which the shift tells
        left = told * target.share_left(observed=length, noise=deviation) + 1 - told
        label = f"contact stiffness by the {probe.name} ({low} to {high} when pressed)"
        made.append(Measure(key="contact_stiffness", label=label, share_left=left))
    if made:
        return made
    return [
        Measure(
            key="contact_stiffness",
            label=f"contact stiffness within {100 * noise:.0f} %",
            share_left=target.share_left(observed=length, noise=noise),
        )
        for noise in _STIFFNESS
    ]


def _two_points(found: RigPrediction, inputs: RigInputs) -> tuple[Floats, Floats]:
    """Draws of the ratio at the operating point and at a higher speed, the discrepancy correlated between both."""
    speeds = inputs.sliding_speed * np.array([1.0, _FARTHER])
    at: Conditions = inputs.at(sliding_speed=speeds).conditions
    length = found.draws.hyperparameters[:, 5]
    rows = np.arange(found.count) % len(length)
    correlation = discrepancy_correlation(at, at, log_length=length)[rows, 0, 1]
    first, other = np.random.default_rng(9).standard_normal((2, found.count))
    second = correlation * first + np.sqrt(1 - correlation**2) * other
    here, farther = found.with_deviates(at, np.stack([first, second], axis=1)).T
    return here, farther
