"""The vibration that a drive keeps up near one resonance: its envelope, its current, its energy."""

from cmath import exp, phase
from dataclasses import dataclass
from math import inf, pi

import numpy as np

from sonolube.checks import require_non_negative, require_positive, require_within
from sonolube.dynamics import electrical_admittance, modes
from sonolube.errors import InvalidInput
from sonolube.rig import Rig, structure_in_contact
from sonolube.rig.driven_rig import require_drive

_ALONE = 0.2  # share of the driven mode's conductance by which all else may shift it


@dataclass(frozen=True, kw_only=True, slots=True)
class VibrationMode:
    """One resonance of a driven structure, seen slowly: amplitude and phase of the vibration instead of its course.

    The envelope is counted in volts, as the swing that would keep it up at resonance.

    Parameters
    ----------
    natural_frequency : float
        Resonance, the contact touching. [Hz]
    damping_ratio : float
        Its damping. []
    motional_conductance : float
        Conductance at resonance, beside the capacitance. [S]
    parallel_capacitance : float
        Capacitance beside the motional branch. [F]
    frequency : float
        Frequency at which the drive is meant to run. [Hz]

    Raises
    ------
    InvalidInput
        If a frequency, conductance, capacitance or damping is not positive.

    Notes
    -----
    a' = -(sigma + i (omega - omega_r)) a + sigma u, for light damping and changes slow against the period. With it go
    the power g u Re(a)/8 that the motion takes, g abs(a)^2/8 that it loses, and g abs(a)^2/(16 sigma) that it holds.
    """

    natural_frequency: float
    damping_ratio: float
    motional_conductance: float
    parallel_capacitance: float
    frequency: float

    def __post_init__(self) -> None:
        require_positive(
            natural_frequency=self.natural_frequency,
            damping_ratio=self.damping_ratio,
            motional_conductance=self.motional_conductance,
            parallel_capacitance=self.parallel_capacitance,
            frequency=self.frequency,
        )

    @property
    def decay_rate(self) -> float:
        """Rate at which the free envelope decays, sigma, in 1/s."""
        return 2 * pi * self.damping_ratio * self.natural_frequency

    @property
    def time_constant(self) -> float:
        """Time in which it covers 63 % of a step, in s."""
        return 1 / self.decay_rate

    def rate(self, frequency: float, shift: float = 0.0) -> complex:
        """Return sigma + i (omega - omega_r), the resonance shifted by a relative change, in 1/s."""
        return self.decay_rate + 2j * pi * (frequency - self.natural_frequency * (1 + shift))

    @property
    def meant_fraction(self) -> float:
        """Envelope over voltage at the frequency at which the drive is meant to run."""
        return abs(self.decay_rate / self.rate(self.frequency))


def driven_mode(rig: Rig) -> VibrationMode:
    """Return the resonance next to a rig's drive, the contact a spring of its stiffness at rest.

    Parameters
    ----------
    rig : Rig
        With a stack, a structure and a drive voltage.

    Returns
    -------
    VibrationMode

    Raises
    ------
    InvalidInput
        If the rig has no structure, or other modes weigh too much at that resonance for one to stand for all.
    """
    drive, touching = require_drive(rig), structure_in_contact(rig)
    natural = modes(touching)
    charge = touching.drive_vector @ natural.shapes
    sprung = np.flatnonzero(~natural.rigid)
    i = sprung[np.argmin(np.abs(natural.natural_frequency[sprung] - drive.frequency))]
    f = float(natural.natural_frequency[i])
    conductance = charge[i] ** 2 / (4 * pi * f * natural.damping_ratio[i])
    beside = complex(electrical_admittance(touching, frequency=f)) - conductance
    if beside.imag <= 0 or abs(beside.real) > _ALONE * conductance:
        raise InvalidInput(f"{rig.title}: the resonance at {f:.5g} Hz next to the drive does not stand alone")
    return VibrationMode(
        natural_frequency=f,
        damping_ratio=float(natural.damping_ratio[i]),
        motional_conductance=float(conductance),
        parallel_capacitance=beside.imag / (2 * pi * f),
        frequency=drive.frequency,
    )


def supposed_mode(rig: Rig, *, quality_factor: float, coupling_factor: float) -> VibrationMode:
    """Return a resonance at the drive's frequency for a rig of which only the capacitance is known.

    Parameters
    ----------
    rig : Rig
        With a drive and a capacitance, taken for that below resonance.
    quality_factor : float
        Of the resonance, as it shows in the impedance. []
    coupling_factor : float
        Effective coupling, k^2 = 1 - (f_s/f_p)^2 of series and parallel resonance. []

    Returns
    -------
    VibrationMode

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or capacitance, the quality is not above a half, or the coupling not between
        0 and 1.
    """
    drive = require_drive(rig)
    if rig.capacitance is None:
        raise InvalidInput(f"{rig.title}: actuator.capacitance is missing; give it, or the tables stack and structure")
    if not 0.5 < quality_factor < inf:
        raise InvalidInput(f"quality_factor must be above 0.5, got {quality_factor:g}")
    k = float(require_within(1e-6, 1 - 1e-6, coupling_factor=coupling_factor))
    return VibrationMode(
        natural_frequency=drive.frequency,
        damping_ratio=0.5 / quality_factor,
        motional_conductance=2 * pi * drive.frequency * rig.capacitance * k**2 * quality_factor,
        parallel_capacitance=rig.capacitance * (1 - k**2),
        frequency=drive.frequency,
    )


def mode_admittance(mode: VibrationMode, *, frequency: float, shift: float = 0.0) -> complex:
    """Return current per voltage in the steady state, in siemens.

    Parameters
    ----------
    mode : VibrationMode
    frequency : float
        Frequency of the drive. [Hz]
    shift : float
        Relative change of the resonance.
    """
    f = float(require_positive(frequency=frequency))
    return _current(mode, mode.decay_rate / mode.rate(f, shift), f)


def impedance_phase(mode: VibrationMode, *, frequency: float, shift: float = 0.0) -> float:
    """Return the phase of the impedance in the steady state, voltage ahead of current. [rad]

    Parameters
    ----------
    mode : VibrationMode
    frequency : float
        Frequency of the drive. [Hz]
    shift : float
        Relative change of the resonance.
    """
    return -phase(mode_admittance(mode, frequency=frequency, shift=shift))


def sensed_phase(mode: VibrationMode, share: complex, *, frequency: float) -> float:
    """Return the phase of voltage over current with the envelope as it is, voltage ahead of current. [rad]

    Parameters
    ----------
    mode : VibrationMode
    share : complex
        Envelope over voltage.
    frequency : float
        Frequency of the drive. [Hz]
    """
    return -phase(_current(mode, share, float(require_positive(frequency=frequency))))


def next_envelope(
    mode: VibrationMode, envelope: complex, *, voltage_peak_to_peak: float, rate: complex, duration: float
) -> tuple[complex, complex]:
    """Return the envelope after a time under one voltage and frequency, and its integral over that time.

    Parameters
    ----------
    mode : VibrationMode
    envelope : complex
        At the start, in V.
    voltage_peak_to_peak : float
        Swing of the drive. [V]
    rate : complex
        Sigma and detuning, in 1/s.
    duration : float
        Time. [s]

    Returns
    -------
    pair of complex
        In V and V s; exact.
    """
    volts, lasting = (
        require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak),
        require_non_negative(duration=duration),
    )
    kept_up = mode.decay_rate * float(volts) / rate
    left = exp(-rate * float(lasting))
    deviation = envelope - kept_up
    return kept_up + deviation * left, kept_up * duration + deviation * (1 - left) / rate


def capture_edge(mode: VibrationMode) -> float:
    """Return the frequency from which a tracker of the impedance's phase no longer finds its way down. [Hz]

    Parameters
    ----------
    mode : VibrationMode

    Returns
    -------
    float
        Where the phase meets its wanted value again, near the parallel resonance; from all frequencies below the
        tracker comes home.

    Raises
    ------
    InvalidInput
        If the phase falls with frequency where the drive is meant to run, so that it cannot be tracked there.

    Notes
    -----
    In detunings delta of half bandwidths the phase is wanted where b delta^2 - g delta + const = 0, whose roots add
    to g/b: b is the susceptance of the capacitance, taken as constant, g the motional conductance.
    """
    merit = mode.motional_conductance / (2 * pi * mode.natural_frequency * mode.parallel_capacitance)
    half_bandwidth = mode.decay_rate / (2 * pi)
    own = (mode.frequency - mode.natural_frequency) / half_bandwidth
    if own >= merit / 2:
        raise InvalidInput(
            f"frequency {mode.frequency:.5g} Hz: the phase of the impedance falls with frequency there, so it does not"
            f" tell which way to go; drive below {mode.natural_frequency + half_bandwidth * merit / 2:.5g} Hz"
        )
    return mode.natural_frequency + half_bandwidth * (merit - own)


def _current(mode: VibrationMode, share: complex, frequency: float) -> complex:
    return 2j * pi * frequency * mode.parallel_capacitance + mode.motional_conductance * share
