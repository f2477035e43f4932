"""Envelope of a vibration near one resonance: slowly varying amplitude, impedance phase and energy of a driven mode."""

from cmath import exp, phase
from dataclasses import asdict, dataclass
from math import inf, pi

import numpy as np

from sonolube.checks import require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.models.dynamics import electrical_admittance, modes
from sonolube.rig import Rig, structure_in_contact
from sonolube.rig.driven_rig import require_drive

_MAX_RESIDUAL = 0.2  # conductance of all other modes over that of the mode


@dataclass(frozen=True, kw_only=True, slots=True)
class VibrationMode:
    r"""One resonance; of a stack, a motional branch in parallel with a capacitance (Butterworth-Van Dyke).

    Parameters
    ----------
    natural_frequency : float
        Series resonance frequency, with the surfaces in contact. [Hz]
    damping_ratio : float
        Damping ratio of the mode. []
    frequency : float
        Nominal drive frequency. [Hz]
    motional_conductance : float or None
        Conductance of the motional branch at resonance; None where an amplitude is commanded. [S]
    parallel_capacitance : float or None
        Capacitance in parallel with the motional branch; None where an amplitude is commanded. [F]

    Raises
    ------
    InvalidInput
        If a frequency, conductance, capacitance or damping is not positive, or one of conductance and capacitance is
        missing.

    Notes
    -----
    The complex envelope :math:`a` of the vibration is expressed as the peak-to-peak voltage that maintains it at
    resonance, or as its amplitude where that is commanded. For light damping and changes that are slow against the
    period (averaging),

    .. math:: \dot a = -\bigl(\sigma + i (\omega - \omega_r)\bigr) a + \sigma u, \qquad \sigma = \zeta \omega_r

    A voltage supplies the power :math:`g u \operatorname{Re}(a)/8` to the motional branch of the conductance :math:`g`,
    of which :math:`g |a|^2/8` is dissipated; the stored energy is :math:`g |a|^2/(16 \sigma)`.
    """

    natural_frequency: float
    damping_ratio: float
    frequency: float
    motional_conductance: float | None = None
    parallel_capacitance: float | None = None

    def __post_init__(self) -> None:
        require_positive(**{name: value for name, value in asdict(self).items() if value is not None})
        if (self.motional_conductance is None) != (self.parallel_capacitance is None):
            raise InvalidInput("a mode needs both motional_conductance and parallel_capacitance, or neither")

    @property
    def branch(self) -> tuple[float, float]:
        """Motional conductance and parallel capacitance, in S and F."""
        if self.motional_conductance is None or self.parallel_capacitance is None:
            raise InvalidInput("a mode whose amplitude is commanded has no electrical branch")
        return self.motional_conductance, self.parallel_capacitance

    @property
    def decay_rate(self) -> float:
        """Decay rate of the free envelope, sigma, in 1/s."""
        return 2 * pi * self.damping_ratio * self.natural_frequency

    @property
    def time_constant(self) -> float:
        """Time constant of the envelope, 1/sigma, in s."""
        return 1 / self.decay_rate

    def rate(self, frequency: float, shift: float = 0.0) -> complex:
        """Complex rate sigma + i (omega - omega_r) with the resonance shifted by a relative change, in 1/s."""
        return self.decay_rate + 2j * pi * (frequency - self.natural_frequency * (1 + shift))

    @property
    def nominal_envelope_ratio(self) -> float:
        """Steady envelope over voltage at the nominal drive frequency."""
        return abs(self.decay_rate / self.rate(self.frequency))


def mode_at_drive(rig: Rig) -> VibrationMode:
    """Mode of a rig whose resonance is closest to the drive frequency, the contact linearised at rest.

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
        If the rig has no structure, or the conductance of the other modes at that resonance exceeds a fifth of its own.

    See Also
    --------
    assumed_mode
    """
    drive, linearised = require_drive(rig), structure_in_contact(rig)
    natural = modes(linearised)
    charge = linearised.drive_vector @ natural.shapes
    elastic = np.flatnonzero(~natural.rigid)
    i = elastic[np.argmin(np.abs(natural.natural_frequency[elastic] - drive.frequency))]
    f = float(natural.natural_frequency[i])
    conductance = charge[i] ** 2 / (4 * pi * f * natural.damping_ratio[i])
    residual = complex(electrical_admittance(linearised, frequency=f)) - conductance
    if residual.imag <= 0 or abs(residual.real) > _MAX_RESIDUAL * conductance:
        raise InvalidInput(
            f"{rig.title}: the resonance at {f:.5g} Hz closest to the drive overlaps with others, so that one mode"
            " cannot represent it; drive near an isolated resonance"
        )
    return VibrationMode(
        natural_frequency=f,
        damping_ratio=float(natural.damping_ratio[i]),
        motional_conductance=float(conductance),
        parallel_capacitance=residual.imag / (2 * pi * f),
        frequency=drive.frequency,
    )


def assumed_mode(rig: Rig, *, quality_factor: float, coupling_factor: float) -> VibrationMode:
    r"""Mode at the drive frequency from assumed quality and coupling factors, for a rig with a capacitance only.

    Parameters
    ----------
    rig : Rig
        With a drive and a capacitance, that below the resonance.
    quality_factor : float
        Quality factor of the resonance in the impedance. []
    coupling_factor : float
        Effective coupling factor of series and parallel resonance. []

    Returns
    -------
    VibrationMode

    Raises
    ------
    InvalidInput
        If the rig has no drive voltage or capacitance, the quality factor does not exceed 0.5, or the coupling factor
        does not lie between 0 and 1.

    See Also
    --------
    mode_at_drive, amplitude_mode

    Notes
    -----
    With the series and parallel resonance frequencies :math:`f_s` and :math:`f_p` and the capacitance :math:`C`,

    .. math:: k^2 = 1 - \frac{f_s^2}{f_p^2}, \qquad g = 2 \pi f_s C k^2 Q, \qquad C_0 = C (1 - k^2)
    """
    drive = require_drive(rig)
    if rig.capacitance is None:
        raise InvalidInput(f"{rig.title}: actuator.capacitance is missing; give it, or the tables stack and structure")
    damping_ratio = _damping_ratio(quality_factor)
    k = float(require_within(1e-6, 1 - 1e-6, coupling_factor=coupling_factor))
    return VibrationMode(
        natural_frequency=drive.frequency,
        damping_ratio=damping_ratio,
        motional_conductance=2 * pi * drive.frequency * rig.capacitance * k**2 * quality_factor,
        parallel_capacitance=rig.capacitance * (1 - k**2),
        frequency=drive.frequency,
    )


def amplitude_mode(rig: Rig, *, quality_factor: float) -> VibrationMode:
    """Mode by which an amplitude follows its set point, from an assumed quality factor, for a rig without a voltage.

    Parameters
    ----------
    rig : Rig
        With a drive frequency, at which the resonance is held.
    quality_factor : float
        Quality factor of the resonance. []

    Returns
    -------
    VibrationMode
        Without an electrical branch.

    Raises
    ------
    InvalidInput
        If the rig has no drive frequency, or the quality factor does not exceed 0.5.

    See Also
    --------
    assumed_mode
    """
    if rig.drive is None:
        raise InvalidInput(f"{rig.title}: drive.frequency is missing; give the frequency of the vibration")
    return VibrationMode(
        natural_frequency=rig.drive.frequency,
        damping_ratio=_damping_ratio(quality_factor),
        frequency=rig.drive.frequency,
    )


def mode_admittance(mode: VibrationMode, *, frequency: float, shift: float = 0.0) -> complex:
    r"""Electrical admittance of a mode in the steady state, in siemens.

    Parameters
    ----------
    mode : VibrationMode
    frequency : float
        Drive frequency. [Hz]
    shift : float
        Relative shift of the resonance.

    Returns
    -------
    complex

    See Also
    --------
    impedance_phase

    Notes
    -----
    .. math:: Y = i \omega C_0 + g \frac{\sigma}{\sigma + i (\omega - \omega_r)}
    """
    f = float(require_positive(frequency=frequency))
    return _admittance(mode, mode.decay_rate / mode.rate(f, shift), f)


def impedance_phase(mode: VibrationMode, *, frequency: float, shift: float = 0.0) -> float:
    """Phase of the impedance in the steady state, positive where the voltage leads the current. [rad]

    Parameters
    ----------
    mode : VibrationMode
    frequency : float
        Drive frequency. [Hz]
    shift : float
        Relative shift of the resonance.

    Returns
    -------
    float

    See Also
    --------
    mode_admittance, measured_phase
    """
    return -phase(mode_admittance(mode, frequency=frequency, shift=shift))


def measured_phase(mode: VibrationMode, envelope_ratio: complex, *, frequency: float) -> float:
    """Phase of voltage over current at the present envelope, positive where the voltage leads. [rad]

    Parameters
    ----------
    mode : VibrationMode
    envelope_ratio : complex
        Envelope over voltage.
    frequency : float
        Drive frequency. [Hz]

    Returns
    -------
    float

    See Also
    --------
    impedance_phase
    """
    return -phase(_admittance(mode, envelope_ratio, float(require_positive(frequency=frequency))))


def next_envelope(
    mode: VibrationMode, envelope: complex, *, level: float, rate: complex, duration: float
) -> tuple[complex, complex]:
    r"""Envelope after a time under constant voltage or commanded amplitude, and its integral over that time.

    Parameters
    ----------
    mode : VibrationMode
    envelope : complex
        Initial envelope, in V or m.
    level : float
        Peak-to-peak drive voltage, or commanded amplitude, in V or m.
    rate : complex
        Complex rate of `VibrationMode.rate`, in 1/s.
    duration : float
        Time. [s]

    Returns
    -------
    pair of complex
        In V and V s, or m and m s.

    Notes
    -----
    The exact solution with the complex rate :math:`\lambda`:

    .. math:: a(t) = a_\infty + (a_0 - a_\infty) e^{-\lambda t}, \qquad a_\infty = \frac{\sigma u}{\lambda}
    """
    steady = mode.decay_rate * float(require_non_negative(level=level)) / rate
    decay = exp(-rate * float(require_non_negative(duration=duration)))
    deviation = envelope - steady
    return steady + deviation * decay, steady * duration + deviation * (1 - decay) / rate


def capture_limit(mode: VibrationMode) -> float:
    r"""Upper end of the capture range of phase-based resonance tracking. [Hz]

    Parameters
    ----------
    mode : VibrationMode

    Returns
    -------
    float
        Frequency near the parallel resonance at which the impedance has the phase of the nominal drive frequency once
        more; from all frequencies below it the tracker converges to the nominal one.

    Raises
    ------
    InvalidInput
        If the phase decreases with frequency at the nominal drive frequency, so that it cannot be tracked there.

    See Also
    --------
    tuned_tracker

    Notes
    -----
    In half bandwidths :math:`\delta` from the resonance, with the susceptance :math:`b` of the capacitance taken as
    constant and the motional conductance :math:`g`, the phase has its nominal value where

    .. math:: b \delta^2 - g \delta + \text{const} = 0

    whose two roots add to :math:`g/b`.
    """
    conductance, capacitance = mode.branch
    figure_of_merit = conductance / (2 * pi * mode.natural_frequency * capacitance)
    half_bandwidth = mode.decay_rate / (2 * pi)
    nominal = (mode.frequency - mode.natural_frequency) / half_bandwidth
    if nominal >= figure_of_merit / 2:
        raise InvalidInput(
            f"frequency {mode.frequency:.5g} Hz: the phase of the impedance falls with frequency there, so that the"
            " resonance cannot be tracked by it; drive below"
            f" {mode.natural_frequency + half_bandwidth * figure_of_merit / 2:.5g} Hz"
        )
    return mode.natural_frequency + half_bandwidth * (figure_of_merit - nominal)


def _admittance(mode: VibrationMode, envelope_ratio: complex, frequency: float) -> complex:
    """Current over voltage at a ratio of envelope to voltage, in S."""
    conductance, capacitance = mode.branch
    return 2j * pi * frequency * capacitance + conductance * envelope_ratio


def _damping_ratio(quality_factor: float) -> float:
    """Damping ratio of a quality factor, which must exceed that of critical damping."""
    if not 0.5 < quality_factor < inf:
        raise InvalidInput(f"quality_factor must be above 0.5, got {quality_factor:g}")
    return 0.5 / quality_factor
