"""Normal stiffness and decay length of a contact from resonances measured free, pressed and under large vibration."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.measurement.contact_stiffness.large_vibration import decay_length_from_ratio, log_ratio_slope
from sonolube.measurement.contact_stiffness.resonance_fit import Resonance
from sonolube.models.dynamics import Structure, contact_resonances, modes, stiffness_at_resonance

_RESOLVED = 3.0  # shift over its standard uncertainty from which on it gives a number
_NORMAL_95 = 1.959964
_CONTRADICTION = 2.0  # difference of two routes over its standard uncertainty
_FAR = 0.05  # relative difference of measured and computed free frequency from which on a warning is given


@dataclass(frozen=True, kw_only=True, slots=True)
class LogEstimate:
    """Median of a positive quantity with the standard deviation of its logarithm.

    Parameters
    ----------
    median : float
        In SI.
    log_deviation : float
        Standard deviation of the logarithm.
    """

    median: float
    log_deviation: float

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the 95 % interval."""
        factor = float(np.exp(_NORMAL_95 * self.log_deviation))
        return self.median / factor, self.median * factor


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactStiffness:
    """Stiffness of a contact by the shift of a resonance, or the reason for which the shift gives none.

    Parameters
    ----------
    free_frequency : float
        Without contact, at the time of the pressed spectrum, in Hz; zero for a mode that floats.
    pressed_frequency : float
        Under the load, in Hz.
    free_uncertainty : float
        Standard uncertainty of the free frequency by noise and drift, in Hz.
    pressed_uncertainty : float
        Standard uncertainty of the pressed frequency by noise, in Hz.
    drift : float or None
        Difference of the second from the first free spectrum, in Hz; None where there is one only.
    mode : int
        Number of the mode of the structure.
    normal_stiffness : LogEstimate or None
        None where the shift is not resolved. [N/m]
    decay_length : LogEstimate or None
        By load over stiffness. [m]
    decay_length_by_ratio : LogEstimate or None
        By the ratio of the shifts at large and at small vibration.
    decay_length_combined : LogEstimate or None
        Of both, weighted by their covariance.
    stiffness_ratio : float or None
        Equivalent stiffness at the large over that at the small vibration.
    not_found : tuple of str
        Sentences in place of numbers that the spectra do not give.
    caveats : tuple of str
        Warnings, one line each.
    """

    free_frequency: float
    pressed_frequency: float
    free_uncertainty: float
    pressed_uncertainty: float
    drift: float | None
    mode: int
    normal_stiffness: LogEstimate | None = None
    decay_length: LogEstimate | None = None
    decay_length_by_ratio: LogEstimate | None = None
    decay_length_combined: LogEstimate | None = None
    stiffness_ratio: float | None = None
    not_found: tuple[str, ...] = ()
    caveats: tuple[str, ...] = ()

    @property
    def frequency_shift(self) -> float:
        """Pressed less free frequency, in Hz."""
        return self.pressed_frequency - self.free_frequency

    @property
    def shift_uncertainty(self) -> float:
        """Standard uncertainty of the shift, in Hz."""
        return float(np.hypot(self.free_uncertainty, self.pressed_uncertainty))

    @property
    def best_stiffness(self) -> LogEstimate | None:
        """Stiffness by all that was measured: by the combined decay length where there is one. [N/m]"""
        if self.normal_stiffness is None or self.decay_length is None or self.decay_length_combined is None:
            return self.normal_stiffness
        load = self.normal_stiffness.median * self.decay_length.median
        both = self.decay_length_combined
        return LogEstimate(median=load / both.median, log_deviation=both.log_deviation)


def single_mode(*, modal_mass: float, frequency: float) -> Structure:
    """Structure of one undamped mode whose coordinate is the displacement of the contact.

    Parameters
    ----------
    modal_mass : float
        At the contact. [kg]
    frequency : float
        Without contact. [Hz]

    Returns
    -------
    Structure

    Raises
    ------
    InvalidInput
        If one of them is not positive.
    """
    require_positive(modal_mass=modal_mass, frequency=frequency)
    stiffness = modal_mass * (2 * np.pi * frequency) ** 2
    return Structure(
        mass_matrix=np.array([[modal_mass]]),
        damping_matrix=np.zeros((1, 1)),
        stiffness_matrix=np.array([[stiffness]]),
        drive_vector=np.zeros(1),
        contact_vector=np.ones(1),
        clamped_capacitance=0.0,
    )


def contact_stiffness(
    structure: Structure,
    *,
    free: Sequence[Resonance],
    pressed: Resonance,
    normal_load: float,
    modal_mass_deviation: float = 0.1,
    large: Resonance | None = None,
    vibration_amplitude: float | None = None,
    log_amplitude_deviation: float = 0.05,
) -> ContactStiffness:
    r"""Normal stiffness and decay length of a contact from the shift of one resonance of its structure.

    The free frequency during the pressed sweep is the mean of both free ones. A drift d that does not turn back leaves
    it anywhere between them, so that with the uncertainties u of the fits

    .. math:: u_0^2 = \tfrac14(u_1^2 + u_2^2) + d^2/12 .

    All springs of the structure are scaled until its mode has the measured free frequency; then the stiffness is solved
    for by `stiffness_at_resonance`. The uncertainty of its logarithm follows to first order from those of both
    frequencies and of the modal mass, to which the stiffness is proportional.
    """
    load = float(require_positive(normal_load=normal_load))
    require_non_negative(modal_mass_deviation=modal_mass_deviation, log_amplitude_deviation=log_amplitude_deviation)
    if len(free) > 2:
        raise InvalidInput(f"free must hold at most two resonances, got {len(free)}")
    if large is not None and vibration_amplitude is None:
        raise InvalidInput("vibration_amplitude is missing; the ratio of the shifts needs that of the large vibration")
    f_0, u_0, drift = _free_frequency(free)
    mode, caveats = _mode(structure, f_0)
    shift, u_shift = pressed.frequency - f_0, float(np.hypot(u_0, pressed.frequency_uncertainty))
    if len(free) == 1:
        caveats.append(
            "one free spectrum only: a drift of the resonance is not in the interval; measure free again after pressing"
        )
    found = ContactStiffness(
        free_frequency=f_0,
        pressed_frequency=pressed.frequency,
        free_uncertainty=u_0,
        pressed_uncertainty=pressed.frequency_uncertainty,
        drift=drift,
        mode=mode,
        caveats=tuple(caveats),
    )
    tuned = _Tuned(structure, mode)
    if shift < _RESOLVED * u_shift:
        return replace(found, not_found=(_unresolved(tuned, f_0, pressed.half_width, shift, u_shift, load),))
    k, slopes = tuned.stiffness(f_0, pressed.frequency), tuned.slopes(f_0, pressed.frequency, u_0, pressed)
    parts = np.array([slopes[0] * u_0, slopes[1] * pressed.frequency_uncertainty, 0.0, modal_mass_deviation, 0.0])
    stiffness = LogEstimate(median=k, log_deviation=float(np.linalg.norm(parts)))
    length = LogEstimate(median=load / k, log_deviation=stiffness.log_deviation)
    found = replace(found, normal_stiffness=stiffness, decay_length=length)
    if large is None or vibration_amplitude is None:
        return found
    return _with_ratio(found, tuned, (u_0, parts), large, float(vibration_amplitude), log_amplitude_deviation)


def _free_frequency(free: Sequence[Resonance]) -> tuple[float, float, float | None]:
    """Free frequency during the pressed sweep, its standard uncertainty, and the drift."""
    if not free:
        return 0.0, 0.0, None
    frequencies, errors = (
        np.array([getattr(one, key) for one in free]) for key in ("frequency", "frequency_uncertainty")
    )
    if len(free) == 1:
        return float(frequencies[0]), float(errors[0]), None
    drift = float(frequencies[1] - frequencies[0])
    return float(frequencies.mean()), float(np.sqrt(np.sum(errors**2) / 4 + drift**2 / 12)), drift


def _mode(structure: Structure, free_frequency: float) -> tuple[int, list[str]]:
    """Mode of the structure that has a free frequency, and a caveat where they differ much."""
    natural = modes(structure)
    participation = np.abs(structure.contact_vector @ natural.shapes)
    moving = participation > 1e-6 * participation.max()
    if free_frequency == 0:
        floating = np.flatnonzero(natural.rigid & moving)
        if not floating.size:
            raise InvalidInput(
                "free must hold a resonance: the structure has no rigid-body mode that moves its contact"
            )
        return int(floating[-1]), [
            "a mode that floats has no free frequency: the stiffness rests on the masses of the structure alone"
        ]
    apart = np.where(moving & ~natural.rigid, np.abs(natural.natural_frequency - free_frequency), np.inf)
    mode = int(np.argmin(apart))
    if apart[mode] > _FAR * free_frequency:
        return mode, [
            f"the free resonance at {free_frequency:.6g} Hz is {apart[mode] / free_frequency:.0%} off the nearest mode"
            f" of the structure, {natural.natural_frequency[mode]:.6g} Hz: its modal mass may be another"
        ]
    return mode, []


class _Tuned:
    """Structure whose springs are scaled until a mode has its measured free frequency."""

    def __init__(self, structure: Structure, mode: int) -> None:
        self.structure = structure
        self.mode = mode

    def at(self, free_frequency: float) -> Structure:
        """Structure with this free frequency."""
        scaled = self.structure
        for _ in range(4 if free_frequency else 0):
            own = float(contact_resonances(scaled, normal_stiffness=0.0)[self.mode])
            if own == 0:
                raise OutsideRange(
                    f"mode {self.mode} of the structure is overdamped without contact; take another mode"
                )
            scaled = replace(scaled, stiffness_matrix=scaled.stiffness_matrix * (free_frequency / own) ** 2)
        return scaled

    def stiffness(self, free_frequency: float, frequency: float) -> float:
        """Stiffness of the contact by both frequencies. [N/m]"""
        return stiffness_at_resonance(self.at(free_frequency), mode=self.mode, frequency=frequency)

    def slopes(self, free_frequency: float, frequency: float, u_0: float, pressed: Resonance) -> Floats:
        """Derivatives of the logarithm of the stiffness by the free and by the pressed frequency."""
        shift = frequency - free_frequency
        step = min(0.05 * shift, max(u_0, pressed.frequency_uncertainty, 1e-4 * shift))
        by_free = 0.0
        if free_frequency:
            by_free = self._difference((free_frequency - step, frequency), (free_frequency + step, frequency)) / step
        by_pressed = self._difference((free_frequency, frequency - step), (free_frequency, frequency + step)) / step
        return np.array([by_free, by_pressed])

    def _difference(self, lower: tuple[float, float], upper: tuple[float, float]) -> float:
        """Half the difference of the logarithms of the stiffness at two pairs of frequencies."""
        return float(np.log(self.stiffness(*upper) / self.stiffness(*lower))) / 2


def _unresolved(tuned: _Tuned, f_0: float, half_width: float, shift: float, u_shift: float, load: float) -> str:
    """Sentence in place of a stiffness."""
    sentence = (
        f"normal stiffness: the shift of {shift:.3g} Hz is below three standard uncertainties of {u_shift:.2g} Hz"
        f" (half width of the resonance {half_width:.3g} Hz), so it gives no stiffness"
    )
    if shift < -_RESOLVED * u_shift:
        return f"{sentence}; a contact raises a resonance: both spectra show different modes, or it drifted"
    limit = shift + _NORMAL_95 * u_shift
    try:
        most = tuned.stiffness(f_0, f_0 + limit)
    except OutsideRange:
        return f"{sentence}; take a slower mode, one of less modal mass at the contact, or a narrower one"
    return (
        f"{sentence}; it says that k_n is below {most:.2g} N/m and l above {load / most * 1e6:.2g} um (97.5 %). Take a"
        " slower mode, one of less modal mass at the contact, or a narrower one"
    )


def _with_ratio(
    found: ContactStiffness,
    tuned: _Tuned,
    small: tuple[float, Floats],
    large: Resonance,
    amplitude: float,
    log_amplitude_deviation: float,
) -> ContactStiffness:
    """Record with the decay length by the ratio of shifts, and with that of both routes together."""
    pressed, first = found.normal_stiffness, found.decay_length
    assert pressed is not None
    assert first is not None
    u_0, parts = small
    f_0 = found.free_frequency
    if large.frequency - f_0 < _RESOLVED * np.hypot(u_0, large.frequency_uncertainty):
        reason = (
            f"decay length by the ratio of shifts: the shift of {large.frequency - f_0:.3g} Hz at the large vibration"
            " is below three standard uncertainties"
        )
        return replace(found, not_found=(*found.not_found, reason))
    slopes = tuned.slopes(f_0, large.frequency, u_0, large)
    k_large = tuned.stiffness(f_0, large.frequency)
    ratio = k_large / pressed.median
    # columns: free, pressed, large, modal mass, amplitude; the modal mass leaves the ratio
    of_large = np.array([slopes[0] * u_0, 0.0, slopes[1] * large.frequency_uncertainty, parts[3], 0.0])
    of_ratio = of_large - parts
    spread = float(np.linalg.norm(of_ratio))
    found = replace(found, stiffness_ratio=ratio)
    if not ratio < float(np.exp(-_RESOLVED * spread)):
        reason = (
            f"decay length by the ratio of shifts: the ratio of {ratio:.3g} is not resolved from 1 (its logarithm is"
            f" uncertain by {spread:.2g}); take a larger vibration"
        )
        return replace(found, not_found=(*found.not_found, reason))
    length = decay_length_from_ratio(ratio, vibration_amplitude=amplitude)
    slope = log_ratio_slope(vibration_amplitude=amplitude, decay_length=length)
    by_ratio = of_ratio / -slope + np.array([0.0, 0.0, 0.0, 0.0, log_amplitude_deviation])
    by_stiffness = -parts
    estimates = np.log([first.median, length])
    errors = np.stack([by_stiffness, by_ratio])
    apart = float(np.linalg.norm(errors[0] - errors[1]))
    second = LogEstimate(median=length, log_deviation=float(np.linalg.norm(by_ratio)))
    share = float(errors[0] @ (errors[0] - errors[1])) / apart**2  # of the second in the best combination
    weights = np.array([1 - share, share])
    both = LogEstimate(median=float(np.exp(weights @ estimates)), log_deviation=float(np.linalg.norm(weights @ errors)))
    difference = abs(float(estimates[1] - estimates[0])) / apart
    if difference > _CONTRADICTION:
        caveat = (
            f"both decay lengths contradict each other: {first.median * 1e6:.3g} um by the stiffness and"
            f" {length * 1e6:.3g} um by the ratio of shifts differ by {difference:.1f} standard uncertainties; the"
            " load, the modal mass, the amplitude at the contact or the exponential law is not as stated"
        )
        return replace(found, decay_length_by_ratio=second, caveats=(*found.caveats, caveat))
    return replace(found, decay_length_by_ratio=second, decay_length_combined=both)
