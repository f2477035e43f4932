"""The closed loop in time: sensor, controller, amplifier, vibration and friction, one interval after the other."""

from collections import deque
from dataclasses import dataclass, field
from math import exp, pi

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.design.control.controller import FrictionController, at_rest, next_voltage
from sonolube.design.control.friction_map import FrictionMap
from sonolube.design.control.tracking import FrequencyTracker, next_frequency
from sonolube.design.control.vibration import VibrationMode, next_envelope, sensed_phase
from sonolube.errors import InvalidInput

_MOST_SHIFT = 0.1  # of the resonance, up to which its shift may be taken as linear in the temperature
_FAINT = 0.02  # of the swing allowed, below which the phase of the current tells nothing


@dataclass(frozen=True, kw_only=True, slots=True)
class Drift:
    """Warming of a device, and how far its resonance falls with it.

    Parameters
    ----------
    final_temperature_rise : float
        Rise of the temperature in the end. [K]
    warming_time : float
        Time in which 63 % of it are reached. [s]
    frequency_per_temperature : float
        Relative change of the resonance per temperature. [1/K]

    Raises
    ------
    InvalidInput
        If a value is not finite, the time not positive, or the resonance shifts by more than a tenth.

    Notes
    -----
    Stiffness alone follows the temperature; damping ratio, capacitance and friction stay.
    """

    final_temperature_rise: float = 0.0
    warming_time: float = 1.0
    frequency_per_temperature: float = -2e-4

    def __post_init__(self) -> None:
        require_finite(
            final_temperature_rise=self.final_temperature_rise,
            frequency_per_temperature=self.frequency_per_temperature,
        )
        require_positive(warming_time=self.warming_time)
        if abs(self.frequency_per_temperature * self.final_temperature_rise) > _MOST_SHIFT:
            raise InvalidInput(
                f"final_temperature_rise must shift the resonance by no more than a tenth, got"
                f" {self.final_temperature_rise:g} K at {self.frequency_per_temperature:g} of it per kelvin"
            )

    def shift(self, time: float) -> float:
        """Return the relative change of the resonance at a time."""
        warmed = 1 - exp(-time / self.warming_time)
        return self.frequency_per_temperature * self.final_temperature_rise * warmed


@dataclass(frozen=True, kw_only=True, slots=True)
class Disturbance:
    """What the controller does not know of the friction.

    Parameters
    ----------
    friction_factor : float
        Real friction over that of the plant's map, from the start. []
    later_factor : float
        The same from `start_time` on. []
    start_time : float
        When that begins. [s]
    friction_force_deviation : float
        Standard deviation of the sensor's noise. [N]
    seed : int
        Of the noise; the same gives the same.
    """

    friction_factor: float = 1.0
    later_factor: float = 1.0
    start_time: float = 0.0
    friction_force_deviation: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        require_positive(friction_factor=self.friction_factor, later_factor=self.later_factor)
        require_non_negative(start_time=self.start_time, friction_force_deviation=self.friction_force_deviation)


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionLoop:
    """A controller and what it controls.

    Parameters
    ----------
    plant : FrictionMap
        Friction over the voltage that would keep the vibration up at the frequency the drive is meant to run at.
    mode : VibrationMode
    controller : FrictionController
    tracker : FrequencyTracker or None
        None for a fixed frequency.
    voltage_maximum : float
        Largest swing of the amplifier. [V]
    """

    plant: FrictionMap
    mode: VibrationMode
    controller: FrictionController
    tracker: FrequencyTracker | None
    voltage_maximum: float

    def __post_init__(self) -> None:
        require_positive(voltage_maximum=self.voltage_maximum)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ControlRun:
    """The course of a closed loop; every array has one entry an interval, at its start.

    Parameters
    ----------
    time : ndarray
        Time. [s]
    reference : ndarray
        Friction wanted, in N.
    friction_force : ndarray
        Friction. [N]
    measured : ndarray
        Friction as the controller sees it, late and noisy, in N.
    voltage_peak_to_peak : ndarray
        Swing of the drive over the interval. [V]
    frequency : ndarray
        Frequency of the drive over the interval. [Hz]
    resonance_frequency : ndarray
        Where the resonance is. [Hz]
    phase : ndarray
        Phase of the impedance as sensed, voltage ahead of current. [rad]
    envelope : ndarray of complex
        Vibration, as the swing that would keep it up at resonance, in V.
    electrical_energy : ndarray
        Energy that the motion has taken from the drive so far. [J]
    """

    time: Floats
    reference: Floats
    friction_force: Floats
    measured: Floats
    voltage_peak_to_peak: Floats
    frequency: Floats
    resonance_frequency: Floats
    phase: Floats
    envelope: np.ndarray[tuple[int], np.dtype[np.complex128]]
    electrical_energy: Floats


@dataclass(slots=True)
class _Plant:
    """The device as the loop runs."""

    loop: FrictionLoop
    envelope: complex = 0j
    energy: float = 0.0
    phase: float = -pi / 2
    frequency: float = 0.0
    past: deque[float] = field(default_factory=deque)

    def friction(self, factor: float) -> float:
        plant, share = self.loop.plant, self.loop.mode.meant_fraction
        volts = abs(self.envelope) / share
        return factor * float(np.interp(volts, plant.voltage_peak_to_peak, plant.friction_force))

    def advance(self, voltage: float, shift: float) -> None:
        mode, tracker = self.loop.mode, self.loop.tracker
        interval = self.loop.controller.process.sample_interval
        self.envelope, integral = next_envelope(
            mode,
            self.envelope,
            voltage_peak_to_peak=voltage,
            rate=mode.rate(self.frequency, shift),
            duration=interval,
        )
        self.energy += mode.motional_conductance * voltage * integral.real / 8
        if voltage > _FAINT * self.loop.voltage_maximum:
            self.phase = sensed_phase(mode, self.envelope / voltage, frequency=self.frequency)
            if tracker is not None:
                self.frequency = next_frequency(tracker, frequency=self.frequency, phase=self.phase)


def closed_loop(
    loop: FrictionLoop,
    *,
    reference: Floats,
    drift: Drift | None = None,
    disturbance: Disturbance | None = None,
) -> ControlRun:
    """Run a closed loop from rest.

    Parameters
    ----------
    loop : FrictionLoop
    reference : ndarray, shape (n,)
        Friction wanted in each interval, in N.
    drift : Drift, optional
        None where absent.
    disturbance : Disturbance, optional
        None where absent.

    Returns
    -------
    ControlRun

    Raises
    ------
    InvalidInput
        If the reference is empty, negative or not finite.

    Notes
    -----
    The vibration's envelope is exact under a voltage and frequency held over the interval; friction follows it at
    once, by the map. Changes of the envelope must be slow against the period, and the friction's own memory, some
    micrometres of sliding, short against the interval.
    """
    wanted = require_non_negative(friction_force=reference)
    if wanted.ndim != 1 or not wanted.size:
        raise InvalidInput(f"reference must have one axis with an entry an interval, got shape {wanted.shape}")
    drift, disturbance = drift or Drift(), disturbance or Disturbance()
    controller, mode = loop.controller, loop.mode
    time = np.arange(wanted.size, dtype=np.float64) * controller.process.sample_interval
    factor = disturbance.friction_factor * np.where(time >= disturbance.start_time, disturbance.later_factor, 1.0)
    noise = disturbance.friction_force_deviation * np.random.default_rng(disturbance.seed).standard_normal(time.size)
    state, plant = at_rest(controller), _Plant(loop, frequency=mode.frequency)
    at_first = factor[0] * loop.plant.highest_force
    plant.past.extend([at_first] * controller.process.delayed_samples)
    course = np.empty((7, time.size))
    envelope = np.empty(time.size, dtype=np.complex128)
    for n, now in enumerate(time):
        shift = drift.shift(now)
        friction = plant.friction(factor[n])
        plant.past.append(friction)
        measured = plant.past.popleft() + noise[n]
        voltage = next_voltage(controller, state, float(wanted[n]), float(measured))
        given = min(voltage, loop.voltage_maximum)
        resonance = mode.natural_frequency * (1 + shift)
        envelope[n] = plant.envelope
        course[:, n] = friction, measured, given, plant.frequency, resonance, plant.phase, plant.energy
        plant.advance(given, shift)
    friction_force, measured_force, volts, frequency, resonances, phase, energy = course
    return ControlRun(
        time=time,
        reference=wanted,
        friction_force=friction_force,
        measured=measured_force,
        voltage_peak_to_peak=volts,
        frequency=frequency,
        resonance_frequency=resonances,
        phase=phase,
        envelope=envelope,
        electrical_energy=energy,
    )
