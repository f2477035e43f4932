"""Time simulation of the closed loop: sensor, controller, amplifier, vibration envelope, friction and thermal drift."""

from collections import deque
from dataclasses import dataclass, field
from math import exp, pi

import numpy as np

from sonolube.checks import Complexes, Floats, require_finite, require_non_negative, require_positive
from sonolube.design.control.controller import FrictionController, initial_state, next_level
from sonolube.design.control.friction_characteristic import FrictionCharacteristic
from sonolube.design.control.resonance_tracking import FrequencyTracker, next_frequency
from sonolube.design.control.vibration_envelope import VibrationMode, measured_phase, next_envelope
from sonolube.errors import InvalidInput

_LARGEST_SHIFT = 0.1  # relative, up to which the resonance may be taken as linear in the temperature
_MIN_LEVEL = 0.02  # of the voltage limit, below which the phase of the current is not evaluated


@dataclass(frozen=True, kw_only=True, slots=True)
class ThermalDrift:
    r"""Drift of the resonance frequency as the device warms.

    Parameters
    ----------
    final_temperature_rise : float
        Final temperature rise. [K]
    warming_time : float
        Time constant of the warming. [s]
    frequency_per_temperature : float
        Relative change of the resonance frequency per temperature. [1/K]

    Raises
    ------
    InvalidInput
        If a value is not finite, the time constant not positive, or the resonance shifts by more than a tenth.

    Notes
    -----
    .. math:: \frac{\Delta f_r}{f_r} = \alpha_f \Delta T \bigl(1 - e^{-t/\tau_T}\bigr)

    The drift is that of the stiffness; damping ratio, capacitance and friction are constant.
    """

    final_temperature_rise: float = 0.0
    warming_time: float = 1.0
    frequency_per_temperature: float = -2e-4

    def __post_init__(self) -> None:
        require_finite(
            final_temperature_rise=self.final_temperature_rise, frequency_per_temperature=self.frequency_per_temperature
        )
        require_positive(warming_time=self.warming_time)
        if abs(self.frequency_per_temperature * self.final_temperature_rise) > _LARGEST_SHIFT:
            raise InvalidInput(
                "final_temperature_rise must shift the resonance by no more than a tenth, got"
                f" {self.final_temperature_rise:g} K at {self.frequency_per_temperature:g} of its frequency per kelvin"
            )

    def shift(self, time: float) -> float:
        """Relative shift of the resonance frequency at a time."""
        warmed = 1 - exp(-time / self.warming_time)
        return self.frequency_per_temperature * self.final_temperature_rise * warmed


@dataclass(frozen=True, kw_only=True, slots=True)
class Disturbance:
    """Model error of the friction, a step of it, and noise of the friction sensor.

    Parameters
    ----------
    friction_factor : float
        Actual friction force over that of the plant's characteristic, from the start. []
    later_factor : float
        Further factor of the friction force from `start_time` on. []
    start_time : float
        Time of that step. [s]
    friction_force_deviation : float
        Standard deviation of the sensor noise. [N]
    seed : int
        Seed of the noise.
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
    """Plant, controller and resonance tracking of a friction control loop.

    Parameters
    ----------
    plant : FrictionCharacteristic
        Friction over the steady voltage at the nominal drive frequency, or over the steady amplitude.
    mode : VibrationMode
    controller : FrictionController
    tracker : FrequencyTracker or None
        None for a fixed frequency.
    level_maximum : float
        Largest peak-to-peak voltage of the amplifier, or largest amplitude, in V or m.
    """

    plant: FrictionCharacteristic
    mode: VibrationMode
    controller: FrictionController
    tracker: FrequencyTracker | None
    level_maximum: float

    def __post_init__(self) -> None:
        require_positive(level_maximum=self.level_maximum)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ClosedLoopRun:
    """Time histories of a simulated closed loop; every array has one entry per interval, at its start.

    Parameters
    ----------
    time : ndarray
        Time. [s]
    setpoint : ndarray
        Commanded friction force, in N.
    friction_force : ndarray
        Actual friction force. [N]
    measured_force : ndarray
        Friction force as measured, with dead time and noise, in N.
    level : ndarray
        Peak-to-peak drive voltage, or commanded amplitude, over the interval, in V or m.
    frequency : ndarray
        Drive frequency over the interval. [Hz]
    resonance_frequency : ndarray
        Resonance frequency. [Hz]
    envelope : ndarray of complex
        Vibration envelope, as the level that maintains it at resonance, in V or m.
    phase : ndarray or None
        Measured phase of the impedance, positive where the voltage leads the current; None of a commanded amplitude.
        [rad]
    electrical_energy : ndarray or None
        Energy supplied to the motional branch so far; None of a commanded amplitude. [J]
    """

    time: Floats
    setpoint: Floats
    friction_force: Floats
    measured_force: Floats
    level: Floats
    frequency: Floats
    resonance_frequency: Floats
    envelope: Complexes
    phase: Floats | None
    electrical_energy: Floats | None


@dataclass(slots=True)
class _PlantState:
    """State of the plant: envelope, energy, measured phase, drive frequency and forces not yet measured.

    Parameters
    ----------
    loop : FrictionLoop
    envelope : complex
    energy : float
    phase : float
    frequency : float
    pending_forces : deque of float
        Forces within the dead time of the measurement, the oldest first.
    """

    loop: FrictionLoop
    envelope: complex = 0j
    energy: float = 0.0
    phase: float = -pi / 2
    frequency: float = 0.0
    pending_forces: deque[float] = field(default_factory=deque)

    def friction(self, factor: float) -> float:
        """Friction force at the present envelope, in N."""
        plant, ratio = self.loop.plant, self.loop.mode.nominal_envelope_ratio
        return factor * float(np.interp(abs(self.envelope) / ratio, plant.level, plant.friction_force))

    def advance(self, level: float, shift: float) -> None:
        """Advance envelope, energy, phase and tracked frequency by one interval."""
        mode, tracker = self.loop.mode, self.loop.tracker
        interval = self.loop.controller.process.sample_interval
        self.envelope, integral = next_envelope(
            mode, self.envelope, level=level, rate=mode.rate(self.frequency, shift), duration=interval
        )
        if mode.motional_conductance is None:
            return
        self.energy += mode.motional_conductance * level * integral.real / 8
        if level > _MIN_LEVEL * self.loop.level_maximum:
            self.phase = measured_phase(mode, self.envelope / level, frequency=self.frequency)
            if tracker is not None:
                self.frequency = next_frequency(tracker, frequency=self.frequency, phase=self.phase)


def simulate_closed_loop(
    loop: FrictionLoop, *, setpoint: Floats, drift: ThermalDrift | None = None, disturbance: Disturbance | None = None
) -> ClosedLoopRun:
    """Time simulation of a friction control loop from rest, interval by interval.

    Parameters
    ----------
    loop : FrictionLoop
    setpoint : ndarray, shape (n,)
        Commanded friction force in each interval, in N.
    drift : ThermalDrift, optional
        No drift by default.
    disturbance : Disturbance, optional
        No disturbance by default.

    Returns
    -------
    ClosedLoopRun

    Raises
    ------
    InvalidInput
        If the set-point is empty, negative or not finite.

    See Also
    --------
    design_control, step_response_metrics, control_energy

    Notes
    -----
    The vibration envelope is the exact solution under voltage, or commanded amplitude, and frequency held over the
    interval; friction follows it without delay, by the static characteristic. Changes of the envelope must be slow
    against the period of the vibration, and the memory of friction, some micrometres of sliding, short against the
    interval.
    """
    commanded = require_non_negative(friction_force=setpoint)
    if commanded.ndim != 1 or not commanded.size:
        raise InvalidInput(f"setpoint must have one axis with an entry per interval, got shape {commanded.shape}")
    drift, disturbance = drift or ThermalDrift(), disturbance or Disturbance()
    controller, mode = loop.controller, loop.mode
    time = np.arange(commanded.size, dtype=np.float64) * controller.process.sample_interval
    factor = disturbance.friction_factor * np.where(time >= disturbance.start_time, disturbance.later_factor, 1.0)
    noise = disturbance.friction_force_deviation * np.random.default_rng(disturbance.seed).standard_normal(time.size)
    state, plant = initial_state(controller), _PlantState(loop, frequency=mode.frequency)
    initial_force = factor[0] * loop.plant.highest_force
    plant.pending_forces.extend([initial_force] * controller.process.dead_time_samples)
    histories = np.empty((7, time.size))
    envelope = np.empty(time.size, dtype=np.complex128)
    for n, now in enumerate(time):
        shift = drift.shift(now)
        friction = plant.friction(factor[n])
        plant.pending_forces.append(friction)
        measured = plant.pending_forces.popleft() + noise[n]
        level = next_level(controller, state, float(commanded[n]), float(measured))
        saturated = min(level, loop.level_maximum)
        resonance = mode.natural_frequency * (1 + shift)
        envelope[n] = plant.envelope
        histories[:, n] = friction, measured, saturated, plant.frequency, resonance, plant.phase, plant.energy
        plant.advance(saturated, shift)
    friction_force, measured_force, levels, frequency, resonance_frequency, phase, energy = histories
    is_electrical = mode.motional_conductance is not None
    return ClosedLoopRun(
        time=time,
        setpoint=commanded,
        friction_force=friction_force,
        measured_force=measured_force,
        level=levels,
        frequency=frequency,
        resonance_frequency=resonance_frequency,
        envelope=envelope,
        phase=phase if is_electrical else None,
        electrical_energy=energy if is_electrical else None,
    )
